"""Grasp families that go by an object's shape, as sections of scene files."""

from __future__ import annotations

import math
from typing import Annotated, Literal, TypeAlias

from pydantic import AfterValidator, Field

from mmplan.files.section import Distance, Interval, Metres, Section, Size, fault
from mmplan.files.shape_sections import ShapeKeys

Point: TypeAlias = tuple[Metres, Metres, Metres]
FaceName = Literal["+x", "-x", "+y", "-y", "+z", "-z"]
_ROUND = ("cylinder", "capsule", "cone", "revolve")


def _half_turn(angle: float) -> float:
    if not 0.0 <= angle <= math.pi:
        raise fault(f"must be from 0 to pi (rad), got {angle:g}")
    return angle


def _quarter_turn(angle: float) -> float:
    if not 0.0 <= angle <= math.pi / 2:
        raise fault(f"must be from 0 to pi/2 (rad), got {angle:g}")
    return angle


HalfTurn: TypeAlias = Annotated[
    float,
    AfterValidator(_half_turn),
    Field(json_schema_extra={"minimum": 0, "maximum": math.pi}),
]
QuarterTurn: TypeAlias = Annotated[
    float,
    AfterValidator(_quarter_turn),
    Field(json_schema_extra={"minimum": 0, "maximum": math.pi / 2}),
]


class FamilySection(Section):
    """What the sections of all grasp families have in common."""

    def fault_on(self, shape: ShapeKeys) -> str | None:  # noqa: ARG002
        """Why there is nothing to grasp on that shape, None if there may be."""
        return None


def _is_round(shape: ShapeKeys) -> bool:
    return any(getattr(shape, name) is not None for name in _ROUND)


def _misses(along: Interval, shape: ShapeKeys) -> str | None:
    """The fault of an interval of z beside the shape."""
    low, high = shape.extent()
    if along[0] <= high and along[1] >= low:
        return None
    return f"'along' misses the object, whose z runs from {low:g} to {high:g} m"


class AxisSection(FamilySection):
    """Target on the object's z axis, approach perpendicular to it."""

    family: Literal["axis"]
    """axis: at the z axis from any side, level."""
    along: Interval
    """Lowest and highest target, z in the object's frame, m."""

    def fault_on(self, shape: ShapeKeys) -> str | None:
        """Why there is nothing to grasp on that shape."""
        return _misses(self.along, shape)


class CylinderSideSection(FamilySection):
    """Target on the object's z axis, approach from any side, inclined or level."""

    family: Literal["cylinder_side"]
    """cylinder_side: around a round body from any side, inclined or level."""
    along: Interval | None = None
    """Lowest and highest target, z, m; by default that of the longest round body."""
    tilt: QuarterTurn = math.pi / 6
    """How far the hand may come from above or below, rad."""

    def fault_on(self, shape: ShapeKeys) -> str | None:
        """Why there is nothing to grasp on that shape."""
        if self.along is not None:
            return _misses(self.along, shape)
        if _is_round(shape):
            return None
        return "needs 'along' on a shape that is not round about z"


class CylinderTopSection(FamilySection):
    """The hand comes along the object's z axis and closes around its end."""

    family: Literal["cylinder_top"]
    """cylinder_top: around the end of a round body, along its axis."""
    end: Metres | None = None
    """z of the end, m; by default that of the shape's highest (below: lowest) point."""
    below: bool = False
    """true: the lower end, to which the hand comes from below."""
    depth: tuple[Distance, Distance] | None = None
    """Least and greatest depth of the target inside the end, m; default: the hand's."""

    def fault_on(self, shape: ShapeKeys) -> str | None:
        """Why there is nothing to grasp on that shape."""
        if self.end is None and shape.mesh is not None:
            return "needs 'end' on a mesh"
        return None


class RimSection(FamilySection):
    """Target on the outer lip, approach in the plane of the lip or from above it."""

    family: Literal["rim"]
    """rim: at the outer lip of a plate, or at the wall of a bowl from above."""
    radius: Size | None = None
    """Radius of the lip, m; by default that of the profile's widest point."""
    height: Metres | None = None
    """z of the lip in the object's frame, m; by default that of the same point."""
    spread: HalfTurn = math.pi / 3
    """How far the approach may turn from the radial direction, to either side, rad."""
    tilt: QuarterTurn = 0.0
    """How far the hand comes from above the plane of the lip; pi/2: straight down."""

    def fault_on(self, shape: ShapeKeys) -> str | None:
        """Why there is nothing to grasp on that shape."""
        if shape.revolve is not None or None not in (self.radius, self.height):
            return None
        return "the lip of a shape other than revolve needs both radius and height"


class BoxFacesSection(FamilySection):
    """The hand comes to a face of a box and closes on two faces beside it."""

    family: Literal["box_faces"]
    """box_faces: on two opposite faces of a box, coming to a third."""
    faces: Annotated[tuple[FaceName, ...], Field(min_length=1)] = (
        "+x",
        "-x",
        "+y",
        "-y",
        "+z",
        "-z",
    )
    """Faces that the hand may come to."""
    tilt: QuarterTurn = math.pi / 6
    """How far the hand may be inclined about the closing direction, rad."""

    def fault_on(self, shape: ShapeKeys) -> str | None:
        """Why there is nothing to grasp on that shape."""
        return None if shape.box is not None else "goes with 'box' only"


class SphereGraspsSection(FamilySection):
    """Target in the middle, approach from anywhere."""

    family: Literal["sphere"]
    """sphere: about a point, from anywhere."""
    centre: Point = (0.0, 0.0, 0.0)
    """The target, in the object's frame, m."""
