"""From the parts of a task's motion to its timed segments."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import pinocchio as pin

from mmplan.collision import CollisionWorld, inertia_of
from mmplan.motion.parts import BlockedError, Part, time_part
from mmplan.plan import Segment
from mmplan.planning import PathLimit, ToolSpeed, TorqueLimit, motion_limits
from mmplan.problem import Problem, Task


@dataclass(frozen=True, eq=False)
class Timing:
    """Times parts as fast as the robot and the rules of its task allow."""

    problem: Problem
    task: Task
    world: CollisionWorld  # the object at its start

    def segments(self, parts: Iterable[Part]) -> tuple[Segment, ...]:
        """The segments of the parts that move.

        Raises:
            BlockedError: The timed motion would touch something.
        """
        return tuple(self._timed(part) for part in parts if part.moves)

    def require_strength(self, part: Part) -> None:
        """Refuse a part at whose ends the arm cannot stand still, before all planning.

        Raises:
            BlockedError: naming the joint.
        """
        if not self.problem.planner.torque:
            return
        limit = self._torque_limit(part)
        for q in (part.path[0], part.path[-1]):
            weak = limit.too_weak(q)
            if weak:
                raise BlockedError(part.name, weak)

    def _timed(self, part: Part) -> Segment:
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

    def _torque_limit(self, part: Part) -> TorqueLimit:
        """The limit of torques with what a part carries, if that has a mass."""
        robot, name = self.problem.robot, self.task.object
        mass = self.problem.object(name).mass
        if name not in part.attached or mass is None:
            return TorqueLimit(robot)
        inertia = inertia_of(self.world.scenery.objects[name], mass)
        return TorqueLimit(robot, pin.SE3(part.attached[name]).act(inertia))
