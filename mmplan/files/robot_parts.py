"""Sections of a robot.yaml about its base, arm, hand, tool and bodies."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator
from typing_extensions import Self

from mmplan.files.pose_section import PoseSection
from mmplan.files.section import (
    FileName,
    Name,
    Section,
    Size,
    fault,
    messages,
)
from mmplan.files.shape_sections import RoundSection, SphereSection
from mmplan.files.urdf_composition import BASE_JOINTS

JointType: TypeAlias = Literal["revolute", "prismatic", "continuous", "fixed"]
Joints: TypeAlias = Annotated[tuple[str, ...], Field(min_length=1)]


class ExampleSection(Section):
    """A file of the example-robot-data package."""

    example_robot_data: str
    """Path of the file inside the package's robots folder."""


def _file_form(value: object) -> str | None:
    if isinstance(value, str):
        return "file"
    return "example" if isinstance(value, dict) else None


RobotFile: TypeAlias = Annotated[
    Annotated[FileName, Tag("file")] | Annotated[ExampleSection, Tag("example")],
    Discriminator(
        _file_form, **messages("expected a file name or {example_robot_data: ...}")
    ),
]


class BodySection(Section):
    """A primitive that is part of a link: one shape, and its pose."""

    box: tuple[Size, Size, Size] | None = None
    """A box centred at the origin: full lengths along x, y and z, m."""
    sphere: SphereSection | None = None
    """A sphere about the origin."""
    cylinder: RoundSection | None = None
    """A cylinder along z, centred at the origin."""
    at: PoseSection = PoseSection()
    """Pose of the shape in the link's frame."""

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        given = [s for s in (self.box, self.sphere, self.cylinder) if s is not None]
        if len(given) != 1:
            raise fault(f"expected one of box, sphere, cylinder; got {len(given)}")
        return self


class BaseSection(Section):
    """The mobile base."""

    type: Literal["xy", "planar", "diff_drive", "reeds_shepp", "fixed"]
    """xy does not turn, planar does; diff_drive, reeds_shepp roll along a heading."""
    joints: tuple[str, ...] = ()
    """The URDF's joints along x, along y, and about z; added where none are given."""
    radius: Size | None = None
    """Radius of the circle about the base's centre that encloses it, m."""
    turning_radius: Size | None = None
    """With reeds_shepp: radius of its tightest turn, m."""
    mount: PoseSection = PoseSection()
    """Pose of the URDF's root in the frame of the base that is added."""
    bodies: dict[Name, BodySection] = Field(default_factory=dict)
    """Bodies of the base that is added, in its frame, by names of your choice."""

    @model_validator(mode="after")
    def _joints_of_type(self) -> Self:
        number = len(BASE_JOINTS[self.type])
        if self.joints and len(self.joints) != number:
            message = f"a base of type {self.type} has {number} joints"
            raise fault(f"{message}, got {len(self.joints)}")
        if (self.turning_radius is not None) != (self.type == "reeds_shepp"):
            raise fault("'turning_radius' goes with 'type: reeds_shepp', and only then")
        if self.joints and (self.bodies or self.mount != PoseSection()):
            raise fault(
                "'bodies' and 'mount' go with a base that is added; give no 'joints'"
            )
        return self


class ArmSection(Section):
    """The arm, with a torso lift if there is one."""

    joints: Joints
    """The URDF's joints from the shoulder, or a torso lift, to the wrist."""


class HandSection(Section):
    """The hand."""

    joints: Joints
    """The URDF's joints of the fingers, without those that mimic others."""
    open: tuple[float, ...]
    """Position of each joint with the hand open, m or rad."""
    closed: tuple[float, ...]
    """Position of each joint with the hand closed on nothing, m or rad."""
    urdf: RobotFile | None = None
    """The hand's own URDF, where that of the robot has none."""
    link: str | None = None
    """With urdf: the link of the robot's URDF that the hand is fixed to."""
    at: PoseSection = PoseSection()
    """With urdf: pose of the hand's root in the frame of that link."""

    @model_validator(mode="after")
    def _attached(self) -> Self:
        if (self.urdf is None) != (self.link is None):
            raise fault("'urdf' and 'link' go together: what is fixed to which link")
        return self


class ToolSection(PoseSection):
    """The tool frame: a pose in the frame of a link."""

    link: str
    """Link of the URDF that carries the tool frame."""


class IkSection(Section):
    """Inverse kinematics: the solver, and its settings as numbers by name."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, float]

    solver: str
    """Name of the solver."""


def _tool_form(value: object) -> str | None:
    if isinstance(value, str):
        return "link"
    return "pose" if isinstance(value, dict) else None


Tool: TypeAlias = Annotated[
    Annotated[str, Tag("link")] | Annotated[ToolSection, Tag("pose")],
    Discriminator(_tool_form, **messages("expected a link or {link: ..., xyz: ...}")),
]


def _collision_form(value: object) -> str | None:
    if isinstance(value, str):
        return "kind"
    return "bodies" if isinstance(value, dict) else None


BodyKind: TypeAlias = Literal["hull", "mesh", "decomposed"]
Collision: TypeAlias = Annotated[
    Annotated[BodyKind, Tag("kind")]
    | Annotated[dict[Name, BodySection], Tag("bodies")],
    Discriminator(
        _collision_form,
        **messages("expected hull, mesh, decomposed, or bodies by name"),
    ),
]
