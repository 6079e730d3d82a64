"""The weights of the links in the clutter term."""

from __future__ import annotations

from itertools import product

import numpy as np
import pinocchio as pin

from mmplan.collision import local_bounds
from mmplan.kinematics import ForwardKinematics, turned
from mmplan.robot import Robot
from mmplan.shapes import Array


class LinkWeights:
    """The weights w_l of the links that have collision bodies."""

    def __init__(self, robot: Robot) -> None:
        """Find the middle of each link and the base's centre of mass."""
        self._robot = robot
        self._kinematics = ForwardKinematics(robot.model)
        bodies: dict[str, list[Array]] = {}
        self._joints: list[int] = []
        for body in robot.geometry.geometryObjects:
            link = robot.link_of(body)
            if link not in bodies:
                self._joints.append(int(body.parentJoint))
            bodies.setdefault(link, []).append(_corners(body))
        self._middles = np.array([_middle(b) for b in bodies.values()])  # (links, 3)
        self._base_joint = robot.base_joint

    def __call__(self, q: Array) -> Array:
        """The weights w_l in 1/m at q (n, nq), (n, links)."""
        return self.at(self._kinematics(q))

    def at(self, T: Array) -> Array:
        """The weights, from the poses (n, njoints, 4, 4) of all joints."""
        joints, base = T[:, self._joints], T[:, self._base_joint]
        middles = turned(joints[..., :3, :3], self._middles) + joints[..., :3, 3]
        lever = self._robot.model.inertias[self._base_joint].lever
        centre = turned(base[:, :3, :3], lever) + base[:, :3, 3]
        distance = np.linalg.norm(middles - centre[:, None], axis=2)
        weights: Array = 1.0 / np.maximum(distance, self._robot.base_radius)
        return weights


def _corners(body: pin.GeometryObject) -> Array:
    """The corners (8, 3) of a collision body's box in its joint's frame."""
    box = local_bounds(body.geometry)
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    T = body.placement.homogeneous
    corners: Array = (box.centre + signs * box.half) @ T[:3, :3].T + T[:3, 3]
    return corners


def _middle(corners: list[Array]) -> Array:
    stacked = np.concatenate(corners)
    middle: Array = (stacked.min(axis=0) + stacked.max(axis=0)) / 2
    return middle
