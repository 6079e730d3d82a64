"""Grasp quality G."""

from __future__ import annotations

import numpy as np

from mmplan.grasps import GraspFamily
from mmplan.shapes import Array


def grasp_quality(family: GraspFamily, genes: Array) -> Array:
    """G in [0, 1] of grasps (n, genes), (n,), as the grasp family rates them.

    Raises:
        ValueError: The family returned a quality outside of [0, 1].
    """
    quality = family.quality(genes)
    if not np.all((quality >= 0.0) & (quality <= 1.0)):
        raise ValueError(f"{type(family).__name__}: grasp quality outside of [0, 1]")
    return quality
