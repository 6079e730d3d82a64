"""From a candidate to the timed segments of a task."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from mmplan.candidate import Candidate
from mmplan.collision import CollisionWorld, inertia_of
from mmplan.ik.windings import windings
from mmplan.motion.carrying import kept_upright
from mmplan.motion.parts import Blocked, BlockedError, Part, time_part
from mmplan.motion.short_motions import ShortMotions
from mmplan.motion.ways import WayFinder
from mmplan.motion.zoned_world import with_zones
from mmplan.plan import Segment
from mmplan.planning import PathLimit, ToolSpeed, TorqueLimit, motion_limits
from mmplan.problem import Problem, Task
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class TaskMotion:
    """Plans the motion of one task for one candidate after the other."""

    problem: Problem
    task: Task
    world: CollisionWorld  # the object at its start
    without_lines: bool = False  # whether straight motions may be left out

    def plan(
        self, candidate: Candidate, rng: np.random.Generator
    ) -> tuple[Segment, ...] | Blocked:
        """The segments of the whole motion, or what stood in its way."""
        try:
            parts = self._parts(candidate, rng)
            return tuple(self._timed(part) for part in parts if part.moves)
        except BlockedError as error:
            return error.blocked

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

    def _parts(self, candidate: Candidate, rng: np.random.Generator) -> list[Part]:
        """All segments in order, planned the short ones first, as they fail soonest."""
        carrying = self._carrying(candidate)
        pick = self._short.pick(candidate, carrying)
        place = self._short.place(candidate, carrying)
        self._require_strength(pick[-1], place[0])
        transit, pick = self._transit(pick, rng)
        transfer, place = self._transfer(pick, place, carrying, rng)
        return [transit, *pick, transfer, *place]

    def _transit(
        self, pick: list[Part], rng: np.random.Generator
    ) -> tuple[Part, list[Part]]:
        """The way to the pick, and the pick on the winding that it arrives at."""
        return self._joined("transit", self.world, self.problem.q_start, pick, rng)

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
        world = carrying
        if not pick[-1].moves:
            world = self._short.resting(world, self.world.standing[self.task.object])
        if not place[0].moves:
            world = self._short.resting(world, self.task.T_world_goal)
        return self._joined("transfer", world, pick[-1].path[-1], place, rng)

    def _joined(
        self,
        name: str,
        world: CollisionWorld,
        q_start: Array,
        parts: list[Part],
        rng: np.random.Generator,
    ) -> tuple[Part, list[Part]]:
        """The way from q_start (nq,) to where parts begin, and these as it meets them.

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
        finder = WayFinder(self.problem, name, ruled, hand=not world.attached)
        way = finder.find(q_start, q_goals, rng)
        turn = turns[way.goal] + way.turns
        part = Part(name, ruled, way.legs, dict(world.attached))
        return part, [part.turned(turn) for part in parts]

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
