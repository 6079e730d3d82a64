"""Poses as seven numbers: position and quaternion (x, y, z, w)."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mmplan.shapes import Array


def pose_numbers(T: Array) -> Array:
    """Poses (n, 4, 4) as (n, 7), each quaternion on the side of the one before it."""
    numbers = np.array([pin.SE3ToXYZQUAT(pin.SE3(pose)) for pose in T]).reshape(-1, 7)
    along = np.einsum("ij,ij->i", numbers[1:, 3:], numbers[:-1, 3:])
    flips = np.cumprod(np.where(along < 0.0, -1.0, 1.0))
    numbers[1:, 3:] *= flips[:, None]
    return numbers
