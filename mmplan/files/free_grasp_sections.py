"""Grasp families for objects of any shape, as sections of scene files."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator
from typing_extensions import Self

from mmplan.files.pose_section import PoseSection
from mmplan.files.section import FileName, Interval, Radians, fault_at
from mmplan.files.shape_grasp_sections import FamilySection, HalfTurn, Point
from mmplan.files.shape_sections import ShapeKeys


class HandleSection(FamilySection):
    """Target on a line, approach perpendicular to it."""

    family: Literal["handle"]
    """handle: across a straight bar, from its free side."""
    start: Point
    """One end of the line, in the object's frame, m."""
    end: Point
    """The other end."""
    outward: Point
    """Direction from the object to the free side of the bar."""
    spread: HalfTurn = math.pi / 3
    """How far the hand may turn about the bar from 'outward', to either side, rad."""

    @model_validator(mode="after")
    def _has_directions(self) -> Self:
        along = [b - a for a, b in zip(self.start, self.end, strict=True)]
        if not any(along):
            raise fault_at(("end",), "expected another point than 'start'")
        a, b, c = along
        x, y, z = self.outward
        across = (b * z - c * y, c * x - a * z, a * y - b * x)
        if math.hypot(*across) <= 1e-6 * math.hypot(*along) * math.hypot(x, y, z):
            raise fault_at(("outward",), "expected a direction across the bar")
        return self


class PosesSection(FamilySection):
    """Grasps one by one."""

    family: Literal["poses"]
    """poses: a list of poses of the tool."""
    poses: Annotated[tuple[PoseSection, ...], Field(min_length=1)]
    """Poses of the tool frame in the object's frame."""


class TsrSection(FamilySection):
    """A task space region: a frame that may move within bounds, and the tool in it."""

    family: Literal["tsr"]
    """tsr: a frame within bounds, and the tool in it."""
    frame: PoseSection = PoseSection()
    """Pose of the region's frame in the object's frame."""
    tool: PoseSection
    """Pose of the tool frame in the region's frame."""
    x: Interval = (0.0, 0.0)
    """Lowest and highest displacement of the region's frame along its x, m."""
    y: Interval = (0.0, 0.0)
    """The same along y, m."""
    z: Interval = (0.0, 0.0)
    """The same along z, m."""
    roll: tuple[Radians, Radians] = (0.0, 0.0)
    """Lowest and highest turn about x, rad; the fixed axes x, then y, then z."""
    pitch: tuple[Radians, Radians] = (0.0, 0.0)
    """The same about y, rad."""
    yaw: tuple[Radians, Radians] = (0.0, 0.0)
    """The same about z, rad."""


class AntipodalSection(FamilySection):
    """Grasps sampled from a mesh: pads on two opposite places of its surface."""

    family: Literal["antipodal"]
    """antipodal: sampled from the surface of a mesh."""
    samples: Annotated[int, Field(ge=10, le=100_000)] = 500
    """How many grasps."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of the samples."""

    def fault_on(self, shape: ShapeKeys) -> str | None:
        """Why there is nothing to grasp on that shape."""
        return None if shape.mesh is not None else "goes with 'mesh' only"


class FileSection(FamilySection):
    """Grasps made elsewhere, in a file of their own."""

    family: Literal["file"]
    """file: grasps made elsewhere, in a file of their own."""
    file: FileName
    """An isaac_grasp file (YAML, version 1.0), or one of task space regions."""
    tool: PoseSection | None = None
    """Pose of the robot's tool frame in the file's hand frame; default: see docs."""
