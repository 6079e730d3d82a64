"""Distances of the links to the nearest obstacle, each computed once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from mmplan.collision import CollisionWorld, LinkBounds, LinkDistances
from mmplan.kinematics import ForwardKinematics
from mmplan.robot import Robot
from mmplan.scoring.hand_poses import HandPoses
from mmplan.scoring.term import Grasped, RowCache, row_keys
from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]


class ObstacleDistances:
    """Distances to the obstacles of one world, the object in the hand left out.

    Those of the base's links depend on the base placement alone, those of the links
    that do not move against the tool on the grasp alone, and those of the arm's links
    in between on the joints that move them. Each is computed once.
    """

    def __init__(self, robot: Robot, world: CollisionWorld) -> None:
        """Prepare for a robot in a world."""
        self._exact = LinkDistances(world)
        self.links = self._exact.links
        self._base, self._arm, self._tool = _link_groups(robot, self.links)
        self._bounds = LinkBounds(world, tuple(self.links[k] for k in self._arm))
        self._joints = [_moved_by(robot, self.links[k]) for k in self._arm]
        self._known: list[dict[bytes, float]] = [{} for _ in self._arm]
        self._kinematics = ForwardKinematics(robot.model)
        self._hand_poses = HandPoses(robot)
        self._of_bases, self._of_grasps = RowCache(), RowCache()

    def __call__(self, grasped: Grasped) -> Array:
        """The distances in m, (n, links), infinite where a link has no obstacle."""
        d = self._steady(grasped)
        d[:, self._arm] = self._of_arm(grasped.q)
        return d

    def bound(self, grasped: Grasped, T_world_joint: Array) -> Array:
        """What they are at most, at the poses (n, njoints, 4, 4) of all joints."""
        d = self._steady(grasped)
        d[:, self._arm] = self._bounds(T_world_joint)
        return d

    def _steady(self, grasped: Grasped) -> Array:
        """The distances of the base's and the hand's links, the arm's left open."""
        d = np.empty((len(grasped.q), len(self.links)))
        d[:, self._base] = self._of_bases.rows(
            grasped.base.tolist(),
            lambda new: self._exact(grasped.q[new], self._base),
        )
        d[:, self._tool] = self._of_grasps.rows(
            grasped.grasp.tolist(),
            lambda new: self._of_tool(grasped.T_world_tool[new], grasped.q[new]),
        )
        return d

    def _of_tool(self, T_world_tool: Array, q: Array) -> Array:
        return self._exact.at(self._hand_poses(T_world_tool, q), self._tool)

    def _of_arm(self, q: Array) -> Array:
        """The distances of the arm's links, (n, arm links).

        Branches of inverse kinematics often differ in a few joints only.
        """
        keys = [row_keys(q[:, joints]) for joints in self._joints]
        needed = np.zeros((len(q), len(keys)), dtype=np.bool_)
        for link, known in enumerate(self._known):
            new = {k: row for row, k in enumerate(keys[link]) if k not in known}
            needed[list(new.values()), link] = True
        rows = np.flatnonzero(needed.any(axis=1))
        most = self._bounds(self._kinematics(q[rows]))
        found = self._exact(q[rows], self._arm, needed[rows], most)
        for row, link in np.argwhere(needed[rows]).tolist():
            self._known[link][keys[link][rows[row]]] = found[row, link]
        columns = zip(keys, self._known, strict=True)
        d = [[known[key] for key in names] for names, known in columns]
        return np.array(d).reshape(needed.shape[::-1]).T


def _link_groups(
    robot: Robot, links: tuple[str, ...]
) -> tuple[Indices, Indices, Indices]:
    """Which links move with the base alone, in between, and with the tool."""
    groups: dict[str, set[int]] = {"base": set(), "arm": set(), "tool": set()}
    for body in robot.geometry.geometryObjects:
        kind = robot.kind_of(body)
        with_tool = kind == "finger" or body.parentJoint == robot.tool_joint
        group = "tool" if with_tool else kind
        groups[group].add(links.index(robot.link_of(body)))
    base, arm, tool = (np.array(sorted(g), dtype=np.int64) for g in groups.values())
    return base, arm, tool


def _moved_by(robot: Robot, link: str) -> list[int]:
    """The places in q of the joints that move a link."""
    (joint,) = {
        int(body.parentJoint)
        for body in robot.geometry.geometryObjects
        if robot.link_of(body) == link
    }
    model = robot.model
    return [int(model.joints[j].idx_q) for j in model.supports[joint] if j != 0]
