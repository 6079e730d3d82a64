"""How an object is carried: the section `carry` of a task."""

from __future__ import annotations

import math
from typing import Annotated, TypeAlias

from pydantic import AfterValidator, Discriminator, Tag

from mmplan.files.pose_section import PoseSection
from mmplan.files.section import Positive, Section, Size, fault, messages


class RegionSection(Section):
    """A box of space."""

    box: tuple[Size, Size, Size]
    """Full lengths along x, y and z, m."""
    at: PoseSection = PoseSection()
    """Pose of the box's centre in the world."""


def _tilt(angle: float) -> float:
    if angle >= math.pi / 2:
        raise fault(
            f"must be below pi / 2, got {angle:g}: angles are in radians; "
            f"{angle:g} degrees are {math.radians(angle):.4g} rad"
        )
    return angle


def _direction(axis: tuple[float, float, float]) -> tuple[float, float, float]:
    if math.hypot(*axis) < 1e-6:
        raise fault("expected a direction, got no length")
    return axis


Tilt: TypeAlias = Annotated[Positive, AfterValidator(_tilt)]
Direction: TypeAlias = Annotated[tuple[float, float, float], AfterValidator(_direction)]


class UprightSection(Section):
    """An axis of the object that stays near the vertical."""

    angle: Tilt
    """Largest angle between the axis and the vertical, rad."""
    axis: Direction = (0.0, 0.0, 1.0)
    """The axis in the object's frame; it points up."""
    outside: tuple[RegionSection, ...] = ()
    """Holds outside of these boxes only: where the origin of the object's frame is."""


def _number_or_keys(value: object) -> str | None:
    if isinstance(value, dict | UprightSection):
        return "UprightSection"
    return "number" if isinstance(value, int | float) else None


class CarrySection(Section):
    """What holds from the grasp to the release."""

    upright: (
        Annotated[
            Annotated[Tilt, Tag("number")]
            | Annotated[UprightSection, Tag("UprightSection")],
            Discriminator(
                _number_or_keys, **messages("expected a number or keys with values")
            ),
        ]
        | None
    ) = None
    """Largest tilt of the object's z axis from the vertical, rad; or more in keys."""
    max_speed: Positive | None = None
    """Largest speed of the origin of the tool frame, m/s."""
    forbidden: tuple[RegionSection, ...] = ()
    """Boxes that no point of the object may be in."""

    @property
    def upright_keys(self) -> UprightSection | None:
        """The rule of tilt in its long form."""
        if isinstance(self.upright, float):
            return UprightSection(angle=self.upright)
        return self.upright
