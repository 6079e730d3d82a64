"""The fingers of a hand, placed around an object."""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.separation import signed_distance, transform
from mmplan.collision.solids import Solid
from mmplan.kinematics import ForwardKinematics, joint_placements, motion_axis
from mmplan.robot import Robot
from mmplan.shapes import Array


class Finger(NamedTuple):
    """The bodies that one joint of the hand moves, and how it moves with its leader.

    A joint that follows no other is its own leader, with a `multiplier` of 1.
    """

    bodies: tuple[pin.GeometryObject, ...]
    multiplier: float = 1.0
    offset: float = 0.0


class Drive(NamedTuple):
    """A joint of the hand that moves by itself, with all fingers that go with it.

    `fingers` maps places among the hand's joints to fingers; the first is the drive's
    own. `top_speed` is the most that any point of them moves per unit of the drive, m.
    """

    place: int
    fingers: dict[int, Finger]
    top_speed: float


class Fingers:
    """The drives of a robot's hand, and where their bodies are around an object."""

    def __init__(self, robot: Robot) -> None:
        """Find the bodies that each joint of the hand moves."""
        self._robot = robot
        self._kinematics = ForwardKinematics(robot.model)
        self.drives = tuple(
            _drive(robot, place) for place in np.flatnonzero(robot.hand.leads).tolist()
        )

    def move(self, hand: Array, rows: npt.NDArray[np.int64], drive: Drive) -> None:
        """Let fingers follow their drive, in some rows of `hand` (n, hand joints)."""
        leader = hand[rows, drive.place]
        for place, finger in drive.fingers.items():
            hand[rows, place] = finger.multiplier * leader + finger.offset

    def placed(
        self, T_object_tool: Array, hand: Array, finger: Finger
    ) -> list[tuple[coal.CollisionGeometry, Array]]:
        """The finger's geometries with their poses (n, 4, 4) in the object's frame.

        For tool poses (n, 4, 4) and values of the hand's joints (n, hand joints).
        """
        robot = self._robot
        q = np.tile(robot.q_neutral, (len(hand), 1))
        q[:, robot.hand.indices] = hand
        T_world_joint = self._kinematics(q)
        T_tool_world = np.linalg.inv(
            T_world_joint[:, robot.tool_joint] @ robot.T_joint_tool
        )
        T_object_world = T_object_tool @ T_tool_world
        return [
            (
                body.geometry,
                T_object_world
                @ (T_world_joint[:, body.parentJoint] @ body.placement.homogeneous),
            )
            for body in finger.bodies
        ]


class ObjectSolids:
    """The solids of an object, ready to be measured from many poses."""

    def __init__(self, solids: tuple[Solid, ...]) -> None:
        """Prepare for an object made of `solids`."""
        self.geometries = [s.geometry for s in solids]
        self.transforms = [transform(s.placement) for s in solids]
        local = [local_bounds(s.geometry) for s in solids]
        stacked = Bounds(*(np.array(part) for part in zip(*local, strict=True)))
        self._bounds = moved_bounds(stacked, np.array([s.placement for s in solids]))

    @property
    def half_diagonal(self) -> float:
        """Half the diagonal of the bounds of all solids together, m."""
        low = (self._bounds.centre - self._bounds.half).min(axis=0)
        high = (self._bounds.centre + self._bounds.half).max(axis=0)
        return float(np.linalg.norm(high - low)) / 2.0

    def gaps(self, geometry: coal.CollisionGeometry, T: Array) -> Array:
        """Lower bounds (n, solids) of a geometry's distances, at poses (n, 4, 4)."""
        bounds = moved_bounds(local_bounds(geometry), T)
        return Bounds(*(part[:, None] for part in bounds)).gap(self._bounds)

    def nearest(self, geometry: coal.CollisionGeometry, T: Array) -> Array:
        """Signed distances (n,) of a geometry at poses (n, 4, 4) to the object."""
        gaps = self.gaps(geometry, T)
        nearest = np.full(len(T), np.inf)
        for i, order in enumerate(np.argsort(gaps, axis=1)):
            pose = transform(T[i])
            for j in order:
                if gaps[i, j] >= nearest[i]:
                    break
                distance = signed_distance(
                    geometry, pose, self.geometries[j], self.transforms[j]
                )
                nearest[i] = min(nearest[i], distance)
        return nearest


def _drive(robot: Robot, place: int) -> Drive:
    group = robot.hand
    leader = int(group.indices[place])
    fingers = {place: Finger(_bodies_moved_by(robot, group.names[place]))}
    speeds = [_top_speed(robot, group.names[place], fingers[place].bodies)]
    for follower in group.followers:
        if follower.leader == leader:
            own = group.indices.tolist().index(follower.follower)
            bodies = _bodies_moved_by(robot, group.names[own])
            fingers[own] = Finger(bodies, follower.multiplier, follower.offset)
            speed = _top_speed(robot, group.names[own], bodies)
            speeds.append(abs(follower.multiplier) * speed)
    return Drive(place, fingers, max(speeds))


def _bodies_moved_by(robot: Robot, name: str) -> tuple[pin.GeometryObject, ...]:
    """The collision bodies that a joint moves."""
    joint = robot.model.getJointId(name)
    return tuple(
        body
        for body in robot.geometry.geometryObjects
        if joint in robot.model.supports[body.parentJoint]
    )


def _top_speed(
    robot: Robot, name: str, bodies: tuple[pin.GeometryObject, ...]
) -> float:
    """The most that any point of the bodies moves per unit of a joint, m."""
    joint = robot.model.getJointId(name)
    linear, angular = np.split(motion_axis(robot.model, joint), 2)
    if not angular.any():
        return float(np.linalg.norm(linear))
    T_world_joint = joint_placements(robot.model, robot.q_neutral[None])[0]
    levers = []
    for body in bodies:
        box = local_bounds(body.geometry)
        centre = T_world_joint[body.parentJoint] @ body.placement.homogeneous
        offset = (
            centre[:3, :3] @ box.centre + centre[:3, 3] - T_world_joint[joint][:3, 3]
        )
        levers.append(np.linalg.norm(offset) + np.linalg.norm(box.half))
    return float(max(levers, default=0.0))
