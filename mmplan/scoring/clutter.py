"""Configuration clutter: the weighted distances C of the links to the obstacles."""

from __future__ import annotations

from functools import partial
from itertools import product

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision import CollisionWorld, LinkDistances, local_bounds
from mmplan.kinematics import ForwardKinematics
from mmplan.robot import Robot
from mmplan.scoring.outcome import End
from mmplan.scoring.term import Grasped, RowCache
from mmplan.shapes import Array


class Clutter:
    """C = Σ w_l d_l over the robot's links (paper, eq. 2).

    d_l is the distance from link l to the nearest obstacle. w_l is the inverse of the
    distance between the middle of the link's collision bodies and the centre of mass
    of the base in the same configuration, at most the inverse of the base's radius.
    The object in the hand is no obstacle and, its distance being the same for all
    candidates, no link; the ground is no obstacle for the base's own links. A link
    without any obstacle adds nothing, as it is clear of all in every candidate.
    """

    def __init__(self, robot: Robot, worlds: dict[End, CollisionWorld]) -> None:
        """Prepare for the obstacles of the world at each end, without the object."""
        self._distances = {end: LinkDistances(world) for end, world in worlds.items()}
        self.weights = LinkWeights(robot)
        self.links = self._distances[End.START].links
        self._groups = _link_groups(robot, self.links)
        self._caches = {(end, g): RowCache() for end in worlds for g in self._groups}

    def __call__(self, grasped: Grasped) -> Array:
        """C of each configuration in m/m, (n,)."""
        C: Array = self.by_link(grasped).sum(axis=1)
        return C

    def by_link(self, grasped: Grasped) -> Array:
        """The summands w_l d_l, (n, links), in the order of `links`."""
        d = self.distances(grasped)
        return self.weights(grasped.q) * np.where(np.isinf(d), 0.0, d)

    def distances(self, grasped: Grasped) -> Array:
        """The distances d_l in m, (n, links), in the order of `links`.

        Those of the base's links depend on the base placement alone and those of the
        links that do not move against the tool on the grasp alone. Infinite where a
        link has no obstacle.
        """
        end, q = grasped.end, grasped.q
        d = np.empty((len(q), len(self.links)))
        d[:, self._groups["arm"]] = self._distances[end](q, self._groups["arm"])
        for group, ids in (("base", grasped.base), ("tool", grasped.grasp)):
            links = self._groups[group]
            compute = partial(self._of_rows, end, q, links)
            d[:, links] = self._caches[end, group].rows(ids.tolist(), compute)
        return d

    def _of_rows(
        self,
        end: End,
        q: Array,
        links: npt.NDArray[np.int64],
        rows: npt.NDArray[np.int64],
    ) -> Array:
        return self._distances[end](q[rows], links)


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
        T = self._kinematics(q)
        joints = T[:, self._joints]
        middles = np.einsum("nlij,lj->nli", joints[..., :3, :3], self._middles)
        middles += joints[..., :3, 3]
        base = T[:, self._base_joint]
        lever = self._robot.model.inertias[self._base_joint].lever
        centre = base[:, :3, :3] @ lever + base[:, :3, 3]
        distance = np.linalg.norm(middles - centre[:, None], axis=2)
        weights: Array = 1.0 / np.maximum(distance, self._robot.base_radius)
        return weights


def _link_groups(
    robot: Robot, links: tuple[str, ...]
) -> dict[str, npt.NDArray[np.int64]]:
    """Which links move with the base alone, with the tool, and in between."""
    groups: dict[str, set[int]] = {"base": set(), "arm": set(), "tool": set()}
    for body in robot.geometry.geometryObjects:
        kind = robot.kind_of(body)
        with_tool = kind == "finger" or body.parentJoint == robot.tool_joint
        group = "tool" if with_tool else kind
        groups[group].add(links.index(robot.link_of(body)))
    return {name: np.array(sorted(g), dtype=np.int64) for name, g in groups.items()}


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
