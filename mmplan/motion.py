"""The motion of one task: from where the robot is to the object delivered."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mmplan.candidate import Candidate
from mmplan.collision import TOUCH_TOLERANCE, CollisionWorld, supports
from mmplan.ik.windings import windings
from mmplan.plan import Segment
from mmplan.planning import (
    ShortMotion,
    hand_motion,
    motion_limits,
    plan_path,
    straight_motion,
    time_path,
    transfer_joints,
    transit_joints,
)
from mmplan.problem import Problem, Task
from mmplan.scoring import End
from mmplan.shapes import Array

# The length of a straight tool motion for which the scene gives none, m; where there
# is no room for it, it is shortened by these factors.
DEFAULT_LENGTH = 0.1
_FACTORS = (1.0, 0.5, 0.25)
# The shares of the clearance wanted that a path is tried with.
_SHARES = (1.0, 0.25, 0.0)
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Blocked:
    """Which segment could not be planned, and why."""

    segment: str
    message: str


class _BlockedError(Exception):
    """Carries a `Blocked` out of the steps of one motion."""

    def __init__(self, segment: str, message: str) -> None:
        super().__init__(message)
        self.blocked = Blocked(segment, message)


@dataclass(frozen=True, eq=False)
class _Part:
    """One segment before it is timed."""

    name: str
    world: CollisionWorld
    path: Array  # (n, nq)
    attached: dict[str, Array] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class TaskMotion:
    """Plans the motion of one task for one candidate after the other."""

    problem: Problem
    task: Task
    world: CollisionWorld  # the object at its start

    def plan(
        self, candidate: Candidate, rng: np.random.Generator
    ) -> tuple[Segment, ...] | Blocked:
        """The segments of the whole motion, or what stood in its way."""
        try:
            parts = self._parts(candidate, rng)
            return tuple(self._timed(part) for part in parts if len(part.path) > 1)
        except _BlockedError as error:
            return error.blocked

    def _parts(self, candidate: Candidate, rng: np.random.Generator) -> list[_Part]:
        """All segments in order: the short ones first, as they fail soonest."""
        carried = {self.task.object: candidate.T_tool_object}
        carrying = self.world.attach(self.task.object, candidate.T_tool_object)
        pick = self._pick(candidate, carrying, carried)
        place = self._place(candidate, carrying, carried)
        transit, pick = self._transit(pick, rng)
        transfer, place = self._transfer(pick, place, carrying, carried, rng)
        return [transit, *pick, transfer, *place]

    def _pick(
        self, candidate: Candidate, carrying: CollisionWorld, carried: dict[str, Array]
    ) -> list[_Part]:
        """Approach, grasp and lift."""
        q_closed = candidate.q[End.START]
        q_open = self._with_hand(q_closed, candidate.opened)
        back = -self._approach_direction(q_closed)
        approach = self._straight("approach", self.world, q_open, back)[::-1]
        touching = self.world.permit_touch(self.task.object, fingers=True)
        grasp = self._hand("grasp", touching, q_open, candidate.closed)
        leaving = self._resting(carrying, self.world.standing[self.task.object])
        lift = self._straight("lift", leaving, q_closed, _UP)
        return [
            _Part("approach", self.world, approach),
            _Part("grasp", touching, grasp),
            _Part("lift", leaving, lift, carried),
        ]

    def _place(
        self, candidate: Candidate, carrying: CollisionWorld, carried: dict[str, Array]
    ) -> list[_Part]:
        """Lower, release and retreat."""
        q_closed = candidate.q[End.GOAL]
        q_open = self._with_hand(q_closed, candidate.opened)
        arriving = self._resting(carrying, self.task.T_world_goal)
        lower = self._straight("lower", arriving, q_closed, _UP)[::-1]
        placed = self.world.place(self.task.object, self.task.T_world_goal)
        touching = placed.permit_touch(self.task.object, fingers=True)
        release = self._hand("release", touching, q_closed, candidate.opened)
        back = -self._approach_direction(q_closed)
        retreat = self._straight("retreat", placed, q_open, back)
        return [
            _Part("lower", arriving, lower, carried),
            _Part("release", touching, release),
            _Part("retreat", placed, retreat),
        ]

    def _transit(
        self, pick: list[_Part], rng: np.random.Generator
    ) -> tuple[_Part, list[_Part]]:
        """The way to the pick, and the pick on the winding that it arrives at."""
        turns = self._turns(pick)
        q_first = pick[0].path[0]
        world, path, turn = self._search(
            "transit", self.world, self.problem.q_start, q_first + turns, rng
        )
        return _Part("transit", world, path), _turned(pick, turns[turn])

    def _transfer(
        self,
        pick: list[_Part],
        place: list[_Part],
        carrying: CollisionWorld,
        carried: dict[str, Array],
        rng: np.random.Generator,
    ) -> tuple[_Part, list[_Part]]:
        """The way from pick to place, and the place on the winding it arrives at.

        Where there is no lift or lower the object starts or ends in contact.
        """
        world = carrying
        if len(pick[-1].path) == 1:
            world = self._resting(world, self.world.standing[self.task.object])
        if len(place[0].path) == 1:
            world = self._resting(world, self.task.T_world_goal)
        turns = self._turns(place)
        world, path, turn = self._search(
            "transfer", world, pick[-1].path[-1], place[0].path[0] + turns, rng
        )
        return _Part("transfer", world, path, carried), _turned(place, turns[turn])

    def _search(
        self,
        name: str,
        world: CollisionWorld,
        q_start: Array,
        q_goals: Array,
        rng: np.random.Generator,
    ) -> tuple[CollisionWorld, Array, int]:
        """A path to one of several goals, which goal it is, and the world it is for.

        Paths that keep a clearance are tried first.
        """
        settings = self.problem.planner
        joints = (transit_joints if name == "transit" else transfer_joints)(
            self.problem
        )
        for clearance in dict.fromkeys(settings.clearance * share for share in _SHARES):
            keeping = world.keeping(clearance)
            result = plan_path(keeping, q_start, q_goals, joints, settings, rng)
            if result.path is not None and result.goal is not None:
                return keeping, result.path, result.goal
        raise _BlockedError(name, result.message)

    def _straight(
        self, name: str, world: CollisionWorld, q: Array, direction: Array
    ) -> Array:
        """A straight tool motion (n, nq) from q, as long as the task wants it."""
        wanted: float | None = getattr(self.task, name)
        lengths = [DEFAULT_LENGTH * f for f in _FACTORS] if wanted is None else [wanted]
        motion: ShortMotion | None = None
        for length in lengths:
            if length == 0.0:
                return q[None]
            motion = straight_motion(
                world, q, direction, length, self.problem.planner.resolution
            )
            if motion.complete:
                return motion.path
        assert motion is not None
        raise _BlockedError(name, motion.message)

    def _hand(self, name: str, world: CollisionWorld, q: Array, hand: Array) -> Array:
        motion = hand_motion(world, q, hand, self.problem.planner.resolution)
        if not motion.complete:
            raise _BlockedError(name, motion.message)
        return motion.path

    def _timed(self, part: _Part) -> Segment:
        """The segment of a part, as fast as the robot's limits allow."""
        limits = motion_limits(self.problem.robot)
        resolution = self.problem.planner.resolution
        result = time_path(part.world, part.path, limits, resolution)
        if result.motion is None:
            raise _BlockedError(part.name, result.message)
        motion = result.motion
        return Segment(
            part.name, motion.times, motion.positions, motion.velocities, part.attached
        )

    def _with_hand(self, q: Array, hand: Array) -> Array:
        q = q.copy()
        q[self.problem.robot.hand.indices] = hand
        return q

    def _approach_direction(self, q: Array) -> Array:
        """The tool's z axis in the world, (3,)."""
        return self.problem.robot.tool_pose(q)[:3, 2]

    def _resting(self, world: CollisionWorld, T_world_object: Array) -> CollisionWorld:
        """The world in which the object may touch what it stands on at a pose."""
        name = self.task.object
        touched = supports(
            world.scenery, name, T_world_object, TOUCH_TOLERANCE, world.standing
        )
        return world.permit_touch(name, supports=touched)

    def _turns(self, parts: list[_Part]) -> Array:
        """Whole turns of the arm's joints (m, nq) that keep all parts within limits."""
        arm = self.problem.robot.arm
        q = np.concatenate([part.path for part in parts])[:, arm.indices]
        others = windings(q[0], arm.lower, arm.upper) - q[0]
        inside = [
            bool(np.all((q + t >= arm.lower) & (q + t <= arm.upper))) for t in others
        ]
        turns = np.zeros((sum(inside), self.problem.robot.model.nq))
        turns[:, arm.indices] = others[inside]
        return turns


def _turned(parts: list[_Part], turn: Array) -> list[_Part]:
    return [_Part(p.name, p.world, p.path + turn, p.attached) for p in parts]
