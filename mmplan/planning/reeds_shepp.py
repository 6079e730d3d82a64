"""The shortest way of a car that goes ahead and back, turning no tighter than it can.

J. A. Reeds, L. A. Shepp, "Optimal paths for a car that goes both forwards and
backwards", Pacific Journal of Mathematics 145(2), 1990. The numbers of formulas are
those of section 8. In here lengths are in turning radii and a word is a sequence of
letters L (left), S (straight), R (right) with a signed length each.

Every word that a formula proposes is driven to its end and counts only if that is
where the car shall be, so that no case is trusted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import acos, asin, atan2, cos, hypot, pi, sin, sqrt
from typing import TypeAlias

from mmplan.planning.rolling import RollingPiece, wrapped
from mmplan.shapes import Array

Word: TypeAlias = tuple[tuple[str, float], ...]

_CURVATURE = {"L": 1.0, "S": 0.0, "R": -1.0}
_MIRRORED = {"L": "R", "S": "S", "R": "L"}
# A word ends where it shall if it is off by no more than this (radii, rad).
_EXACT = 1e-8


@dataclass(frozen=True)
class ReedsShepp:
    """A car with a smallest turning radius, m."""

    radius: float

    def pieces(self, start: Array, end: Array) -> tuple[RollingPiece, ...]:
        """The shortest of the paper's words, at most five pieces."""
        word = shortest_word(*_seen_from(start, end, self.radius))
        pieces = (
            RollingPiece(length * self.radius, _CURVATURE[letter] * length)
            for letter, length in word
        )
        return tuple(piece for piece in pieces if piece.moves)


def shortest_word(x: float, y: float, phi: float) -> Word:
    """The shortest word from the origin to (x, y) and heading phi."""
    words = sorted(_all_words(x, y, phi), key=_length)
    return next(word for word in words if _misses(word, x, y, phi) <= _EXACT)


def _length(word: Word) -> float:
    return sum(abs(length) for _, length in word)


def _seen_from(start: Array, end: Array, radius: float) -> tuple[float, float, float]:
    dx, dy = ((end - start)[:2] / radius).tolist()
    c, s = cos(start[2]), sin(start[2])
    return c * dx + s * dy, c * dy - s * dx, wrapped(float(end[2] - start[2]))


def _misses(word: Word, x: float, y: float, phi: float) -> float:
    """How far from the wanted place a word ends."""
    u = v = heading = 0.0
    for letter, length in word:
        curvature = _CURVATURE[letter]
        if curvature:
            turned = heading + curvature * length
            u += curvature * (sin(turned) - sin(heading))
            v -= curvature * (cos(turned) - cos(heading))
            heading = turned
        else:
            u, v = u + length * cos(heading), v + length * sin(heading)
    return max(hypot(u - x, v - y), abs(wrapped(heading - phi)))


def _all_words(x: float, y: float, phi: float) -> Iterator[Word]:
    """Words of all families, and the same mirrored in time, in space and in both."""
    for back in (False, True):
        for mirror in (False, True):
            # Driven in the opposite order a word leads from the end to the start.
            for order in (1, -1):
                u, v, angle = -x if back else x, -y if mirror else y, phi
                if back != mirror:
                    angle = -phi
                if order < 0:
                    u, v = (
                        u * cos(angle) + v * sin(angle),
                        u * sin(angle) - v * cos(angle),
                    )
                for word in _words(u, v, angle):
                    yield tuple(
                        (_MIRRORED[a] if mirror else a, -n if back else n)
                        for a, n in word[::order]
                    )


def _words(x: float, y: float, phi: float) -> Iterator[Word]:
    yield from _with_equal_turns(x - sin(phi), y - 1.0 + cos(phi), phi)
    yield from _with_opposite_turns(x + sin(phi), y - 1.0 - cos(phi), phi)


def _with_equal_turns(xi: float, eta: float, phi: float) -> Iterator[Word]:
    """Words that begin and end with a turn to the same side (8.1, 8.3, 8.4, 8.9)."""
    rho, theta = hypot(xi, eta), atan2(eta, xi)
    yield ("L", wrapped(theta)), ("S", rho), ("L", wrapped(phi - theta))
    if rho <= 4.0:
        u = -2.0 * asin(rho / 4.0)
        t = wrapped(theta + u / 2.0 + pi)
        yield ("L", t), ("R", u), ("L", wrapped(phi - t + u))
    if rho >= 2.0:
        r = sqrt(rho**2 - 4.0)
        t = wrapped(theta + atan2(r, -2.0))
        v = wrapped(phi - pi / 2.0 - t)
        yield ("L", t), ("R", -pi / 2.0), ("S", 2.0 - r), ("L", v)


def _with_opposite_turns(xi: float, eta: float, phi: float) -> Iterator[Word]:
    """Words that begin and end with turns to either side (8.2, 8.7, 8.8, 8.10/11)."""
    rho, theta = hypot(xi, eta), atan2(eta, xi)
    if rho >= 2.0:
        u = sqrt(rho**2 - 4.0)
        t = wrapped(theta + atan2(2.0, u))
        yield ("L", t), ("S", u), ("R", wrapped(t - phi))
        angle = atan2(xi, -eta)
        v = wrapped(angle + pi / 2.0 - phi)
        yield ("L", angle), ("R", -pi / 2.0), ("S", 2.0 - rho), ("R", v)
        u = 4.0 - sqrt(rho**2 - 4.0)
        t = wrapped(atan2((4.0 - u) * xi - 2.0 * eta, -2.0 * xi + (u - 4.0) * eta))
        quarter = -pi / 2.0
        yield (
            ("L", t),
            ("R", quarter),
            ("S", u),
            ("L", quarter),
            ("R", wrapped(t - phi)),
        )
    if rho <= 2.0:
        u = acos((2.0 + rho) / 4.0)
        yield from _four_turns(u, -u, xi, eta, phi)
    if 4.0 <= rho**2 <= 20.0:
        u = -acos((20.0 - rho**2) / 16.0)
        yield from _four_turns(u, u, xi, eta, phi)


def _four_turns(
    u: float, v: float, xi: float, eta: float, phi: float
) -> Iterator[Word]:
    """L t, R u, L v, R: the outer turns for given inner ones (8.6)."""
    delta = wrapped(u - v)
    a, b = sin(u) - sin(delta), cos(u) - cos(delta) - 1.0
    t = atan2(eta * a - xi * b, xi * a + eta * b)
    for tau in (t, t + pi):
        w = wrapped(tau - u + v - phi)
        yield ("L", wrapped(tau)), ("R", u), ("L", v), ("R", w)
