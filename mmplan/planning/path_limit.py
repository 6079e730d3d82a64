"""Limits of motions along a path beyond those of single joints."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from mmplan.hermite import HermiteCurve
from mmplan.shapes import Array


class Rows(NamedTuple):
    """Limits of the motion at n places of a curve q(s): |a s̈ + b ṡ² + c| ≤ 1."""

    a: Array  # (n, rows)
    b: Array
    c: Array


class PathLimit(Protocol):
    """A limit that depends on where the robot is, or on several joints at once."""

    def rows(self, q: Array, dq: Array, ddq: Array, /) -> Rows:
        """The limit at places (n, nq) of a curve, with its derivatives by s there."""
        ...

    def stretch(self, curve: HermiteCurve) -> float:
        """The factor by which the time of a motion must be stretched to keep it.

        Below 1 where it could be shortened; infinite where nothing helps.
        """
        ...
