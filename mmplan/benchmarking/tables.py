"""The tables of a report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from mmplan.benchmarking import published
from mmplan.benchmarking.contests import Contest
from mmplan.benchmarking.families import family_differences, family_scores
from mmplan.benchmarking.records import STAGES, Record
from mmplan.benchmarking.statistics import (
    Proportion,
    Spread,
    difference,
    proportion,
    spread,
)
from mmplan.benchmarking.table import Table, number, rate

# With more problems than this, their rows are for files only.
_MOST_SHOWN = 12


def tables(contests: Sequence[Contest]) -> list[Table]:
    """All tables that the runs suffice for, the most summary first."""
    families = [make(contests) for make in (family_scores, family_differences)]
    problems = [
        make(contests) for make in (_scores, _differences, _table_1, _times, _plans)
    ]
    many = len({c.problem.name for c in contests}) > _MOST_SHOWN
    made = [*families, *(replace(table, detailed=many) for table in problems)]
    return [table for table in made if table.rows]


def _scores(contests: Sequence[Contest]) -> Table:
    best = {c.problem.name: f"{c.best:.2f} ({c.problem.name})" for c in contests}
    rows = [
        (
            c.problem.name,
            str(c.evaluations),
            label,
            str(len(runs)),
            rate(_successes(runs)),
            *_mean_and_deviation(_of_successes(c, label)),
            number(_of_successes(c, label).median),
            number(spread([r.cycles for r in runs if r.cycles is not None]).mean),
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
                problem, budget = contest.problem.name, str(contest.evaluations)
                rows.append((problem, budget, f"{a} − {b}", *found.cells))
    return Table(
        "Paired differences",
        "Differences of normalized scores on the same seeds, a failed run counting as "
        "0: mean with its 95 % bootstrap interval (BCa), and p of Wilcoxon's "
        "signed-rank test.",
        ("problem", "evaluations", "contenders", "pairs", "difference", "95 %", "p"),
        tuple(rows),
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
                rate(proportion(len(verified), len(plans))),
                number(spread([p["tried"] for p in plans]).mean),
                str(sum(p["refuted"] for p in plans)),
                number(spread([p["duration"] for p in verified]).mean),
                number(1e3 * min(nearest)) if nearest else "",
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


def _mean_and_deviation(s: Spread) -> tuple[str, str]:
    return number(s.mean), number(s.deviation)
