"""The robot format: what may stand in a robot.yaml."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from mmplan.files.robot_parts import (
    ArmSection,
    BaseSection,
    Collision,
    HandSection,
    IkSection,
    JointType,
    RobotFile,
    Tool,
)
from mmplan.files.section import (
    JointInterval,
    Line,
    Name,
    Positive,
    Section,
    Size,
    version,
)

ROBOT_VERSION = 1


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
    urdf: RobotFile
    """The URDF file, beside the robot.yaml or in example-robot-data."""
    srdf: RobotFile | None = None
    """An SRDF file, for its disabled pairs."""
    base: BaseSection
    """The mobile base."""
    arm: ArmSection
    """The arm."""
    hand: HandSection
    """The hand."""
    tool: Tool
    """The tool frame: a link, or a pose in one; z approaches, y is where it closes."""
    reach: Size | None = None
    """Horizontal distance from the base's centre to the tool, arm stretched, m."""
    ik: IkSection
    """Inverse kinematics of the arm."""
    types: dict[str, JointType] = Field(default_factory=dict)
    """Types of joints instead of those of the URDF."""
    parked: dict[str, float] = Field(default_factory=dict)
    """Where joints of no group are held, m or rad; others at 0, or nearest to it."""
    position: dict[str, JointInterval] = Field(default_factory=dict)
    """Position limits of joints instead of those of the URDF: [lower, upper]."""
    velocity: dict[str, Positive] = Field(default_factory=dict)
    """Velocity limits of joints instead of those of the URDF, m/s or rad/s."""
    acceleration: dict[str, Positive]
    """Acceleration limit of every joint, m/s^2 or rad/s^2."""
    configurations: dict[Name, tuple[float, ...]] = Field(default_factory=dict)
    """Configurations of the arm by names of your choice: one number a joint, rad."""
    score_scales: ScalesSection
    """Constants that bring the score's terms to one scale."""
    collision: dict[str, Collision] = Field(default_factory=dict)
    """Collision bodies of links: hull (of each mesh), mesh, decomposed, or bodies."""
    disabled_pairs: tuple[tuple[str, str, str], ...] = ()
    """Pairs of links that are not checked for collision: [link, link, reason]."""
