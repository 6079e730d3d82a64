"""Which bases and grasps are feasible at one end of a task, in which configurations.

Feasible means free of collision with the hand closed on the object and with the hand
opened around it, as it must be just before grasping and just after releasing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.collision import CollisionWorld, Contact
from mmplan.problem import Problem
from mmplan.robot import Robot
from mmplan.scoring.hand_poses import HandPoses
from mmplan.scoring.outcome import Outcome
from mmplan.scoring.term import Grasped, RowCache
from mmplan.shapes import Array
from mmplan.zones import base_clearances

Mask = npt.NDArray[np.bool_]


class Arms(NamedTuple):
    """All configurations of the robot, hand closed, that reach n grasps."""

    q: Array  # (n, branches, nq)
    exists: Mask  # (n, branches)
    within: Mask  # (n, branches), also within the joint limits

    def rows(self, which: Mask) -> Arms:
        """Those of some of the grasps, by a mask (n,)."""
        return Arms(self.q[which], self.exists[which], self.within[which])

    @property
    def outcome(self) -> npt.NDArray[np.int8]:
        """NO_IK, JOINT_LIMITS or SCORED, (n,)."""
        outcome = np.full(len(self.q), Outcome.NO_IK, np.int8)
        outcome[self.exists.any(axis=1)] = Outcome.JOINT_LIMITS
        outcome[self.within.any(axis=1)] = Outcome.SCORED
        return outcome


class Overlap(NamedTuple):
    """A configuration and what overlaps in it, deepest first."""

    q: Array  # (nq,)
    contacts: tuple[Contact, ...]


class Feasibility:
    """The tests of one end of a task, cheapest first."""

    def __init__(
        self, problem: Problem, world: CollisionWorld, object_name: str
    ) -> None:
        """Prepare for a world in which the object stands at that end."""
        self._robot: Robot = problem.robot
        self._bounds = problem.base_bounds
        self._forbidden = problem.forbidden if len(self._robot.base) else ()
        self._T_world_object = world.standing[object_name]
        self._open_fingers = world.fingers_alone()
        self._closed_world = world.permit_touch(object_name, fingers=True)
        # What the hand does to the scene depends on the grasp alone.
        self._hand_open = self._open_fingers.hand_in_scene()
        self._hand_closed = self._closed_world.hand_in_scene()
        self._rest_open = self._open_fingers.except_hand_in_scene()
        self._rest_closed = self._closed_world.except_hand_in_scene()
        self._hand_poses = HandPoses(problem.robot)
        self._hands = RowCache()
        self._base_world = world.base_alone()

    def base_outcomes(self, q_base: Array) -> npt.NDArray[np.int8]:
        """OUT_OF_BOUNDS, BASE_COLLISION or SCORED for base placements (n, b), (n,)."""
        q = self._standing(q_base)
        outcome = np.full(len(q_base), Outcome.SCORED, np.int8)
        outcome[self._base_world.in_collision(q)] = Outcome.BASE_COLLISION
        low, high = self._bounds.T
        outside = np.any((q_base < low) | (q_base > high), axis=1)
        if self._forbidden:
            radius = self._robot.base_radius
            outside |= base_clearances(self._forbidden, q_base, radius) < 0.0
        outcome[outside] = Outcome.OUT_OF_BOUNDS
        return outcome

    def arms(self, q_base: Array, T_object_tool: Array) -> Arms:
        """Solve bases (n, b) and tool poses (n, 4, 4) in the object's frame, in pairs.

        The hand is as in the robot's neutral configuration.
        """
        robot = self._robot
        T_base_world = np.linalg.inv(robot.base_poses(q_base))
        T_base_tool = T_base_world @ self._T_world_object @ T_object_tool
        solutions = robot.ik.solve(T_base_tool)
        n, branches = solutions.exists.shape
        q = np.tile(robot.q_neutral, (n, branches, 1))
        q[..., robot.base.indices] = q_base[:, None]
        q[..., robot.arm.indices] = solutions.q
        return Arms(q, solutions.exists, solutions.within)

    def hand_outcomes(self, grasped: Grasped, opened: Array) -> npt.NDArray[np.int8]:
        """What the hand by itself comes to in the scene, (n,), whatever arm holds it.

        COLLISION, HAND_OPEN_COLLISION or SCORED; `opened` (n, hand joints) is the hand
        before it closes.
        """

        def of_grasps(new: npt.NDArray[np.int64]) -> Array:
            T, q = grasped.T_world_tool[new], grasped.q[new]
            closed = self._hand_closed.in_collision_at(self._hand_poses(T, q))
            q[:, self._robot.hand.indices] = opened[new]
            hit = self._hand_open.in_collision_at(self._hand_poses(T, q))
            outcome = np.where(hit, Outcome.HAND_OPEN_COLLISION, Outcome.SCORED)
            return np.where(closed, Outcome.COLLISION, outcome)[:, None]

        rows = self._hands.rows(grasped.grasp.tolist(), of_grasps)
        return rows[:, 0].astype(np.int8)

    def outcomes(self, q: Array, opened: Array, fits: Mask) -> npt.NDArray[np.int8]:
        """COLLISION, HAND_OPEN_COLLISION or SCORED for configurations q (m, nq), (m,).

        The closed hand is known to fit in the scene; `fits` (m,) says whether it does
        opened, which is at `opened` (m, hand joints).
        """
        outcome = np.full(len(q), Outcome.HAND_OPEN_COLLISION, np.int8)
        outcome[self._rest_closed.in_collision(q)] = Outcome.COLLISION
        left = np.flatnonzero(fits & (outcome != Outcome.COLLISION))
        q_open = q[left]
        q_open[:, self._robot.hand.indices] = opened[left]
        outcome[left[~self._rest_open.in_collision(q_open)]] = Outcome.SCORED
        return outcome

    def base_overlap(self, q_base: Array) -> Overlap:
        """What the base alone overlaps at (base joints,), all else neutral."""
        q = self._standing(q_base[None])[0]
        return Overlap(q, self._base_world.contacts(q))

    def least_overlap(self, q: Array, opened: Array) -> Overlap | None:
        """The overlap of that configuration of q (m, nq) whose deepest is smallest.

        The hand is closed in q; it is `opened` (hand joints,) where nothing else
        overlaps. None if nothing overlaps in any.
        """
        q_open = q.copy()
        q_open[:, self._robot.hand.indices] = opened
        found = [
            Overlap(a, closed)
            if (closed := self._closed_world.contacts(a))
            else Overlap(b, self._open_fingers.contacts(b))
            for a, b in zip(q, q_open, strict=True)
        ]
        overlaps = [o for o in found if o.contacts]
        return min(overlaps, key=lambda o: o.contacts[0].depth, default=None)

    def _standing(self, q_base: Array) -> Array:
        """Configurations (n, nq) with the base at (n, b) and all else neutral."""
        q = np.tile(self._robot.q_neutral, (len(q_base), 1))
        q[:, self._robot.base.indices] = q_base
        return q
