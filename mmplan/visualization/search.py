"""What the optimizer saw: its candidates and, cycle by cycle, its populations.

A plan does not hold them. The search is run again from the plan's seed, which gives
the same candidates as long as the scene's optimizer and its budget are those that the
plan was made with.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mmplan.collision import CollisionWorld
from mmplan.collision.nearest import Nearest, nearest_obstacles
from mmplan.optimizers import Archive, Optimizer, Queries, Triple, optimize
from mmplan.optimizers.run import Progress
from mmplan.pipeline import after_task, optimizer_of, score_function, task_generators
from mmplan.plan import Plan, TaskPlan
from mmplan.problem import Problem
from mmplan.scoring import Breakdown, End, ScoreFunction
from mmplan.shapes import Array

# Populations are shown at this many moments where the optimizer has no cycles.
_MOMENTS = 8
# Of more bases than this at one moment and end, the best are shown.
_MOST_BASES = 120


@dataclass(frozen=True, eq=False)
class CandidateEnd:
    """A candidate at one end of its task."""

    q: Array  # (nq,), the hand closed on the object
    T_world_object: Array  # (4, 4)
    breakdown: Breakdown
    nearest: tuple[Nearest, ...]  # what the clutter term measures


@dataclass(frozen=True, eq=False)
class ShownCandidate:
    """One joint candidate of the optimizer, at the start and at the goal."""

    label: str
    total: float
    object: str
    ends: tuple[CandidateEnd, CandidateEnd]


@dataclass(frozen=True, eq=False)
class Population:
    """The base placements that were tried at one end during one cycle."""

    positions: Array  # (n, 2), m, in the world
    scores: Array  # (n,), each the best with any grasp, 0 where none works


@dataclass(frozen=True, eq=False)
class Cycle:
    """The populations of bases at start and goal during one cycle."""

    label: str
    ends: tuple[Population, Population]


@dataclass(frozen=True, eq=False)
class Search:
    """The search for one task."""

    task: int
    candidates: tuple[ShownCandidate, ...]
    cycles: tuple[Cycle, ...]


def searches(
    problem: Problem, plan: Plan, progress: Progress | None = None
) -> Iterator[Search]:
    """The search for each task of a plan, run again.

    `progress` is called with the evaluations done so far, and may raise to end this.
    """
    rest = problem
    for number, rng in enumerate(task_generators(problem, plan.seed)):
        if number == len(plan.tasks):
            return
        one = replace(rest, tasks=(problem.tasks[number],))
        score = score_function(one)
        recorder = _Recorder(optimizer_of(score, rng))
        settings = one.optimizer
        found = optimize(
            score, recorder, settings.evaluations, one.planner.candidates, progress
        )
        yield Search(
            task=number,
            candidates=tuple(_shown(score, found.candidates, plan.tasks[number])),
            cycles=tuple(_cycles(score, recorder, found.cycles)),
        )
        rest = after_task(one, plan.tasks[number])


class _Recorder:
    """An optimizer that keeps what it asked for and was told."""

    def __init__(self, optimizer: Optimizer) -> None:
        self._optimizer = optimizer
        self.asked: list[Queries] = []
        self.told: list[Array] = []

    @property
    def cycles(self) -> float | None:
        return self._optimizer.cycles

    def ask(self, limit: int) -> Queries:
        queries = self._optimizer.ask(limit)
        self.asked.append(queries)
        return queries

    def tell(self, totals: Array) -> None:
        self.told.append(totals)
        self._optimizer.tell(totals)

    def candidates(self, archive: Archive, most: int) -> list[Triple]:
        return self._optimizer.candidates(archive, most)


def _shown(
    score: ScoreFunction, triples: Sequence[Triple], task: TaskPlan
) -> Iterator[ShownCandidate]:
    """The candidates to show: all that were found, and the plan's own among them."""
    worlds = [score.worlds[end].without(task.object) for end in End]
    own = [_is_own(triple, task) for triple in triples]
    for number, triple in enumerate(triples):
        chosen = " (the plan's)" if own[number] else ""
        yield _candidate(score, worlds, triple, f"candidate {number + 1}{chosen}")
    if not any(own):
        triple = Triple((task.start.base, task.goal.base), task.genes, (0.0, 0.0))
        yield _candidate(score, worlds, triple, "the plan's")


def _is_own(triple: Triple, task: TaskPlan) -> bool:
    mine = (*triple.q_base, triple.grasp)
    plans = (task.start.base, task.goal.base, task.genes)
    return all(np.array_equal(a, b) for a, b in zip(mine, plans, strict=True))


def _candidate(
    score: ScoreFunction, worlds: Sequence[CollisionWorld], triple: Triple, label: str
) -> ShownCandidate:
    ends = [
        _candidate_end(score, worlds[end], end, triple.q_base[end], triple.grasp)
        for end in End
    ]
    total = sum(end.breakdown.total for end in ends)
    return ShownCandidate(label, total, score.task.object, (ends[0], ends[1]))


def _candidate_end(
    score: ScoreFunction, world: CollisionWorld, end: End, q_base: Array, grasp: Array
) -> CandidateEnd:
    q = score(end, q_base[None], grasp[None]).q[0]
    return CandidateEnd(
        q=q,
        T_world_object=score.worlds[end].standing[score.task.object],
        breakdown=score.breakdown(end, q_base, grasp),
        nearest=nearest_obstacles(world, q) if np.isfinite(q).all() else (),
    )


def _cycles(
    score: ScoreFunction, recorder: _Recorder, cycles: float | None
) -> Iterator[Cycle]:
    """The evaluations in cycles, or in equal parts where there are none."""
    asked = Queries(*(np.concatenate(p) for p in zip(*recorder.asked, strict=True)))
    totals = np.concatenate(recorder.told)
    step = len(totals) / (cycles if cycles and cycles >= 1.0 else _MOMENTS)
    borders = np.append(np.arange(0.0, len(totals) - 1.0, step), len(totals))
    name = "cycle" if cycles else "part"
    for number in range(len(borders) - 1):
        rows = slice(round(borders[number]), round(borders[number + 1]))
        ends = [
            _population(score, asked.q_base[rows], totals[rows], asked.end[rows] == end)
            for end in End
        ]
        yield Cycle(f"{name} {number + 1}", (ends[0], ends[1]))


def _population(
    score: ScoreFunction, q_base: Array, totals: Array, here: np.ndarray
) -> Population:
    """The different bases among some evaluations, best first."""
    bases, which = np.unique(q_base[here], axis=0, return_inverse=True)
    best = np.zeros(len(bases))
    np.maximum.at(best, which.reshape(-1), totals[here])
    order = np.argsort(-best, kind="stable")[:_MOST_BASES]
    poses = score.problem.robot.base_poses(bases[order])
    return Population(poses[:, :2, 3], best[order])
