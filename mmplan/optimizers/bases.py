"""Base placements as genes: polar coordinates about the object, plus offsets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from mmplan.exceptions import NoPlanError
from mmplan.genes import GeneSpace
from mmplan.shapes import Array

# The genes for offsets in x and y stay within this (paper, section IV.B), m.
OFFSET = 0.2
# What counts as much as one unit of each base joint: x (m), y (m), heading (rad).
BASE_SCALES = np.array([1.0, 1.0, 2.0])
_MAX_DRAWS = 1000

# Which of q_base (n, base joints) are within bounds and free of collision, (n,).
IsFree: TypeAlias = Callable[[Array], npt.NDArray[np.bool_]]


class Placements(Protocol):
    """Where the base may stand at one end of the task, as genes."""

    @property
    def joints(self) -> int:
        """The number of base joints, b."""
        ...

    @property
    def genes(self) -> GeneSpace:
        """The bounds of the genes."""
        ...

    @property
    def is_free(self) -> IsFree:
        """Which base joints (n, b) are within bounds and free of collision, (n,)."""
        ...

    def q_base(self, genes: Array) -> Array:
        """The base joints (n, b) that genes (n, d) stand for."""
        ...

    def nearest(self, q_base: Array) -> Array:
        """Base joints (n, b) that genes can stand for, near those given."""
        ...

    def sample(self, n: int, rng: np.random.Generator) -> Array:
        """Genes (n, d) drawn for a first population, all of them free.

        Raises:
            NoPlanError: There is no room for the base.
        """
        ...


@dataclass(frozen=True)
class BasePlacements:
    """The base placements about an object at one end of the task.

    Four genes: distance (m) from the object's centre of mass, between the base's
    radius and the reach of the stretched arm; direction (rad); offsets in x and y (m)
    of at most 0.2 either way, by which later generations improve (paper, IV.B). A base
    that turns has a fifth: its heading (rad) relative to the direction in which it
    sees the object's centre of mass.

    Joint values of the heading are in [-π, π), or near the middle of its limits where
    it has any; a heading beyond its limits is not free.
    """

    centre: tuple[float, float]  # the object's centre of mass, x and y in the world
    inner: float  # the base's radius, m
    outer: float  # the reach, m
    is_free: IsFree
    heading: tuple[float, float] | None = None  # its limits, rad; None: does not turn

    @property
    def joints(self) -> int:
        """Two, or three where the base turns."""
        return 2 if self.heading is None else 3

    @property
    def genes(self) -> GeneSpace:
        """The bounds of the four or five genes."""
        d = self.joints + 2
        return GeneSpace(
            np.array([self.inner, -np.pi, -OFFSET, -OFFSET, -np.pi])[:d],
            np.array([self.outer, np.pi, OFFSET, OFFSET, np.pi])[:d],
            np.array([False, True, False, False, True])[:d],
        )

    def q_base(self, genes: Array) -> Array:
        """The base joints (n, b) that genes (n, b + 2) stand for."""
        xy = self._xy(genes[:, :4])
        if self.heading is None:
            return xy
        to_object = np.array(self.centre) - xy
        heading = np.arctan2(to_object[:, 1], to_object[:, 0]) + genes[:, 4]
        return np.column_stack([xy, self._winding(heading)])

    def nearest(self, q_base: Array) -> Array:
        """Base joints (n, b) that genes can stand for, near those given.

        The polar coordinates go as far as their bounds allow, the offsets do the rest.
        """
        xy = q_base[:, :2]
        away = xy - np.array(self.centre)
        distance = np.linalg.norm(away, axis=1)
        polar = np.zeros((len(q_base), 4))
        polar[:, 0] = np.clip(distance, self.inner, self.outer)
        polar[:, 1] = np.arctan2(away[:, 1], away[:, 0])
        offset = xy - self._xy(polar)
        polar[:, 2:] = np.clip(offset, -OFFSET, OFFSET)
        nearest = self._xy(polar)
        if self.heading is None:
            return nearest
        heading = np.clip(self._winding(q_base[:, 2]), *self.heading)
        return np.column_stack([nearest, heading])

    def sample(self, n: int, rng: np.random.Generator) -> Array:
        """Genes (n, d): place uniform over the annulus without offsets, any heading.

        Raises:
            NoPlanError: The base is in collision nearly everywhere in the annulus.
        """
        d = len(self.genes)
        found = np.empty((0, d))
        for _ in range(_MAX_DRAWS):
            drawn = np.zeros((2 * n, d))
            area = rng.uniform(self.inner**2, self.outer**2, 2 * n)
            drawn[:, 0] = np.sqrt(area)
            drawn[:, 1] = rng.uniform(-np.pi, np.pi, 2 * n)
            if self.heading is not None:
                drawn[:, 4] = rng.uniform(-np.pi, np.pi, 2 * n)
            found = np.concatenate([found, drawn[self.is_free(self.q_base(drawn))]])
            if len(found) >= n:
                return found[:n]
        x, y = self.centre
        raise NoPlanError(
            f"there is no room for the base within reach of ({x:.3f}, {y:.3f}): "
            f"{2 * n * _MAX_DRAWS} placements {self.inner:.2f} m to {self.outer:.2f} m "
            "away were in collision or out of bounds"
        )

    def _xy(self, polar: Array) -> Array:
        """The positions (n, 2) of polar coordinates and offsets (n, 4)."""
        distance, angle, dx, dy = polar.T
        x = self.centre[0] + distance * np.cos(angle) + dx
        y = self.centre[1] + distance * np.sin(angle) + dy
        return np.stack([x, y], axis=1)

    def _winding(self, heading: Array) -> Array:
        """Headings (n,) less whole turns: near the middle of the limits, or of 0."""
        assert self.heading is not None
        middle = sum(self.heading) / 2.0
        middle = middle if np.isfinite(middle) else 0.0
        wrapped: Array = middle + np.mod(heading - middle + np.pi, 2 * np.pi) - np.pi
        return wrapped


@dataclass(frozen=True, eq=False)
class OnePlacement:
    """The only placement of a base that stands still: no genes."""

    place: Array  # (base joints,)
    is_free: IsFree

    @property
    def joints(self) -> int:
        """The number of base joints."""
        return len(self.place)

    @property
    def genes(self) -> GeneSpace:
        """No genes."""
        return GeneSpace(np.empty(0), np.empty(0), np.empty(0, np.bool_))

    def q_base(self, genes: Array) -> Array:
        """The placement (n, b), once for each of n empty genomes."""
        return np.tile(self.place, (len(genes), 1))

    def nearest(self, q_base: Array) -> Array:
        """The placement (n, b), wherever (n, b) one would like the base to be."""
        return self.q_base(q_base)

    def sample(self, n: int, rng: np.random.Generator) -> Array:  # noqa: ARG002
        """N genomes without genes, (n, 0).

        Raises:
            NoPlanError: The base cannot stand there.
        """
        genomes = np.empty((n, 0))
        if not self.is_free(self.q_base(genomes[:1])).all():
            raise NoPlanError("the base cannot stand where it is fixed: in collision")
        return genomes


def base_ways(q_from: Array, q_to: Array) -> Array:
    """The ways (..., b) between base placements, the short way round for a heading."""
    ways = q_to - q_from
    if ways.shape[-1] > 2:
        ways[..., 2] = np.mod(ways[..., 2] + np.pi, 2 * np.pi) - np.pi
    return ways
