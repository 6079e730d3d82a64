"""Grasps in scene files: one section for each family."""

from __future__ import annotations

import math
from typing import Annotated, Literal, TypeAlias

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from mmplan.files.section import Interval, Metres, Section, Size, fault, fault_at
from mmplan.files.shape_sections import ShapeKeys
from mmplan.files.suggestions import listed, unknown


class AxisSection(Section):
    """Target on the object's z axis, approach perpendicular to it."""

    family: Literal["axis"]
    """axis: at the z axis from any side; rim: at the outer lip."""
    along: Interval
    """Lowest and highest target, z in the object's frame, m."""

    def fault_on(self, shape: ShapeKeys) -> str | None:
        """Why there is nothing to grasp on that shape."""
        low, high = shape.extent()
        if self.along[0] <= high and self.along[1] >= low:
            return None
        return f"'along' misses the object, whose z runs from {low:g} to {high:g} m"


def _half_turn(angle: float) -> float:
    if not 0.0 <= angle <= math.pi:
        raise fault(f"must be from 0 to pi (rad), got {angle:g}")
    return angle


class RimSection(Section):
    """Target on the outer lip, approach in the plane of the lip."""

    family: Literal["rim"]
    """axis: at the z axis from any side; rim: at the outer lip."""
    radius: Size | None = None
    """Radius of the lip, m; by default that of the profile's widest point."""
    height: Metres | None = None
    """z of the lip in the object's frame, m; by default that of the same point."""
    spread: Annotated[
        float,
        AfterValidator(_half_turn),
        Field(json_schema_extra={"minimum": 0, "maximum": math.pi}),
    ] = math.pi / 3
    """How far the approach may turn from the radial direction, to either side, rad."""

    def fault_on(self, shape: ShapeKeys) -> str | None:
        """Why there is nothing to grasp on that shape."""
        if shape.revolve is not None or None not in (self.radius, self.height):
            return None
        return "the lip of a shape other than revolve needs both radius and height"


FAMILIES: dict[str, type[AxisSection] | type[RimSection]] = {
    "axis": AxisSection,
    "rim": RimSection,
}


def _known_family(value: object) -> object:
    """The grasp as written, once its family is known."""
    if not isinstance(value, dict):
        raise fault("expected {family: ..., ...}")
    family = value.get("family")
    if "family" not in value:
        raise fault(f"missing key 'family'; known: {listed(FAMILIES)}")
    if not isinstance(family, str) or family not in FAMILIES:
        raise fault_at(("family",), unknown("family", str(family), FAMILIES))
    return value


def _section(value: dict[str, str] | AxisSection | RimSection) -> str:
    """The tag of a grasp's section: the name of its class."""
    if isinstance(value, Section):
        return type(value).__name__
    return FAMILIES[value["family"]].__name__


GraspSection: TypeAlias = Annotated[
    Annotated[AxisSection, Tag("AxisSection")]
    | Annotated[RimSection, Tag("RimSection")],
    Discriminator(_section),
    BeforeValidator(_known_family),
]
