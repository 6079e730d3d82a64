"""The grasp families that a shape suggests to a hand."""

from __future__ import annotations

from functools import singledispatch

import numpy as np

from mmplan.grasps.axis import Axis
from mmplan.grasps.box_faces import BoxFaces
from mmplan.grasps.cylinder_side import CylinderSide
from mmplan.grasps.cylinder_top import CylinderTop
from mmplan.grasps.family import GraspFamily
from mmplan.grasps.hand import HandSize
from mmplan.grasps.rim import Rim
from mmplan.grasps.silhouette import Side, Silhouette
from mmplan.grasps.sphere import SphereGrasps
from mmplan.shapes import Array, Box, Capsule, Cone, Cylinder, Revolve, Shape, Sphere

Families = dict[str, GraspFamily]

# Where a lip is taken: this share of a finger's width inside of the widest point.
_LIP_INSET = 0.5
# How far the hand may turn from the radial direction at the wall of a vessel, rad.
_WALL_SPREAD = 0.3
_ARC_POINTS = 12


@singledispatch
def default_families(shape: Shape, hand: HandSize) -> Families:
    """The families of a shape by name; empty where the hand is too small for it.

    A mesh has none of this kind: its grasps are sampled.
    """
    raise TypeError(f"no families of {type(shape).__name__} for {hand}")


@default_families.register
def _(shape: Box, hand: HandSize) -> Families:
    family = BoxFaces(shape.size, hand.widest, hand.depth)
    return {"faces": family} if len(family.ways) else {}


@default_families.register
def _(shape: Sphere, hand: HandSize) -> Families:
    return {"ball": SphereGrasps()} if 2.0 * shape.radius <= hand.widest else {}


@default_families.register(Cylinder | Capsule | Cone | Revolve)
def _(shape: Cylinder | Capsule | Cone | Revolve, hand: HandSize) -> Families:
    silhouette = Silhouette.of_profile(profile_of(shape))
    families: Families = {}
    for side in silhouette.sides(hand):
        kind = "stem" if silhouette.is_stem(side) else "body"
        families[_free_name(kind, families)] = _around(side, kind, hand)
    families |= _ends(silhouette, hand)
    wall = silhouette.wall(hand)
    if wall is not None:
        height = float(silhouette.height[-1]) - hand.depth[0]
        families["wall"] = Rim(wall, height, _WALL_SPREAD, tilt=np.pi / 2)
    if silhouette.is_flat(hand):
        families["lip"] = lip(silhouette, hand)
    return families


def around_body(shape: Shape, hand: HandSize) -> tuple[float, float] | None:
    """The interval (m) along z of the longest side that the hand goes around."""
    if not isinstance(shape, Cylinder | Capsule | Cone | Revolve):
        return None
    silhouette = Silhouette.of_profile(profile_of(shape))
    sides = silhouette.sides(hand)
    bodies = [s for s in sides if not silhouette.is_stem(s)] or sides
    longest = max(bodies, key=lambda s: s.high - s.low, default=None)
    return None if longest is None else _targets(longest, hand)


def ends_of(shape: Shape) -> tuple[float, float]:
    """The lowest and the highest z (m) of a shape that is no mesh."""
    if isinstance(shape, Box):
        return (-shape.size[2] / 2.0, shape.size[2] / 2.0)
    if isinstance(shape, Sphere):
        return (-shape.radius, shape.radius)
    assert isinstance(shape, Cylinder | Capsule | Cone | Revolve), "meshes have none"
    heights = profile_of(shape)[:, 1]
    return (float(heights.min()), float(heights.max()))


def narrowest(shape: Shape) -> float:
    """The least width (m) of a shape, of those round about z their least diameter."""
    if isinstance(shape, Box):
        return min(shape.size)
    if isinstance(shape, Sphere):
        return 2.0 * shape.radius
    assert isinstance(shape, Cylinder | Capsule | Cone | Revolve), "meshes have none"
    return float(2.0 * Silhouette.of_profile(profile_of(shape)).outer.min())


def profile_of(shape: Cylinder | Capsule | Cone | Revolve) -> Array:
    """The outline (r, z), (n, 2), of a shape that is round about z."""
    if isinstance(shape, Revolve):
        return shape.profile
    half, r = shape.length / 2.0, shape.radius
    if isinstance(shape, Cylinder):
        return np.array([[0, -half], [r, -half], [r, half], [0, half]])
    if isinstance(shape, Cone):
        return np.array([[0, -half], [r, -half], [0, half]])
    arc = np.linspace(0.0, np.pi / 2, _ARC_POINTS)
    cap = np.stack([r * np.cos(arc), half + r * np.sin(arc)], axis=1)
    return np.concatenate([cap[::-1] * [1, -1], cap])


def lip(silhouette: Silhouette, hand: HandSize) -> Rim:
    """Grasps of a plate's edge."""
    widest = int(silhouette.outer.argmax())
    inside = float(silhouette.outer[widest]) - _LIP_INSET * hand.width
    near = silhouette.outer >= inside
    heights = silhouette.height[near]
    return Rim(inside, float(heights[0] + heights[-1]) / 2.0)


def _around(side: Side, kind: str, hand: HandSize) -> GraspFamily:
    along = _targets(side, hand)
    return Axis(along) if kind == "stem" else CylinderSide(along)


def _targets(side: Side, hand: HandSize) -> tuple[float, float]:
    """Where target points lie on a side so that whole fingers are on it, if it can."""
    margin = min(hand.width / 2.0, (side.high - side.low) / 3.0)
    return (side.low + margin, side.high - margin)


def _ends(silhouette: Silhouette, hand: HandSize) -> Families:
    """Grasps around the upper and the lower end."""
    families: Families = {}
    for name, seen in (("top", silhouette), ("bottom", silhouette.flipped())):
        below = name == "bottom"
        for side in seen.sides(hand)[-1:]:
            gap = seen.above(side)
            low, high = hand.depth
            if gap is None or gap + low > high:
                continue
            deepest = min(high, gap + side.high - side.low)
            end = float(seen.height[-1]) * (-1.0 if below else 1.0)
            families[name] = CylinderTop(
                end, (gap + low, max(gap + low, deepest)), below
            )
    return families


def _free_name(kind: str, taken: Families) -> str:
    number = sum(name.startswith(kind) for name in taken)
    return f"{kind}_{number + 1}" if number else kind
