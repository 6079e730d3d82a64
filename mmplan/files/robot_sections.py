"""The robot format: what may stand in a robot.yaml, section by section."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import ConfigDict, Discriminator, Field, Tag

from mmplan.files.section import (
    FileName,
    Line,
    Name,
    Positive,
    Section,
    Size,
    messages,
    version,
)

ROBOT_VERSION = 1


class ExampleSection(Section):
    """A robot of the example-robot-data package."""

    example_robot_data: str
    """Path of the URDF inside the package's robots folder."""


def _urdf_form(value: object) -> str | None:
    if isinstance(value, str):
        return "file"
    return "example" if isinstance(value, dict) else None


UrdfName: TypeAlias = Annotated[
    Annotated[FileName, Tag("file")] | Annotated[ExampleSection, Tag("example")],
    Discriminator(
        _urdf_form, **messages("expected a file name or {example_robot_data: ...}")
    ),
]
Joints: TypeAlias = Annotated[tuple[str, ...], Field(min_length=1)]


class BaseSection(Section):
    """The mobile base."""

    type: Literal["xy"]
    """xy: moves along x and y and does not turn."""
    joints: tuple[str, str]
    """The URDF's joints along x and along y."""
    radius: Size
    """Radius of the circle about the base's centre that encloses it, m."""


class ArmSection(Section):
    """The arm."""

    joints: Joints
    """The URDF's joints from the shoulder to the wrist."""


class HandSection(Section):
    """The hand."""

    joints: Joints
    """The URDF's joints of the fingers."""
    open: tuple[float, ...]
    """Position of each joint with the hand open, m or rad."""
    closed: tuple[float, ...]
    """Position of each joint with the hand closed on nothing, m or rad."""


class IkSection(Section):
    """Inverse kinematics: the solver, and its settings as numbers by name."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, float]

    solver: str
    """Name of the solver."""


class ScalesSection(Section):
    """Constants that bring the score's terms to one scale: they count 50."""

    manipulability: Positive
    """Value of the manipulability that counts 50."""
    clutter: Positive
    """Value of the clutter term that counts 50."""


class RobotSection(Section):
    """A robot: its URDF and what a URDF does not say."""

    mmplan_robot: Annotated[
        int,
        version("robot", ROBOT_VERSION),
        Field(json_schema_extra={"const": ROBOT_VERSION}),
    ]
    """Version of the robot format: 1."""
    name: Name
    """Name of the robot."""
    description: Line = ""
    """One line that says what the robot is."""
    urdf: UrdfName
    """The URDF file, beside the robot.yaml or in example-robot-data."""
    base: BaseSection
    """The mobile base."""
    arm: ArmSection
    """The arm."""
    hand: HandSection
    """The hand."""
    tool: str
    """Link of the URDF at the tool frame: z approaches, the fingers close along y."""
    reach: Size
    """Horizontal distance from the base's centre to the tool, arm stretched, m."""
    ik: IkSection
    """Inverse kinematics of the arm."""
    acceleration: dict[str, Positive]
    """Acceleration limit of every joint, m/s^2 or rad/s^2."""
    configurations: dict[Name, tuple[float, ...]] = Field(default_factory=dict)
    """Configurations of the arm by names of your choice: one number a joint, rad."""
    score_scales: ScalesSection
    """Constants that bring the score's terms to one scale."""
    disabled_pairs: tuple[tuple[str, str, str], ...] = ()
    """Pairs of links that are not checked for collision: [link, link, reason]."""
