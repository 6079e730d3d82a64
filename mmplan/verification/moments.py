"""The bodies of a world at many moments: how far apart, roughly and exactly."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mmplan.collision.separation import transform
from mmplan.shapes import Array
from mmplan.verification.bodies import Bodies, Indices
from mmplan.verification.gaps import box_gaps, sphere_gaps


class Moments:
    """Bodies at n configurations; all questions are about bodies at one moment each."""

    def __init__(self, bodies: Bodies, q: Array) -> None:
        """Place the bodies for configurations (n, nq)."""
        self._bodies = bodies
        self.T_world_joint = bodies.joint_poses(q)  # (n, joints, 4, 4)
        self._centres = bodies.centres_at(self.T_world_joint)  # (n, bodies, 3)

    def sphere_gaps(self, moment: Indices, first: Indices, second: Indices) -> Array:
        """Lower bounds (k,) of signed distances, quick and wide."""
        radii = self._bodies.radii
        apart = self._centres[moment, second] - self._centres[moment, first]
        return sphere_gaps(apart, radii[first] + radii[second])

    def box_gaps(self, moment: Indices, first: Indices, second: Indices) -> Array:
        """Lower bounds (k,) of signed distances, mostly sharper."""
        bodies, T = self._bodies, self.T_world_joint
        return box_gaps(
            self._centres[moment, second] - self._centres[moment, first],
            bodies.rotations_at(T, moment, first),
            bodies.halves[first],
            bodies.rotations_at(T, moment, second),
            bodies.halves[second],
        )

    def distances(
        self, moment: Indices, first: Indices, second: Indices
    ) -> Iterator[float]:
        """Signed distances of k pairs, each computed when it is asked for."""
        bodies = self._bodies
        body = np.concatenate([first, second])
        place = np.tile(moment, 2) * len(bodies) + body
        place, poses_of = np.unique(place, return_inverse=True)
        moment, body = np.divmod(place, len(bodies))
        T = self.T_world_joint[moment, bodies.joints[body]] @ bodies.placements[body]
        poses = [None] * len(T)
        pairs = np.stack([first, second, *poses_of.reshape(2, -1)], axis=1)
        for i, j, at_i, at_j in pairs.tolist():
            for at in (at_i, at_j):
                poses[at] = poses[at] or transform(T[at])
            yield bodies.separation.distance(i, poses[at_i], j, poses[at_j])
