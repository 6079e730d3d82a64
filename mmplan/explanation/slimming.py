"""Shapes that are slimmer than others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mmplan.shapes import Box, Mesh, Revolve, Shape, read_only


def slimmed(shape: Shape, factor: float) -> Shape:
    """The shape scaled in x and y alone, but for a sphere, which is scaled whole."""
    if isinstance(shape, Box):
        x, y, z = shape.size
        return Box((x * factor, y * factor, z))
    if isinstance(shape, Revolve):
        return Revolve(read_only(shape.profile * np.array([factor, 1.0])))
    if isinstance(shape, Mesh):
        x, y, z = shape.scale
        return Mesh(shape.path, (x * factor, y * factor, z))
    return replace(shape, radius=shape.radius * factor)
