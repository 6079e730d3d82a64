"""Records put together: who contends on which problem with which budget."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

from mmplan.benchmarking.records import Record
from mmplan.benchmarking.store import ProblemEntry, Store


@dataclass(frozen=True)
class Contest:
    """The runs of all contenders on one problem with one budget.

    `best` is the best score ever found for the problem, with any budget, which counts
    as 100.
    """

    problem: ProblemEntry
    evaluations: int
    best: float
    contenders: dict[str, list[Record]]  # by label, runs by seed

    def normalized(self, label: str) -> dict[int, float]:
        """The scores of a contender by seed, 100 the best ever, 0 where it failed."""
        share = 100.0 / self.best if self.best > 0.0 else 0.0
        return {r.seed: share * r.score for r in self.contenders[label]}

    @property
    def name(self) -> str:
        """What to call it: `wineglass, 6940 evaluations`."""
        return f"{self.problem.name}, {self.evaluations} evaluations"


def contests(store: Store) -> list[Contest]:
    """The contests of a store: problems in the order in which they came, by budget."""
    best = store.best()
    problems = {p.name: p for p in store.problems()}
    order = {name: i for i, name in enumerate(problems)}
    records = sorted(store.records(), key=lambda r: (order[r.problem], r.evaluations))
    return [
        Contest(problems[name], budget, best.get(name, 0.0), _by_label(runs))
        for (name, budget), runs in groupby(
            records, key=lambda r: (r.problem, r.evaluations)
        )
    ]


def _by_label(records: Iterable[Record]) -> dict[str, list[Record]]:
    contenders: dict[str, list[Record]] = {}
    for record in sorted(records, key=lambda r: (r.optimizer, r.planner, r.seed)):
        contenders.setdefault(record.label, []).append(record)
    return contenders
