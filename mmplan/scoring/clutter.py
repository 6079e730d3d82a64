"""Configuration clutter: the weighted distances C of the links to the obstacles."""

from __future__ import annotations

import numpy as np

from mmplan.collision import CollisionWorld
from mmplan.robot import Robot
from mmplan.scoring.link_weights import LinkWeights
from mmplan.scoring.obstacle_distances import ObstacleDistances
from mmplan.scoring.outcome import End
from mmplan.scoring.term import Grasped
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
        self._distances = {e: ObstacleDistances(robot, w) for e, w in worlds.items()}
        self.weights = LinkWeights(robot)
        self.links = self._distances[End.START].links

    def __call__(self, grasped: Grasped) -> Array:
        """C of each configuration in m/m, (n,)."""
        # Summed in the order of the links, whatever the layout in memory.
        C: Array = np.cumsum(self.by_link(grasped), axis=1)[:, -1]
        return C

    def by_link(self, grasped: Grasped) -> Array:
        """The summands w_l d_l, (n, links), in the order of `links`."""
        d = self.distances(grasped)
        return self.weights(grasped.q) * np.where(np.isinf(d), 0.0, d)

    def distances(self, grasped: Grasped) -> Array:
        """The distances d_l in m, (n, links), in the order of `links`.

        Infinite where a link has no obstacle.
        """
        return self._distances[grasped.end](grasped)

    def bound(self, grasped: Grasped, T_world_joint: Array) -> Array:
        """What C is at most, (n,), given the poses (n, njoints, 4, 4) of all joints."""
        d = self._distances[grasped.end].bound(grasped, T_world_joint)
        d[np.isinf(d)] = 0.0
        bound: Array = np.einsum("nl,nl->n", self.weights.at(T_world_joint), d)
        return bound
