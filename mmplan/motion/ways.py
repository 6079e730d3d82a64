"""Ways of the whole robot from one configuration to another, whatever its base."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mmplan.motion.parts import BlockedError, Leg
from mmplan.motion.postures import drive_postures
from mmplan.planning import (
    MovingJoints,
    PlanningWorld,
    ReedsShepp,
    Steering,
    TurnInPlace,
    plan_drive,
    plan_path,
    standing_joints,
    transfer_joints,
    transit_joints,
)
from mmplan.problem import Problem
from mmplan.shapes import Array

# Places of the base nearer to each other than this are one, m and rad.
_SAME = 1e-9


@dataclass(frozen=True, eq=False)
class Way:
    """Legs one after the other, and which goal they reach.

    The last leg ends at that goal plus whole `turns` (nq,) of joints without limits.
    """

    legs: tuple[Leg, ...]
    goal: int
    turns: Array


@dataclass(frozen=True, eq=False)
class WayFinder:
    """Finds the way of one segment, for bases that move freely and for those that roll.

    A base that rolls does so with the arm held in one posture: the arm goes there, the
    base drives, the arm goes on. Postures are tried in turn.
    """

    problem: Problem
    segment: str
    world: PlanningWorld
    hand: bool  # whether the fingers move

    def find(self, q_start: Array, q_goals: Array, rng: np.random.Generator) -> Way:
        """A way from q_start (nq,) to one of q_goals (g, nq).

        Goals differ from each other in the arm's joints alone.

        Raises:
            BlockedError: None was found.
        """
        steering = steering_of(self.problem)
        if steering is None:
            joints = transit_joints if self.hand else transfer_joints
            return self._path(q_start, q_goals, joints(self.problem), rng)
        if self._is_there(q_start, q_goals[0]):
            return self._reach_out(q_start, q_goals, rng)
        message = "no posture is free to drive in"
        robot = self.problem.robot
        for q_arm in drive_postures(robot, self.world, q_start, q_goals[0], rng):
            try:
                return self._drive(q_start, q_goals, q_arm, steering, rng)
            except BlockedError as error:  # noqa: PERF203 (as many as there are postures)
                message = error.blocked.message
        raise BlockedError(self.segment, message)

    def _drive(
        self,
        q_start: Array,
        q_goals: Array,
        q_arm: Array,
        steering: Steering,
        rng: np.random.Generator,
    ) -> Way:
        """To a posture of the arm, driving in it, and from it to a goal."""
        robot, problem = self.problem.robot, self.problem
        base = robot.base.indices
        q_tucked = q_start.copy()
        q_tucked[robot.arm.indices] = q_arm
        result = plan_drive(
            self.world,
            q_tucked,
            q_goals[0, base],
            base,
            problem.base_bounds,
            steering,
            problem.planner,
            rng,
        )
        if result.drive is None:
            raise BlockedError(self.segment, result.message)
        still = standing_joints(problem, hand=False)
        tuck = self._path(q_start, q_tucked[None], still, rng)
        drive = result.drive.turned(tuck.turns)
        reach = self._reach_out(drive.path[-1], q_goals, rng)
        return Way((*tuck.legs, drive, *reach.legs), reach.goal, reach.turns)

    def _reach_out(
        self, q_start: Array, q_goals: Array, rng: np.random.Generator
    ) -> Way:
        """The way of the arm alone, the base being where the goals have it."""
        base = self.problem.robot.base
        apart = (q_start - q_goals[0])[base.indices]
        turns = np.zeros(len(q_start))
        turns[base.indices] = base.wraps * 2.0 * np.pi * np.rint(apart / (2.0 * np.pi))
        q_goals = q_goals.copy()
        q_goals[:, base.indices] = q_start[base.indices]
        still = standing_joints(self.problem, hand=self.hand)
        way = self._path(q_start, q_goals, still, rng)
        return replace(way, turns=turns + way.turns)

    def _is_there(self, q_start: Array, q_goal: Array) -> bool:
        """Whether the base is where it has to be, perhaps whole turns off."""
        base = self.problem.robot.base
        apart = (q_goal - q_start)[base.indices]
        turns = base.wraps * 2.0 * np.pi * np.rint(apart / (2.0 * np.pi))
        return bool(np.all(np.abs(apart - turns) <= _SAME))

    def _path(
        self,
        q_start: Array,
        q_goals: Array,
        joints: MovingJoints,
        rng: np.random.Generator,
    ) -> Way:
        settings = self.problem.planner
        result = plan_path(self.world, q_start, q_goals, joints, settings, rng)
        if result.path is None or result.goal is None or result.turns is None:
            raise BlockedError(self.segment, result.message)
        return Way((result.path,), result.goal, result.turns)


def steering_of(problem: Problem) -> Steering | None:
    """How the base steers; None where it moves freely or stands."""
    robot = problem.robot
    if problem.base_stands:
        return None
    if robot.base_type == "diff_drive":
        return TurnInPlace()
    if robot.base_type == "reeds_shepp":
        return ReedsShepp(robot.turning_radius)
    return None
