"""Shapes in scene files: one key each, exactly one for an obstacle or object."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, TypeAlias

from pydantic import AfterValidator, Discriminator, Tag, model_validator
from typing_extensions import Self

from mmplan.files.profile import profile_fault
from mmplan.files.section import (
    Distance,
    FileName,
    Metres,
    Section,
    Size,
    fault,
    messages,
)
from mmplan.files.suggestions import listed

SHAPES = ("box", "sphere", "cylinder", "capsule", "cone", "mesh", "revolve", "urdf")
MESH_TYPES = (".stl", ".obj", ".ply", ".dae", ".gltf", ".glb")


class SphereSection(Section):
    """A sphere about the origin."""

    radius: Size
    """Radius, m."""


class RoundSection(Section):
    """A cylinder, capsule or cone along z, centred at the origin."""

    radius: Size
    """Radius, m."""
    length: Size
    """Length along z, m; of a capsule without its two half-spheres."""


def _mesh_type(name: str) -> str:
    if Path(name).suffix.lower() not in MESH_TYPES:
        raise fault(f"unknown type of mesh '{name}'; known: {listed(MESH_TYPES)}")
    return name


def _simple_outline(
    profile: tuple[tuple[float, float], ...],
) -> tuple[tuple[float, float], ...]:
    if message := profile_fault(profile):
        raise fault(message)
    return profile


def _number_or_numbers(value: object) -> str | None:
    if isinstance(value, tuple | list):
        return "numbers"
    return "number" if isinstance(value, int | float) else None


Scale: TypeAlias = Annotated[
    Annotated[Size, Tag("number")] | Annotated[tuple[Size, Size, Size], Tag("numbers")],
    Discriminator(_number_or_numbers, **messages("expected a number or 3 numbers")),
]
Profile: TypeAlias = Annotated[
    tuple[tuple[Distance, Metres], ...], AfterValidator(_simple_outline)
]


class ShapeKeys(Section):
    """The keys of a shape; exactly one of them is given."""

    box: tuple[Size, Size, Size] | None = None
    """A box centred at the origin: full lengths along x, y and z, m."""
    sphere: SphereSection | None = None
    """A sphere about the origin."""
    cylinder: RoundSection | None = None
    """A cylinder along z, centred at the origin."""
    capsule: RoundSection | None = None
    """A cylinder along z with half-spheres beyond both ends, centred at the origin."""
    cone: RoundSection | None = None
    """A cone along z: its base at -length / 2, its tip at +length / 2."""
    mesh: Annotated[FileName, AfterValidator(_mesh_type)] | None = None
    """File of a closed triangle mesh: STL, OBJ, PLY, DAE or glTF."""
    scale: Scale | None = None
    """With mesh: one factor, or one for each axis; 0.001 for a mesh in millimetres."""
    revolve: Profile | None = None
    """A solid of revolution about z: outline [[r, z], ...] of the material, m."""

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        allowed = [s for s in SHAPES if s in type(self).model_fields]
        given = [s for s in allowed if getattr(self, s) is not None]
        if not given:
            raise fault(f"no shape; expected one of {listed(allowed)}")
        if len(given) > 1:
            raise fault(f"{len(given)} shapes, {listed(given)}; keep one")
        if self.scale is not None and self.mesh is None:
            raise fault("'scale' goes with 'mesh' only")
        return self

    def extent(self) -> tuple[float, float]:
        """Lowest and highest z in the shape's frame, m; a mesh's file is not read."""
        if self.mesh is not None:
            return (-math.inf, math.inf)
        if self.revolve is not None:
            heights = [z for _, z in self.revolve]
            return (min(heights), max(heights))
        half = self._half_height()
        return (-half, half)

    def _half_height(self) -> float:
        if self.box is not None:
            return self.box[2] / 2
        if self.sphere is not None:
            return self.sphere.radius
        if self.capsule is not None:
            return self.capsule.length / 2 + self.capsule.radius
        tapered = self.cylinder or self.cone
        assert tapered is not None, "validated: one shape is given"
        return tapered.length / 2
