"""Score(q_base, grasp): grasp quality, manipulability and clutter in one number."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.collision import CollisionWorld, Contact, HandCloser
from mmplan.grasps import GraspFamily
from mmplan.problem import Problem, Task, WeightedTerm
from mmplan.scoring.branches import Branches, BranchSearch
from mmplan.scoring.breakdown import Breakdown, links_of
from mmplan.scoring.carriable import Carriable
from mmplan.scoring.clutter import Clutter
from mmplan.scoring.feasibility import Arms, Feasibility, Overlap
from mmplan.scoring.grasp_quality import Hold, quality_measure
from mmplan.scoring.joint_margin import JointMargin
from mmplan.scoring.outcome import End, Outcome
from mmplan.scoring.term import Grasped, RowCache, row_keys
from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]

# What a term counts that is at the robot's scale.
POINTS = 50.0
# Pairs of base and grasp that are evaluated in one go.
_PAIRS = 1024
TERMS = ("grasp", "manipulability", "clutter")
# A term more, where a scene gives it a weight.
JOINT_MARGIN = "joint_margin"


class Scores(NamedTuple):
    """What n pairs of base and grasp are worth at one end.

    `q` is the best configuration, hand closed, NaN where there is none; `terms` holds
    the weighted terms in the order of `term_names`, which add up to `total`.
    """

    total: Array  # (n,)
    terms: Array  # (n, terms)
    q: Array  # (n, nq)
    outcome: npt.NDArray[np.int8]  # (n,) of Outcome


def term_factors(problem: Problem) -> Array:
    """What the raw values are multiplied by, in the order of `term_names`."""
    settings, scales = problem.score, problem.robot.score_scales
    factors = [
        settings.grasp,
        settings.manipulability / scales.manipulability,
        settings.clutter / scales.clutter,
        *(more.weight for more in _more_terms(problem)),
    ]
    return POINTS * np.array(factors)


def term_names(problem: Problem) -> tuple[str, ...]:
    """The terms that a problem's score is made of."""
    return (*TERMS, *(more.name for more in _more_terms(problem)))


def _more_terms(problem: Problem) -> tuple[WeightedTerm, ...]:
    """The terms that the paper does not have."""
    settings = problem.score
    if settings.joint_margin == 0.0:
        return settings.more
    margin = JointMargin(problem.robot)
    return (
        WeightedTerm(JOINT_MARGIN, margin, settings.joint_margin),
        *settings.more,
    )


class Holds(NamedTuple):
    """How the hand holds the object in n grasps."""

    T_object_tool: Array  # (n, 4, 4)
    opened: Array  # (n, hand joints), before it closes
    closed: Array  # (n, hand joints), on the object
    quality: Array  # G, (n,)
    outcome: npt.NDArray[np.int8]  # NO_CONTACT, LOW_QUALITY, NOT_CARRIED, SCORED


class ScoreFunction:
    """The score of the paper's section IV.A for one task.

    `Score(q_base, grasp)` is the greatest weighted sum of the terms over all solutions
    of inverse kinematics that are feasible at the given end, and 0 if there is none.
    Answers are remembered: the same base, grasp and end are evaluated once.
    """

    def __init__(
        self, problem: Problem, task: Task, world: CollisionWorld, family: GraspFamily
    ) -> None:
        """Prepare for a task in a world in which its object stands at the start."""
        self.problem = problem
        self.task = task
        self.family = family
        self.worlds = {
            End.START: world.place(task.object, world.standing[task.object]),
            End.GOAL: world.place(task.object, task.T_world_goal),
        }
        robot = problem.robot
        self._feasibility = {
            end: Feasibility(problem, w, task.object) for end, w in self.worlds.items()
        }
        self.closer = HandCloser(robot, world.scenery.objects[task.object])
        self._quality = quality_measure(problem, task, family, self.closer)
        T_world_start = world.standing[task.object]
        self._carriable = Carriable(problem, task, T_world_start)
        self._centre = world.scenery.centre_of_mass(task.object)
        self.clutter = Clutter(
            robot, {e: w.without(task.object) for e, w in self.worlds.items()}
        )
        self.terms = term_names(problem)
        self.factors = term_factors(problem)
        self._search = BranchSearch(
            robot,
            self._feasibility,
            self.clutter,
            self.factors,
            [more.term for more in _more_terms(problem)],
        )
        self._holds = RowCache()
        self._bases = {end: RowCache() for end in End}
        self._scores = {end: RowCache() for end in End}
        self._numbers: dict[bytes, int] = {}

    def __call__(self, end: End, q_base: Array, grasps: Array) -> Scores:
        """Score bases (n, b) with grasp genes (n, g), row by row, at one end."""
        keys = [b + g for b, g in zip(row_keys(q_base), row_keys(grasps), strict=True)]
        rows = self._scores[end].rows(
            list(keys), lambda new: self._evaluate(end, q_base[new], grasps[new])
        )
        first = 1 + len(self.terms)  # of the columns of q
        total, terms, q, outcome = np.split(rows, [1, first, rows.shape[1] - 1], axis=1)
        return Scores(total[:, 0], terms, q, outcome[:, 0].astype(np.int8))

    def remember(self, end: End, q_base: Array, grasps: Array, scores: Scores) -> None:
        """Take over scores that the same function gave elsewhere, row by row."""
        keys = [b + g for b, g in zip(row_keys(q_base), row_keys(grasps), strict=True)]
        total, terms, q, outcome = scores
        self._scores[end].put(
            list(keys), np.column_stack([total, terms, q, outcome.astype(np.float64)])
        )

    def centre_of_mass(self, end: End) -> Array:
        """The object's centre of mass in the world at one end, (3,), m."""
        T = self.worlds[end].standing[self.task.object]
        return T[:3, :3] @ self._centre + T[:3, 3]

    def holds(self, grasps: Array) -> Holds:
        """Tool poses and hand openings of grasp genes (n, g)."""
        rows = self._holds.rows(
            list(row_keys(grasps)), lambda new: self._hold(grasps[new])
        )
        hand = len(self.problem.robot.hand)
        pose, opened, closed, rated = np.split(rows, [16, 16 + hand, 16 + 2 * hand], 1)
        quality, outcome = rated.T
        return Holds(
            pose.reshape(-1, 4, 4), opened, closed, quality, outcome.astype(np.int8)
        )

    def breakdown(self, end: End, q_base: Array, grasp: Array) -> Breakdown:
        """The score of one base (b,) and grasp (g,) by term and by link."""
        base, grasps = q_base[None], grasp[None]
        score = self(end, base, grasps)
        outcome = Outcome(score.outcome[0])
        terms = dict(zip(self.terms, score.terms[0].tolist(), strict=True))
        if outcome != Outcome.SCORED:
            return Breakdown(outcome, 0.0, terms)
        T_world_tool = self._in_world(end, self.holds(grasps).T_object_tool)
        numbers = self._number(base), self._number(grasps)
        grasped = Grasped(end, score.q, *numbers, T_world_tool)
        links = links_of(self.clutter, grasped, self.factors[TERMS.index("clutter")])
        return Breakdown(outcome, float(score.total[0]), terms, links)

    def contacts(self, end: End, q_base: Array, grasp: Array) -> tuple[Contact, ...]:
        """What one base (b,) and grasp (g,) collide with, see `overlap`."""
        found = self.overlap(end, q_base, grasp)
        return () if found is None else found.contacts

    def overlap(self, end: End, q_base: Array, grasp: Array) -> Overlap | None:
        """What one base (b,) and grasp (g,) collide with, in the best of all branches.

        That is the branch whose deepest overlap is smallest; hand closed, or opened
        where nothing else is in the way. None where no configuration is in collision.
        """
        feasibility = self._feasibility[end]
        if self.base_outcomes(end, q_base[None])[0] == Outcome.BASE_COLLISION:
            return feasibility.base_overlap(q_base)
        hold = self.holds(grasp[None])
        arms = feasibility.arms(q_base[None], hold.T_object_tool)
        q = arms.q[arms.within]
        q[:, self.problem.robot.hand.indices] = hold.closed[0]
        return feasibility.least_overlap(q, hold.opened[0])

    def arms(self, end: End, q_base: Array, grasps: Array) -> Arms:
        """What reaches grasps (n, g) from bases (n, b), in collision or not."""
        return self.arms_to(end, q_base, self.family.tool_poses(grasps))

    def arms_to(self, end: End, q_base: Array, T_object_tool: Array) -> Arms:
        """The same for tool poses (n, 4, 4) in the object's frame."""
        return self._feasibility[end].arms(q_base, T_object_tool)

    def base_outcomes(self, end: End, q_base: Array) -> npt.NDArray[np.int8]:
        """What is known of bases (n, b) without any grasp, (n,) of Outcome."""
        rows = self._bases[end].rows(
            list(row_keys(q_base)),
            lambda new: self._base_outcome_rows(end, q_base[new]),
        )
        return rows[:, 0].astype(np.int8)

    def _base_outcome_rows(self, end: End, q_base: Array) -> Array:
        outcomes = self._feasibility[end].base_outcomes(q_base)
        return outcomes[:, None].astype(np.float64)

    def _hold(self, grasps: Array) -> Array:
        """The rows of `_holds`: pose, opened and closed hand, quality, outcome."""
        T_object_tool = self.family.tool_poses(grasps)
        closings = self.closer.close(T_object_tool)
        outcome = np.where(closings.touches, Outcome.SCORED, Outcome.NO_CONTACT)
        quality = self._quality(Hold(grasps, T_object_tool, closings))
        low = quality < self.problem.score.min_quality
        outcome = np.where(closings.touches & low, Outcome.LOW_QUALITY, outcome)
        held = np.flatnonzero(outcome == Outcome.SCORED)
        dropped = held[~self._carriable(T_object_tool[held])]
        outcome[dropped] = Outcome.NOT_CARRIED
        return np.concatenate(
            [
                T_object_tool.reshape(-1, 16),
                closings.opened,
                closings.closed,
                np.stack([quality, outcome], axis=1),
            ],
            axis=1,
        )

    def _evaluate(self, end: End, q_base: Array, grasps: Array) -> Array:
        """The rows of `_scores`, a part at a time, as each may have many branches."""
        parts = [
            self._rows(end, q_base[i : i + _PAIRS], grasps[i : i + _PAIRS])
            for i in range(0, max(1, len(q_base)), _PAIRS)
        ]
        return np.concatenate(parts)

    def _rows(self, end: End, q_base: Array, grasps: Array) -> Array:
        """Rows of `_scores`: total, terms, q, outcome."""
        first = 1 + len(self.terms)  # of the columns of q
        nq = self.problem.robot.model.nq
        result = np.zeros((len(q_base), first + nq + 1))
        result[:, first:-1] = np.nan
        outcome, branches = self._branches(end, q_base, grasps)
        best = self._search.best(branches, outcome)
        result[best.row, 0] = best.terms.sum(axis=1)
        result[best.row, 1:first] = best.terms
        result[best.row, first:-1] = best.q
        result[:, -1] = outcome
        return result

    def _branches(
        self, end: End, q_base: Array, grasps: Array
    ) -> tuple[npt.NDArray[np.int8], Branches]:
        """The outcome of each pair (n,) so far, and what is left to check.

        Tests come in the order of `Outcome`, each on what the tests before it have
        left. Pairs that pass all have branches, and COLLISION for their outcome.
        """
        outcome = self.base_outcomes(end, q_base)
        left = np.flatnonzero(outcome == Outcome.SCORED)
        arms = self.arms(end, q_base[left], grasps[left])
        outcome[left] = arms.outcome
        reached = arms.outcome == Outcome.SCORED
        arms, left = arms.rows(reached), left[reached]
        holds = self.holds(grasps[left])
        held = holds.outcome == Outcome.SCORED
        outcome[left] = np.where(held, Outcome.COLLISION, holds.outcome)
        which, branch = np.nonzero(arms.within & held[:, None])
        row, q = left[which], arms.q[which, branch]
        q[:, self.problem.robot.hand.indices] = holds.closed[which]
        T_object_tool = holds.T_object_tool[which]
        numbers = self._number(q_base)[row], self._number(grasps)[row]
        grasped = Grasped(end, q, *numbers, self._in_world(end, T_object_tool))
        opened, quality = holds.opened[which], holds.quality[which]
        return outcome, Branches(row, grasped, opened, quality)

    def _in_world(self, end: End, T_object_tool: Array) -> Array:
        """Poses T_world_tool (n, 4, 4) of tool poses in the object's frame."""
        return self.worlds[end].standing[self.task.object] @ T_object_tool

    def _number(self, rows: Array) -> Indices:
        """A number for each row, the same for equal rows."""
        numbers = self._numbers
        found = [numbers.setdefault(key, len(numbers)) for key in row_keys(rows)]
        return np.array(found, dtype=np.int64)
