"""A plan as one motion: all segments in a row, and where everything is meanwhile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.robot import Robot
from mmplan.shapes import Array
from mmplan.visualization.film import Mark, film_at
from mmplan.visualization.part import object_carrier
from mmplan.visualization.rotations import pose_numbers

WORLD_FRAME = "world"


@dataclass(frozen=True, eq=False)
class Motion:
    """The samples of a plan. The joints follow cubic Hermite curves in between.

    Poses are (n, 7): position and quaternion [x, y, z, w], in the world.
    """

    joints: tuple[str, ...]
    base_joints: tuple[str, ...]  # those of `joints` that move the base
    base_frame: str  # the link that the base's joints move; the world if there are none
    times: Array  # (n,), s, rising from 0
    positions: Array  # (n, joints)
    velocities: Array  # (n, joints)
    marks: tuple[Mark, ...]  # one a segment
    base: Array  # (n, 7)
    objects: dict[str, Array]  # name -> (n, 7)

    @property
    def others(self) -> list[int]:
        """The places of the joints that do not move the base."""
        return [i for i, n in enumerate(self.joints) if n not in self.base_joints]

    @property
    def segments(self) -> list[str]:
        """The segment that each sample belongs to, by name; the later on a border."""
        starts = np.array([mark.start for mark in self.marks])
        which = np.searchsorted(starts, self.times + 1e-9, side="right") - 1
        return [self.marks[i].name for i in which.tolist()]


def motion_of(problem: Problem, plan: Plan) -> Motion:
    """The motion of a plan for a problem."""
    segments = [s for task in plan.tasks for s in task.segments]
    times, positions, velocities = [np.zeros(1)], [], []
    positions.append(segments[0].positions[:1])
    velocities.append(segments[0].velocities[:1])
    for s in segments:  # each begins where the one before it ends, at rest
        times.append(times[-1][-1] + s.times[1:])
        positions.append(s.positions[1:])
        velocities.append(s.velocities[1:])
    at = np.concatenate(times)
    film = film_at(problem, plan, at)
    robot = problem.robot
    q = np.concatenate(positions)
    return Motion(
        joints=plan.joints,
        base_joints=robot.base.names,
        base_frame=_base_link(robot),
        times=at,
        positions=q,
        velocities=np.concatenate(velocities),
        marks=film.marks,
        base=pose_numbers(robot.base_poses(q[:, robot.base.indices])),
        objects={
            item.name: pose_numbers(film.poses[object_carrier(item.name)])
            for item in problem.objects
        },
    )


def _base_link(robot: Robot) -> str:
    """The first link that the last joint of the base moves."""
    links = [
        frame.name
        for frame in robot.model.frames
        if frame.type == pin.FrameType.BODY and frame.parentJoint == robot.base_joint
    ]
    return str(links[0]) if len(robot.base) else WORLD_FRAME
