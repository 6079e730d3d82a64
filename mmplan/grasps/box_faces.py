"""Grasps of a box by two of its opposite faces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
import numpy.typing as npt

from mmplan.genes import GeneSpace
from mmplan.grasps.family import poses_from
from mmplan.shapes import Array

FACES = ("+x", "-x", "+y", "-y", "+z", "-z")


@dataclass(frozen=True)
class BoxFaces:
    """The hand comes to a face of the box and closes on two faces beside it.

    Four genes: which way (a face to come to, and a direction to close along in which
    the box is at most `widest`); how far the target point lies beside the middle of
    that face along its remaining axis, as a share of the room from -1 to 1; how deep
    it lies below the face, as a share of `depth`; and how far the hand is inclined
    about the closing direction, in rad, at most `tilt`. Lengths are in m. `margin` is
    kept from the edges sideways, and the depth ends in the middle of the box.
    """

    size: tuple[float, float, float]
    widest: float
    depth: tuple[float, float] = (0.01, 0.05)
    tilt: float = np.pi / 6
    margin: float = 0.01
    faces: tuple[str, ...] = FACES

    @cached_property
    def ways(self) -> npt.NDArray[np.int64]:
        """The ways (w, 5): axis and sign of the approach and of closing, third axis."""
        found = []
        for name, closing, turn in product(self.faces, range(3), (1, -1)):
            axis, sign = "xyz".index(name[1]), -1 if name[0] == "+" else 1
            if closing != axis and self.size[closing] <= self.widest:
                found.append((axis, sign, closing, turn, 3 - axis - closing))
        return np.array(found, dtype=np.int64).reshape(-1, 5)

    @property
    def genes(self) -> GeneSpace:
        """Way, slide, depth and inclination."""
        return GeneSpace(
            np.array([0.0, -1.0, 0.0, -self.tilt]),
            np.array([float(len(self.ways)), 1.0, 1.0, self.tilt]),
            np.zeros(4, np.bool_),
        )

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        _, slide, depth, tilt = genes.T
        axis, sign, closing, turn, sliding = self.ways[self.way_of(genes)].T
        units = np.eye(3)
        inward, across = sign[:, None] * units[axis], turn[:, None] * units[closing]
        beside = np.cross(across, inward)
        approach = np.cos(tilt)[:, None] * inward + np.sin(tilt)[:, None] * beside
        half = np.array(self.size) / 2.0
        below = self._depth(half[axis], depth)
        room = np.maximum(half[sliding] - self.margin, 0.0)
        position = (below - half[axis])[:, None] * inward
        position += (slide * room)[:, None] * units[sliding]
        return poses_from(approach, across, position)

    def way_of(self, genes: Array) -> npt.NDArray[np.int64]:
        """Which row of `ways` each genome (n, 4) takes, (n,)."""
        return np.minimum(genes[:, 0].astype(np.int64), len(self.ways) - 1)

    def quality(self, genes: Array) -> Array:
        """1 for all: fingers on opposite faces always close."""
        return np.ones(len(genes))

    def _depth(self, half: Array, share: Array) -> Array:
        """How deep (n,) the target lies, at most in the middle of the box."""
        low, high = (np.minimum(limit, half) for limit in self.depth)
        below: Array = low + share * (high - low)
        return below
