"""Many poses at once, components first."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array


class Poses(NamedTuple):
    """m poses, components first, so that a product with a constant is one call."""

    R: Array  # (3, 3, m): R[j] holds the j-th axes, the columns of the rotations
    p: Array  # (3, m), m

    def __matmul__(self, other: Poses) -> Poses:
        """The products of poses, pair by pair."""
        R = np.einsum("lim,jlm->jim", self.R, other.R)
        return Poses(R, np.einsum("lim,lm->im", self.R, other.p) + self.p)

    def take(self, index: npt.NDArray[np.intp]) -> Poses:
        """The poses of these numbers."""
        return Poses(self.R[:, :, index], self.p[:, index])

    def inverse(self) -> Poses:
        """The inverse of each pose."""
        p: Array = np.einsum("jim,im->jm", self.R, self.p)
        return Poses(self.R.swapaxes(0, 1), -p)


def components(T: Array) -> Poses:
    """Poses (n, 4, 4) with components first."""
    moved = np.ascontiguousarray(T[:, :3].transpose(2, 1, 0))
    return Poses(moved[:3], moved[3])


def each_with_each(first: Poses, second: Poses) -> Poses:
    """All products of s poses with n poses, (s n), those of the first one first."""
    s, n = first.p.shape[1], second.p.shape[1]
    rows = first.R.transpose(2, 1, 0).reshape(3 * s, 3)
    R = rows @ second.R.swapaxes(0, 1).reshape(3, 3 * n)
    p = (rows @ second.p).reshape(s, 3, n).swapaxes(0, 1) + first.p[:, :, None]
    return Poses(
        R.reshape(s, 3, 3, n).transpose(2, 1, 0, 3).reshape(3, 3, s * n),
        p.reshape(3, s * n),
    )
