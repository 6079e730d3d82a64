"""From a candidate to the timed segments of a task."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mmplan.candidate import Candidate
from mmplan.collision import CollisionWorld, inertia_of
from mmplan.ik.windings import windings
from mmplan.motion.carrying import kept_upright
from mmplan.motion.parts import Blocked, BlockedError, Part, time_part
from mmplan.motion.short_motions import ShortMotions
from mmplan.motion.ways import WayFinder, steering_of
from mmplan.motion.zoned_world import are_alike, with_zones
from mmplan.plan import Segment
from mmplan.planning import (
    PathLimit,
    PlanningWorld,
    ToolSpeed,
    TorqueLimit,
    motion_limits,
)
from mmplan.problem import Problem, Task
from mmplan.shapes import Array


class _Way(NamedTuple):
    """A way yet to be found: its world, its goals (m, nq), and the parts after it.

    Goals are where the parts begin, by whole `turns` (m, nq) of joints.
    """

    world: PlanningWorld
    q_goals: Array
    turns: Array
    parts: list[Part]


class _Ends(NamedTuple):
    """What is known of a candidate before any way is looked for."""

    transit: _Way
    pick: list[Part]
    place: list[Part]
    carrying: CollisionWorld  # the world with the object in the hand


@dataclass(frozen=True, eq=False)
class TaskMotion:
    """Plans the motion of one task for candidates, one by one or together."""

    problem: Problem
    task: Task
    world: CollisionWorld  # the object at its start
    without_lines: bool = False  # whether straight motions may be left out

    def plan(
        self, candidate: Candidate, rng: np.random.Generator
    ) -> tuple[Segment, ...] | Blocked:
        """The segments of the whole motion, or what stood in its way."""
        ((_, outcome),) = self.plan_together([candidate], rng)
        return outcome

    def plan_together(
        self, candidates: Sequence[Candidate], rng: np.random.Generator
    ) -> Iterator[tuple[int, tuple[Segment, ...] | Blocked]]:
        """The number of each candidate and what `plan` says of it, once that is known.

        Transits to all candidates are one search with many goals, where what is in the
        way is the same for them: which is reached first is gone on with first.
        """
        ready: dict[int, _Ends] = {}
        for number, candidate in enumerate(candidates):
            try:
                ready[number] = self._ends(candidate)
            except BlockedError as error:  # noqa: PERF203 (each has its own)
                yield number, error.blocked
        while ready:
            found = self._next(ready, rng)
            for number in found:
                del ready[number]
            yield from found.items()

    def _next(
        self, ready: Mapping[int, _Ends], rng: np.random.Generator
    ) -> Mapping[int, tuple[Segment, ...] | Blocked]:
        """What comes of the candidate reached first, or of all that are not reached."""
        sharing = self._sharing({k: ends.transit for k, ends in ready.items()})
        try:
            number, transit, pick = self._transit(sharing, rng)
        except BlockedError as error:
            return dict.fromkeys(sharing, error.blocked)
        ends = ready[number]
        try:
            transfer, place = self._transfer(pick, ends.place, ends.carrying, rng)
            parts = [transit, *pick, transfer, *place]
            return {number: tuple(self._timed(part) for part in parts if part.moves)}
        except BlockedError as error:
            return {number: error.blocked}

    def blocked_short(self, candidate: Candidate) -> Blocked | None:
        """What stands in the way of the short motions alone, no path being planned."""
        carrying = self._carrying(candidate)
        try:
            self._short.pick(candidate, carrying)
            self._short.place(candidate, carrying)
        except BlockedError as error:
            return error.blocked
        return None

    @cached_property
    def _short(self) -> ShortMotions:
        return ShortMotions(self.problem, self.task, self.world, self.without_lines)

    def _carrying(self, candidate: Candidate) -> CollisionWorld:
        """The world with the object in the hand."""
        world = self.world.attach(self.task.object, candidate.T_tool_object)
        return world.forbidding(self.task.carry.forbidden)

    def _ends(self, candidate: Candidate) -> _Ends:
        """The short motions, planned first as they fail soonest."""
        carrying = self._carrying(candidate)
        pick = self._short.pick(candidate, carrying)
        place = self._short.place(candidate, carrying)
        self._require_strength(pick[-1], place[0])
        transit = self._way(self.world, self.problem.q_start, pick)
        return _Ends(transit, pick, place, carrying)

    def _sharing(self, ways: dict[int, _Way]) -> dict[int, _Way]:
        """The first way and those that one search can look for together with it."""
        first = next(iter(ways))
        if steering_of(self.problem) is not None:
            return {first: ways[first]}
        world = ways[first].world
        return {k: way for k, way in ways.items() if are_alike(way.world, world)}

    def _transit(
        self, ways: Mapping[int, _Way], rng: np.random.Generator
    ) -> tuple[int, Part, list[Part]]:
        """The way to one of the picks, and that pick on the winding it arrives at."""
        return self._joined("transit", self.world, self.problem.q_start, ways, rng)

    def _transfer(
        self,
        pick: list[Part],
        place: list[Part],
        carrying: CollisionWorld,
        rng: np.random.Generator,
    ) -> tuple[Part, list[Part]]:
        """The way from pick to place, and the place on the winding it arrives at.

        Where there is no lift or lower the object starts or ends in contact.
        """
        world, q_start = carrying, pick[-1].path[-1]
        if not pick[-1].moves:
            world = self._short.resting(world, self.world.standing[self.task.object])
        if not place[0].moves:
            world = self._short.resting(world, self.task.T_world_goal)
        way = self._way(world, q_start, place)
        _, transfer, place = self._joined("transfer", world, q_start, {0: way}, rng)
        return transfer, place

    def _way(self, world: CollisionWorld, q_start: Array, parts: list[Part]) -> _Way:
        """What is to be found between q_start (nq,) and where parts begin.

        It keeps the clearance wanted from all that its ends keep it from, and the
        fingers still where an object is carried.
        """
        turns = self._turns(parts)
        q_goals = parts[0].path[0] + turns
        keeping = world.keeping(self.problem.planner.clearance, q_start, *q_goals)
        zoned = with_zones(keeping, self.problem, q_start, q_goals[0])
        ruled = kept_upright(
            zoned, self.problem, self.task, world.attached, q_start, *q_goals
        )
        return _Way(ruled, q_goals, turns, parts)

    def _joined(
        self,
        name: str,
        world: CollisionWorld,
        q_start: Array,
        ways: Mapping[int, _Way],
        rng: np.random.Generator,
    ) -> tuple[int, Part, list[Part]]:
        """The number of the way that was found, it, and what follows as it meets it."""
        ruled = next(iter(ways.values())).world
        number = np.repeat(list(ways), [len(way.turns) for way in ways.values()])
        q_goals = np.vstack([way.q_goals for way in ways.values()])
        turns = np.vstack([way.turns for way in ways.values()])
        finder = WayFinder(self.problem, name, ruled, hand=not world.attached)
        found = finder.find(q_start, q_goals, rng)
        turn = turns[found.goal] + found.turns
        part = Part(name, ruled, found.legs, dict(world.attached))
        reached = int(number[found.goal])
        return reached, part, [x.turned(turn) for x in ways[reached].parts]

    def _timed(self, part: Part) -> Segment:
        """The segment of a part, as fast as the robot's limits allow."""
        limits = motion_limits(self.problem.robot, self._more_limits(part))
        motion = time_part(part, limits, self.problem.planner.resolution)
        return Segment(
            part.name, motion.times, motion.positions, motion.velocities, part.attached
        )

    def _more_limits(self, part: Part) -> tuple[PathLimit, ...]:
        """What limits a part beside the robot's joints."""
        limits: list[PathLimit] = []
        robot, max_speed = self.problem.robot, self.task.carry.max_speed
        if part.attached and max_speed is not None:
            limits.append(ToolSpeed(robot, max_speed))
        if self.problem.planner.torque:
            limits.append(self._torque_limit(part))
        return tuple(limits)

    def _require_strength(self, *parts: Part) -> None:
        """Refuse parts at whose ends the arm cannot stand still, before all planning.

        Raises:
            BlockedError: naming the joint.
        """
        for part in parts if self.problem.planner.torque else ():
            limit = self._torque_limit(part)
            for q in (part.path[0], part.path[-1]):
                weak = limit.too_weak(q)
                if weak:
                    raise BlockedError(part.name, weak)

    def _torque_limit(self, part: Part) -> TorqueLimit:
        """The limit of torques with what a part carries, if that has a mass."""
        robot, name = self.problem.robot, self.task.object
        mass = self.problem.object(name).mass
        if name not in part.attached or mass is None:
            return TorqueLimit(robot)
        inertia = inertia_of(self.world.scenery.objects[name], mass)
        return TorqueLimit(robot, pin.SE3(part.attached[name]).act(inertia))

    def _turns(self, parts: list[Part]) -> Array:
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
