"""Cubic Hermite curves: what a segment's samples mean between the samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Extremes:
    """Least and greatest values over each of k stretches, every (k, joints)."""

    least: Array
    greatest: Array

    @property
    def magnitude(self) -> Array:
        """The greatest absolute values, (k, joints)."""
        return np.maximum(-self.least, self.greatest)


class HermiteCurve:
    """The curve through positions and velocities at given times.

    On piece i, from times[i] to times[i + 1], with s the time since times[i],
    q(s) = c0 + c1 s + c2 s² + c3 s³.
    """

    def __init__(self, times: Array, positions: Array, velocities: Array) -> None:
        """Compute the coefficients; times (n,), positions and velocities (n, joints).

        Times must be finite and strictly increasing.
        """
        step = np.diff(times)[:, None]  # (pieces, 1)
        slope = np.diff(positions, axis=0) / step
        v0, v1 = velocities[:-1], velocities[1:]
        self.times = times
        self._c = np.stack(
            [
                positions[:-1],
                v0,
                (3.0 * slope - 2.0 * v0 - v1) / step,
                (v0 + v1 - 2.0 * slope) / step**2,
            ]
        )  # (4, pieces, joints)

    @property
    def pieces(self) -> int:
        """The number of cubic pieces."""
        return len(self.times) - 1

    def piece_of(self, t: Array) -> npt.NDArray[np.int64]:
        """The piece that each time (k,) lies on, the later one at a sample."""
        piece = np.searchsorted(self.times, t, side="right") - 1
        return np.clip(piece, 0, self.pieces - 1)

    def positions(self, t: Array) -> Array:
        """Joint positions (k, joints) at times (k,)."""
        c, s = self._at(t)
        positions: Array = c[0] + s * (c[1] + s * (c[2] + s * c[3]))
        return positions

    def velocities(self, t: Array) -> Array:
        """Joint velocities (k, joints) at times (k,)."""
        c, s = self._at(t)
        velocities: Array = c[1] + s * (2.0 * c[2] + 3.0 * s * c[3])
        return velocities

    def accelerations(self, t: Array) -> Array:
        """Joint accelerations (k, joints) at times (k,); at a sample the later ones."""
        c, s = self._at(t)
        accelerations: Array = 2.0 * c[2] + 6.0 * s * c[3]
        return accelerations

    def position_extremes(self) -> Extremes:
        """Exact extremes of the positions on every piece, (pieces, joints)."""
        _, c1, c2, c3 = self._c
        step = np.diff(self.times)
        ends = [self._value(step * 0.0), self._value(step)]
        # Roots of the velocity c1 + 2 c2 s + 3 c3 s² in the form that does not cancel.
        root = np.sqrt(np.maximum(c2**2 - 3.0 * c1 * c3, 0.0))
        m = -(c2 + np.copysign(root, c2))
        with np.errstate(divide="ignore", invalid="ignore"):
            turns = [m / (3.0 * c3), c1 / m]
        inner = [
            self._value(np.clip(np.nan_to_num(s), 0.0, step[:, None])) for s in turns
        ]
        return _extremes([*ends, *inner])

    def velocity_extremes(self, start: Array, end: Array) -> Extremes:
        """Extremes of the velocities over stretches [start, end] (k,) of time.

        Exact for a stretch within one piece; a longer one is bounded by all of the
        pieces that it touches.
        """
        first = self.piece_of(start)
        last = np.maximum(first, np.searchsorted(self.times, end, side="left") - 1)
        last = np.minimum(last, self.pieces - 1)
        inner = self._piece_velocities(
            first, start - self.times[first], end - self.times[first]
        )
        long = last > first
        if not np.any(long):
            return inner
        every = np.arange(self.pieces)
        whole = self._piece_velocities(
            every, np.zeros(self.pieces), np.diff(self.times)
        )
        ranges = np.stack([first[long], last[long]], axis=1).ravel()
        for values, over_pieces, reduce in (
            (inner.least, whole.least, np.minimum),
            (inner.greatest, whole.greatest, np.maximum),
        ):
            # A range [first, last) and then the last piece itself.
            part = reduce.reduceat(over_pieces, ranges, axis=0)[::2]
            values[long] = reduce(part, over_pieces[last[long]])
        return inner

    def acceleration_extremes(self) -> Extremes:
        """Exact extremes of the accelerations on every piece, (pieces, joints)."""
        _, _, c2, c3 = self._c
        start = 2.0 * c2
        return _extremes([start, start + 6.0 * c3 * np.diff(self.times)[:, None]])

    def jerks(self) -> Array:
        """The third derivatives, constant on every piece, (pieces, joints)."""
        jerks: Array = 6.0 * self._c[3]
        return jerks

    def _at(self, t: Array) -> tuple[Array, Array]:
        piece = self.piece_of(t)
        return self._c[:, piece], (t - self.times[piece])[:, None]

    def _value(self, s: Array) -> Array:
        """Positions (pieces, joints) at one time (pieces, 1 or joints) a piece."""
        s = s if s.ndim == 2 else s[:, None]
        c0, c1, c2, c3 = self._c
        value: Array = c0 + s * (c1 + s * (c2 + s * c3))
        return value

    def _piece_velocities(
        self, piece: npt.NDArray[np.int64], start: Array, end: Array
    ) -> Extremes:
        """Exact extremes over parts [start, end] (k,) of pieces (k,)."""
        _, c1, c2, c3 = self._c[:, piece]
        start, end = start[:, None], end[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.nan_to_num(-c2 / (3.0 * c3))
        turn = np.clip(turn, start, end)
        return _extremes(
            [c1 + s * (2.0 * c2 + 3.0 * s * c3) for s in (start, end, turn)]
        )


def _extremes(values: list[Array]) -> Extremes:
    return Extremes(np.min(values, axis=0), np.max(values, axis=0))
