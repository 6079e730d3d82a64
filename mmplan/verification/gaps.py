"""Lower bounds on distances from boxes around bodies, for many pairs at once."""

from __future__ import annotations

import numpy as np

from mmplan.shapes import Array


def sphere_gaps(apart: Array, radii: Array) -> Array:
    """How far spheres are apart at least, (k,), negative where they overlap.

    `apart` (k, 3) goes from centre to centre, `radii` (k,) are the sums of two radii.
    """
    gaps: Array = np.sqrt(np.einsum("ki,ki->k", apart, apart)) - radii
    return gaps


def box_gaps(
    apart: Array, R_first: Array, first: Array, R_second: Array, second: Array
) -> Array:
    """How far oriented boxes are apart at least, (k,), 0 where they may overlap.

    `apart` (k, 3) goes from centre to centre, `R_...` (k, 3, 3) turn the boxes'
    own axes to the world's, `first` and `second` (k, 3) are half extents.
    """
    R = np.abs(R_first.transpose(0, 2, 1) @ R_second)
    in_first = np.abs(np.einsum("kji,kj->ki", R_first, apart)) - first
    in_first -= np.einsum("kij,kj->ki", R, second)
    in_second = np.abs(np.einsum("kji,kj->ki", R_second, apart)) - second
    in_second -= np.einsum("kji,kj->ki", R, first)
    return np.maximum(_norm_outside(in_first), _norm_outside(in_second))


def _norm_outside(gaps: Array) -> Array:
    outside = np.maximum(gaps, 0.0)
    norm: Array = np.sqrt(np.einsum("ki,ki->k", outside, outside))
    return norm
