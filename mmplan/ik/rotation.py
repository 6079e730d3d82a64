"""Turns of many vectors about one axis.

Vectors are arrays (3, ..., m), components first; axes are unit vectors (3,). Most axes
of most arms are coordinate axes, about which a turn is a quarter of the work.
"""

from __future__ import annotations

import numpy as np

from mmplan.shapes import Array


def dot(a: Array, b: Array) -> Array:
    """The scalar products of vectors (3, m) with vectors (3, m), (m,)."""
    product: Array = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


def along(axis: Array, vectors: Array) -> Array:
    """The scalar products of one vector (3,) with vectors, (..., m)."""
    terms = [float(x) * v for x, v in zip(axis, vectors, strict=True) if x != 0.0]
    return sum(terms[1:], start=terms[0]) if terms else np.zeros(vectors.shape[1:])


def cross(a: Array, b: Array) -> Array:
    """The cross products of vectors (3, m) with vectors (3, m), (3, m)."""
    return np.stack(
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    )


def rotate(axis: Array, angle: Array, vectors: Array) -> Array:
    """Vectors turned by angles (m,) about the axis (Rodrigues' formula)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    k = _coordinate(axis)
    if k is None:
        turned: Array = cosine * vectors
        turned += sine * _axis_cross(axis, vectors)
        rest = along(axis, vectors) * (1.0 - cosine)
        turned += np.multiply.outer(axis, rest)
        return turned
    i, j = (k + 1) % 3, (k + 2) % 3
    if axis[k] < 0:
        sine = -sine
    turned = np.empty((3, *np.broadcast_shapes(vectors.shape[1:], angle.shape)))
    turned[i] = cosine * vectors[i] - sine * vectors[j]
    turned[j] = sine * vectors[i] + cosine * vectors[j]
    turned[k] = vectors[k]
    return turned


def turn_terms(axis: Array, start: Array, end: Array) -> tuple[Array, Array]:
    """Of the parts of vectors (3, m) across the axis: cross and scalar products, (m,).

    Divided by the lengths they are sine and cosine of the turn from start to end.
    """
    k = _coordinate(axis)
    if k is None:
        sine = dot(end, _axis_cross(axis, start))
        return sine, dot(start, end) - along(axis, start) * along(axis, end)
    i, j = (k + 1) % 3, (k + 2) % 3
    sine = start[i] * end[j] - start[j] * end[i]
    return sine if axis[k] > 0 else -sine, start[i] * end[i] + start[j] * end[j]


def _coordinate(axis: Array) -> int | None:
    """The number of the coordinate axis that this is, either way, if it is one."""
    others = np.flatnonzero(axis)
    return int(others[0]) if len(others) == 1 else None


def _axis_cross(axis: Array, vectors: Array) -> Array:
    x, y, z = (float(component) for component in axis)
    a, b, c = vectors
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a])
