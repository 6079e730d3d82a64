"""The short motions at both ends of a task: straight lines and the hand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.candidate import Candidate
from mmplan.collision import TOUCH_TOLERANCE, CollisionWorld, supports
from mmplan.motion.carrying import kept_upright
from mmplan.motion.parts import BlockedError, Part
from mmplan.planning import UprightWorld, hand_motion, straight_motion
from mmplan.problem import Problem, Task
from mmplan.scoring import End
from mmplan.shapes import Array

# The length of a straight tool motion for which the scene gives none, m; where there
# is no room for it, it is shortened by these factors.
DEFAULT_LENGTH = 0.1
_FACTORS = (1.0, 0.5, 0.25)
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class ShortMotions:
    """Approach, grasp and lift at the start; lower, release and retreat at the goal.

    Nothing is searched for: each motion is free of collision or the candidate fails.
    Straight motions whose length the scene leaves open are shortened where there is no
    room for them and, with `without_lines`, left out where there is none at all.
    """

    problem: Problem
    task: Task
    world: CollisionWorld  # the object at its start
    without_lines: bool = False

    def pick(self, candidate: Candidate, carrying: CollisionWorld) -> list[Part]:
        """Approach, grasp and lift; `carrying` is the world with the object in hand.

        Raises:
            BlockedError: One of them is not free.
        """
        q_closed = candidate.q[End.START]
        q_open = self._with_hand(q_closed, candidate.opened)
        back = -self._approach_direction(q_closed)
        approach = self._straight("approach", self.world, q_open, back)[::-1]
        touching = self.world.permit_touch(self.task.object, fingers=True)
        grasp = self._hand("grasp", touching, q_open, candidate.closed)
        leaving = self._ruled(carrying, self.world.standing[self.task.object], q_closed)
        lift = self._straight("lift", leaving, q_closed, _UP)
        return [
            Part("approach", self.world, (approach,)),
            Part("grasp", touching, (grasp,)),
            Part("lift", leaving, (lift,), dict(carrying.attached)),
        ]

    def place(self, candidate: Candidate, carrying: CollisionWorld) -> list[Part]:
        """Lower, release and retreat; `carrying` is the world with the object in hand.

        Raises:
            BlockedError: One of them is not free.
        """
        q_closed = candidate.q[End.GOAL]
        q_open = self._with_hand(q_closed, candidate.opened)
        arriving = self._ruled(carrying, self.task.T_world_goal, q_closed)
        lower = self._straight("lower", arriving, q_closed, _UP)[::-1]
        placed = self.world.place(self.task.object, self.task.T_world_goal)
        touching = placed.permit_touch(self.task.object, fingers=True)
        release = self._hand("release", touching, q_closed, candidate.opened)
        back = -self._approach_direction(q_closed)
        retreat = self._straight("retreat", placed, q_open, back)
        return [
            Part("lower", arriving, (lower,), dict(carrying.attached)),
            Part("release", touching, (release,)),
            Part("retreat", placed, (retreat,)),
        ]

    def resting(self, world: CollisionWorld, T_world_object: Array) -> CollisionWorld:
        """The world in which the object may touch what it stands on at a pose."""
        name = self.task.object
        touched = supports(
            world.scenery, name, T_world_object, TOUCH_TOLERANCE, world.standing
        )
        return world.permit_touch(name, supports=touched)

    def _ruled(
        self, carrying: CollisionWorld, T_world_object: Array, q: Array
    ) -> CollisionWorld | UprightWorld:
        """The world of a lift or lower that has an end at q (nq,), object at a pose."""
        resting = self.resting(carrying, T_world_object)
        return kept_upright(resting, self.problem, self.task, carrying.attached, q)

    def _straight(
        self,
        name: str,
        world: CollisionWorld | UprightWorld,
        q: Array,
        direction: Array,
    ) -> Array:
        """A straight tool motion (n, nq) from q, as long as the task wants it."""
        wanted: float | None = getattr(self.task, name)
        lengths = [wanted] if wanted is not None else self._open_lengths()
        resolution = self.problem.planner.resolution
        message = ""
        for length in lengths:
            if length == 0.0:
                return q[None]
            motion = straight_motion(world, q, direction, length, resolution)
            if motion.complete:
                return motion.path
            message = motion.message
        raise BlockedError(name, message)

    def _open_lengths(self) -> list[float]:
        lengths = [DEFAULT_LENGTH * factor for factor in _FACTORS]
        return [*lengths, 0.0] if self.without_lines else lengths

    def _hand(self, name: str, world: CollisionWorld, q: Array, hand: Array) -> Array:
        motion = hand_motion(world, q, hand, self.problem.planner.resolution)
        if not motion.complete:
            raise BlockedError(name, motion.message)
        return motion.path

    def _with_hand(self, q: Array, hand: Array) -> Array:
        q = q.copy()
        q[self.problem.robot.hand.indices] = hand
        return q

    def _approach_direction(self, q: Array) -> Array:
        """The tool's z axis in the world, (3,)."""
        return self.problem.robot.tool_pose(q)[:3, 2]
