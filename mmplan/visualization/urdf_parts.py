"""The parts of a URDF: its visual bodies, else its collision bodies."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache

import numpy as np
import pinocchio as pin

from mmplan.collision.mesh_files import TriangleMesh
from mmplan.collision.surfaces import appearance
from mmplan.shapes import Shape
from mmplan.visualization.part import Colour, Part
from mmplan.visualization.smoothing import coarsened, with_edges
from mmplan.visualization.surface import Surface, surface_of

# A mesh of a link with more triangles than this is drawn with fewer.
_MOST_TRIANGLES = 6_000
# What a body is drawn in whose URDF says no colour; Pinocchio says this for those.
_PALE = Colour(0.78, 0.79, 0.8)


def urdf_parts(
    model: pin.Model,
    visual: pin.GeometryModel,
    collision: pin.GeometryModel,
    prefix: str,
    carrier: Callable[[int], tuple[str, pin.SE3]],
) -> Iterator[Part]:
    """The parts of every link: visual bodies where it has any, else collision bodies.

    `carrier` says for a joint what carries its bodies, and where the joint is in the
    carrier's frame.
    """
    seen = {body.parentFrame for body in visual.geometryObjects}
    bodies = [
        *visual.geometryObjects,
        *(b for b in collision.geometryObjects if b.parentFrame not in seen),
    ]
    for number, body in enumerate(bodies):
        name, T_carrier_joint = carrier(int(body.parentJoint))
        T = (T_carrier_joint * body.placement).homogeneous
        link = model.frames[body.parentFrame].name
        surface = body_surface(body).moved(T)
        yield Part(f"{prefix}/{link}#{number}", surface, _colour(body), name)


def body_surface(body: pin.GeometryObject) -> Surface:
    """The surface of a body in its own frame, fit to be drawn."""
    found = appearance(body.geometry)
    if not isinstance(found, TriangleMesh):
        return _primitive(found)
    return with_edges(coarsened(Surface(*found), _MOST_TRIANGLES))


@lru_cache(maxsize=256)
def _primitive(shape: Shape) -> Surface:
    """The surface of a shape of which a fixture may have many, as a rack has tines."""
    return with_edges(surface_of(shape))


def _colour(body: pin.GeometryObject) -> Colour:
    red, green, blue, opacity = np.clip(body.meshColor, 0.0, 1.0).tolist()
    if not body.overrideMaterial and (red, green, blue) in _UNSAID:
        return _PALE
    return Colour(red, green, blue, opacity or 1.0)


_UNSAID = {(0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.9, 0.9, 0.9)}
