"""Families of problems, each taken together: a problem counts once, however many runs.

A family are the problems whose names begin alike, up to the first hyphen, such as the
generated `shelf-d0500-s1-000` and `shelf-d0500-s1-001`; it takes two to make one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from mmplan.benchmarking.contests import Contest
from mmplan.benchmarking.statistics import difference, proportion, spread
from mmplan.benchmarking.table import Table, number, rate

ALL = "all"


class Family(NamedTuple):
    """The contests of several problems with one budget."""

    name: str
    evaluations: int
    contests: list[Contest]

    @property
    def labels(self) -> list[str]:
        """The contenders that took on every problem."""
        first, *others = (contest.contenders for contest in self.contests)
        return [label for label in first if all(label in o for o in others)]

    def means(self, label: str) -> dict[int, float]:
        """A contender's mean normalized score on each problem, by its number."""
        return {
            i: float(np.mean(list(contest.normalized(label).values())))
            for i, contest in enumerate(self.contests)
        }


def families(contests: Sequence[Contest]) -> list[Family]:
    """All families by budget, and all of their problems together."""
    budgets = sorted({c.evaluations for c in contests})
    return [family for budget in budgets for family in _of_budget(contests, budget)]


def _of_budget(contests: Sequence[Contest], budget: int) -> Iterator[Family]:
    groups: dict[str, list[Contest]] = {}
    for contest in contests:
        if contest.evaluations == budget:
            name, hyphen, _ = contest.problem.name.partition("-")
            groups.setdefault(name if hyphen else "", []).append(contest)
    named = {name: g for name, g in groups.items() if name and len(g) > 1}
    for name in sorted(named):
        yield Family(name, budget, named[name])
    if len(named) > 1:
        together = [contest for name in sorted(named) for contest in named[name]]
        yield Family(ALL, budget, together)


def family_scores(contests: Sequence[Contest]) -> Table:
    """Success and mean score of every contender by family."""
    rows = []
    for family in families(contests):
        for label in family.labels:
            runs = [run for c in family.contests for run in c.contenders[label]]
            means = spread(list(family.means(label).values()))
            row = (
                family.name,
                str(family.evaluations),
                label,
                str(means.n),
                str(len(runs)),
                rate(proportion(sum(r.success for r in runs), len(runs))),
                number(means.mean),
                number(means.deviation),
            )
            rows.append(row)
    return Table(
        "Families of problems",
        "Success of all runs with its 95 % Wilson interval. The score of a problem is "
        "the mean over its runs, a failed one counting as 0, normalized to 100 by the "
        "best ever found for it; mean and standard deviation are over the problems.",
        (
            "family",
            "evaluations",
            "contender",
            "problems",
            "runs",
            "success",
            "mean score",
            "std. dev.",
        ),
        tuple(rows),
    )


def family_differences(contests: Sequence[Contest]) -> Table:
    """How far contenders are ahead of each other by family."""
    rows = []
    for family in families(contests):
        for a, b in combinations(family.labels, 2):
            found = difference(family.means(a), family.means(b))
            if found is not None:
                name = f"{a} − {b}"
                rows.append((family.name, str(family.evaluations), name, *found.cells))
    return Table(
        "Paired differences by family",
        "Differences of the problems' mean normalized scores: mean with its 95 % "
        "bootstrap interval (BCa) over the problems, and p of Wilcoxon's signed-rank "
        "test.",
        ("family", "evaluations", "contenders", "problems", "difference", "95 %", "p"),
        tuple(rows),
    )
