"""Running an optimizer to the end of its budget."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from mmplan.optimizers.archive import Archive, Triple
from mmplan.optimizers.bases import BasePlacements, OnePlacement, Placements
from mmplan.optimizers.optimizer import Optimizer, Queries, SearchSpace
from mmplan.processes import Copy, copied
from mmplan.scoring import End, Outcome, ScoreFunction, Scores
from mmplan.shapes import Array

# Called with the evaluations done so far.
Progress: TypeAlias = Callable[[int], None]


@dataclass(frozen=True, eq=False)
class Optimization:
    """What a search found and what it cost.

    `history` (h, 2) has the evaluations spent and the best sum of two scores so far,
    wherever it rises and at the end. `outcomes` (2, outcomes) counts the evaluations
    at start and goal by `Outcome`. `evaluated` keeps every query, for the account of a
    failure.
    """

    candidates: tuple[Triple, ...]
    evaluations: int
    cycles: float | None
    history: Array
    outcomes: npt.NDArray[np.int64]
    grasps_by_end: tuple[int, int, int]  # at start only, at goal only, at both
    evaluated: Queries


def search_space(score: ScoreFunction) -> SearchSpace:
    """The annuli of bases about the object at both ends and the grasps' bounds."""
    return SearchSpace(
        {end: _placements(score, end) for end in End}, score.family.genes
    )


def optimize(
    score: ScoreFunction,
    optimizer: Optimizer,
    evaluations: int,
    candidates: int,
    progress: Progress | None = None,
    jobs: int = 1,
) -> Optimization:
    """Let an optimizer spend its budget of score evaluations.

    Every call of Score(q_base, grasp) that is asked for counts, also where the answer
    is remembered. At most `candidates` distinct joint candidates are returned. With two
    `jobs` another process scores what an optimizer asks for at the goal together with
    what it asks for at the start; the result is the same.
    """
    archive = Archive()
    history: list[tuple[int, float]] = []
    asked: list[Queries] = []
    outcomes = np.zeros((len(End), len(Outcome)), np.int64)
    spent = 0
    with copied(score, jobs, "scores the goal") as helper:
        while spent < evaluations:
            queries = optimizer.ask(evaluations - spent)
            totals = _evaluate(score, queries, outcomes, helper)
            history += _rises(archive, queries, totals, spent)
            optimizer.tell(totals)
            spent += len(totals)
            asked.append(queries)
            if progress is not None:
                progress(spent)
    if not history or history[-1][0] < spent:
        history.append((spent, archive.best))
    return Optimization(
        candidates=tuple(optimizer.candidates(archive, candidates)),
        evaluations=spent,
        cycles=optimizer.cycles,
        history=np.array(history),
        outcomes=outcomes,
        grasps_by_end=archive.grasps_by_end(),
        evaluated=Queries(*(np.concatenate(p) for p in zip(*asked, strict=True))),
    )


def _evaluate(
    score: ScoreFunction,
    queries: Queries,
    outcomes: npt.NDArray[np.int64],
    helper: Copy[ScoreFunction] | None,
) -> Array:
    """The scores (n,) of what was asked for, counted by outcome."""
    totals = np.zeros(len(queries.end))
    rows = {end: np.flatnonzero(queries.end == end) for end in End}
    asked = {end: (queries.q_base[r], queries.grasps[r]) for end, r in rows.items()}
    at_goal = None
    if helper is not None and len(rows[End.GOAL]):
        at_goal = helper.ask(_scores_at_goal, *asked[End.GOAL])
    for end in End:
        if len(rows[end]) == 0:
            continue
        if at_goal is not None and end == End.GOAL:
            scores = at_goal()
            score.remember(end, *asked[end], scores)
        else:
            scores = score(end, *asked[end])
        totals[rows[end]] = scores.total
        np.add.at(outcomes[end], scores.outcome, 1)
    return totals


def _scores_at_goal(score: ScoreFunction, q_base: Array, grasps: Array) -> Scores:
    """The scores of bases (n, b) and grasps (n, g) at the goal."""
    return score(End.GOAL, q_base, grasps)


def _rises(
    archive: Archive, queries: Queries, totals: Array, spent: int
) -> list[tuple[int, float]]:
    """Enter scores into the archive in their order; where its best rises, and to what.

    `spent` are the evaluations before these.
    """
    rises: list[tuple[int, float]] = []
    for row in np.flatnonzero(totals > 0.0):
        best, end = archive.best, End(int(queries.end[row]))
        archive.add(end, queries.q_base[row], queries.grasps[row], totals[row])
        if archive.best > best:
            rises.append((spent + int(row) + 1, archive.best))
    return rises


def _placements(score: ScoreFunction, end: End) -> Placements:
    problem, robot = score.problem, score.problem.robot
    x, y, _ = score.centre_of_mass(end)

    def is_free(q_base: Array) -> npt.NDArray[np.bool_]:
        free: npt.NDArray[np.bool_] = score.base_outcomes(end, q_base) == Outcome.SCORED
        return free

    if problem.base_stands:
        return OnePlacement(problem.base_bounds[:, 0], is_free)
    lower, upper = robot.base.lower.tolist(), robot.base.upper.tolist()
    return BasePlacements(
        centre=(float(x), float(y)),
        inner=robot.base_radius,
        outer=robot.reach,
        is_free=is_free,
        heading=(lower[2], upper[2]) if len(robot.base) > 2 else None,
    )
