"""The tables of a report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from textwrap import fill

import numpy as np

from mmplan.benchmarking import published
from mmplan.benchmarking.contests import Contest
from mmplan.benchmarking.records import STAGES, Record
from mmplan.benchmarking.statistics import (
    Difference,
    Proportion,
    Spread,
    difference,
    proportion,
    spread,
)

_WORDS = frozenset({"problem", "contender", "contenders"})


@dataclass(frozen=True)
class Table:
    """A table with a title and what must be said about it."""

    title: str
    note: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def is_text(self, column: int) -> bool:
        """Whether a column holds words rather than numbers."""
        return self.header[column] in _WORDS

    def text(self) -> str:
        """The table for a terminal, as wide as it is."""
        widths = [max(map(len, c)) for c in zip(self.header, *self.rows, strict=True)]
        lines = [
            "  ".join(
                cell.ljust(width) if self.is_text(i) else cell.rjust(width)
                for i, (cell, width) in enumerate(zip(row, widths, strict=True))
            )
            for row in (self.header, *self.rows)
        ]
        return "\n".join([self.title, "", *lines, "", fill(self.note), ""])

    def markdown(self) -> str:
        """The table as Markdown."""
        lines = [self.header, ("---",) * len(self.header), *self.rows]
        table = "\n".join(f"| {' | '.join(line)} |" for line in lines)
        return f"### {self.title}\n\n{table}\n\n{self.note}\n"


def tables(contests: Sequence[Contest]) -> list[Table]:
    """All tables that the runs suffice for."""
    made = (_scores, _differences, _table_1, _times, _plans)
    return [table for make in made if (table := make(contests)).rows]


def _scores(contests: Sequence[Contest]) -> Table:
    best = {c.problem.name: f"{c.best:.2f} ({c.problem.name})" for c in contests}
    rows = [
        (
            c.problem.name,
            str(c.evaluations),
            label,
            str(len(runs)),
            _rate(_successes(runs)),
            *_mean_and_deviation(_of_successes(c, label)),
            _number(_of_successes(c, label).median),
            _number(spread([r.cycles for r in runs if r.cycles is not None]).mean),
        )
        for c, label, runs in _each(contests)
    ]
    return Table(
        "Scores",
        "Success with its 95 % Wilson interval. Scores of successful runs, normalized "
        "to 100 by the best ever found for the problem by any contender with any "
        f"budget: {', '.join(best.values())}.",
        (
            "problem",
            "evaluations",
            "contender",
            "runs",
            "success",
            "mean score",
            "std. dev.",
            "median",
            "cycles",
        ),
        tuple(rows),
    )


def _differences(contests: Sequence[Contest]) -> Table:
    rows = []
    for contest in contests:
        for a, b in combinations(contest.contenders, 2):
            found = difference(contest.normalized(a), contest.normalized(b))
            if found is not None:
                rows.append(_difference_row(contest, f"{a} − {b}", found))
    return Table(
        "Paired differences",
        "Differences of normalized scores on the same seeds, a failed run counting as "
        "0: mean with its 95 % bootstrap interval (BCa), and p of Wilcoxon's "
        "signed-rank test.",
        ("problem", "evaluations", "contenders", "pairs", "difference", "95 %", "p"),
        tuple(rows),
    )


def _difference_row(contest: Contest, name: str, d: Difference) -> tuple[str, ...]:
    return (
        contest.problem.name,
        str(contest.evaluations),
        name,
        str(d.n),
        f"{d.mean:+.2f}",
        f"{d.low:+.2f} to {d.high:+.2f}",
        f"{d.p:.2g}",
    )


def _table_1(contests: Sequence[Contest]) -> Table:
    rows = []
    for contest, label, runs in _each(contests):
        paper = published.TABLE_I.get((contest.problem.name, runs[0].optimizer))
        if paper is None or contest.evaluations != published.EVALUATIONS:
            continue
        ours = _of_successes(contest, label)
        rows.append(
            (
                contest.problem.name,
                label,
                f"{paper.success:.1f} %",
                f"{paper.mean:.2f}",
                f"{paper.deviation:.2f}",
                f"{100 * _successes(runs).share:.1f} %",
                *_mean_and_deviation(ours),
                str(len(runs)),
            )
        )
    return Table(
        "Table I of the paper, and ours",
        published.CAVEAT,
        (
            "problem",
            "contender",
            "paper: success",
            "avg. score (100 max)",
            "score std. dev.",
            "ours: success",
            "avg. score (100 max)",
            "score std. dev.",
            "runs",
        ),
        tuple(rows),
    )


def _times(contests: Sequence[Contest]) -> Table:
    stages = stages_of([r for _, _, runs in _each(contests) for r in runs])
    rows = []
    for contest, label, runs in _each(contests):
        seconds = [mean_seconds(runs, stage) for stage in stages]
        wall = sum(mean_seconds(runs, stage, "wall") for stage in stages)
        cells = [f"{s:.3f}" for s in (*seconds, sum(seconds), wall)]
        rows.append((contest.problem.name, str(contest.evaluations), label, *cells))
    return Table(
        "Time by stage",
        "Mean CPU seconds of a run, and its wall time.",
        ("problem", "evaluations", "contender", *stages, "all", "wall"),
        tuple(rows),
    )


def _plans(contests: Sequence[Contest]) -> Table:
    rows = []
    for contest, label, runs in _each(contests):
        plans = [r.plan for r in runs if r.plan is not None]
        if not plans:
            continue
        verified = [p for p in plans if p["verified"]]
        clearances = [p["verification"]["clearance"] for p in verified]
        nearest = [c["distance"] for c in clearances if c is not None]
        rows.append(
            (
                contest.problem.name,
                str(contest.evaluations),
                label,
                _rate(proportion(len(verified), len(plans))),
                _number(spread([p["tried"] for p in plans]).mean),
                str(sum(p["refuted"] for p in plans)),
                _number(spread([p["duration"] for p in verified]).mean),
                _number(1e3 * min(nearest)) if nearest else "",
            )
        )
    return Table(
        "Motions",
        "Runs that ended with a verified plan, with the 95 % Wilson interval; mean "
        "number of candidates tried; plans that the verifier refused; mean duration of "
        "the motion; the smallest clearance of all plans.",
        (
            "problem",
            "evaluations",
            "contender",
            "verified",
            "tried",
            "refused",
            "duration, s",
            "clearance, mm",
        ),
        tuple(rows),
    )


def stages_of(records: Sequence[Record]) -> list[str]:
    """The stages that any of the runs has."""
    return [stage for stage in STAGES if any(stage in r.times for r in records)]


def mean_seconds(records: Sequence[Record], stage: str, kind: str = "cpu") -> float:
    """The mean seconds that runs spend in a stage."""
    return float(np.mean([r.times.get(stage, {}).get(kind, 0.0) for r in records]))


def _each(contests: Sequence[Contest]) -> Iterator[tuple[Contest, str, list[Record]]]:
    for contest in contests:
        for label, runs in contest.contenders.items():
            yield contest, label, runs


def _successes(runs: Sequence[Record]) -> Proportion:
    return proportion(sum(r.success for r in runs), len(runs))


def _of_successes(contest: Contest, label: str) -> Spread:
    return spread([score for score in contest.normalized(label).values() if score > 0])


def _rate(p: Proportion) -> str:
    return f"{100 * p.share:.1f} % ({100 * p.low:.1f} to {100 * p.high:.1f})"


def _mean_and_deviation(s: Spread) -> tuple[str, str]:
    return _number(s.mean), _number(s.deviation)


def _number(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.2f}"
