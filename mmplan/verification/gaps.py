"""Lower bounds on signed distances, from what encloses bodies, for many pairs at once.

Signed distances are negative where bodies overlap: minus the depth. What encloses two
bodies is no farther apart, and overlaps no less, than they do.
"""

from __future__ import annotations

import numpy as np

from mmplan.shapes import Array


def sphere_gaps(apart: Array, radii: Array) -> Array:
    """Signed distances (k,) of spheres.

    `apart` (k, 3) goes from centre to centre, `radii` (k,) are the sums of two radii.
    """
    gaps: Array = np.sqrt(np.einsum("ki,ki->k", apart, apart)) - radii
    return gaps


def box_gaps(
    apart: Array, R_first: Array, first: Array, R_second: Array, second: Array
) -> Array:
    """Lower bounds (k,) on signed distances of oriented boxes.

    Only the axes of the boxes themselves are looked at. `apart` (k, 3) goes from centre
    to centre, `R_...` (k, 3, 3) turn the boxes' own axes to the world's, `first` and
    `second` (k, 3) are half extents.
    """
    R = np.abs(R_first.transpose(0, 2, 1) @ R_second)
    in_first = np.abs(np.einsum("kji,kj->ki", R_first, apart)) - first
    in_first -= np.einsum("kij,kj->ki", R, second)
    in_second = np.abs(np.einsum("kji,kj->ki", R_second, apart)) - second
    in_second -= np.einsum("kji,kj->ki", R, first)
    return np.maximum(_signed(in_first), _signed(in_second))


def _signed(gaps: Array) -> Array:
    """Signed distances (k,) of parallel boxes, from gaps (k, 3) along their axes."""
    outside = np.maximum(gaps, 0.0)
    apart = np.sqrt(np.einsum("ki,ki->k", outside, outside))
    nearest = gaps.max(axis=1)
    signed: Array = np.where(nearest > 0.0, apart, nearest)
    return signed
