"""The scene format: what may stand in a scene file, section by section."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, TypeAlias

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator
from typing_extensions import Self

from mmplan.files.carry_sections import CarrySection
from mmplan.files.free_grasp_sections import FileSection
from mmplan.files.grasp_sections import GraspSection
from mmplan.files.pose_section import PoseSection
from mmplan.files.profile import profile_fault
from mmplan.files.section import (
    Distance,
    FileName,
    Interval,
    Line,
    Metres,
    Name,
    Positive,
    Section,
    fault,
    fault_at,
    messages,
    version,
)
from mmplan.files.settings_sections import (
    OptimizerSection,
    PlannerSection,
    ScoreSection,
)
from mmplan.files.shape_sections import ShapeKeys

SCENE_VERSION = 1

Friction = Annotated[Positive, Field(le=10.0)]


def _name_or_numbers(value: object) -> str | None:
    kinds: dict[type, str] = {str: "name", tuple: "numbers", list: "numbers"}
    return kinds.get(type(value))


NameOrNumbers: TypeAlias = Annotated[
    Annotated[str, Tag("name")] | Annotated[tuple[float, ...], Tag("numbers")],
    Discriminator(_name_or_numbers, **messages("expected a name or a list of numbers")),
]


class StartSection(Section):
    """Where the robot stands before the first task."""

    base: tuple[Metres, ...] = ()
    """Positions of the base: x, y (m), heading (rad); none where it has no joints."""
    arm: NameOrNumbers
    """A configuration of the robot file by name, or one number a joint, rad."""
    hand: NameOrNumbers = "open"
    """open, closed, or one number a joint."""


class BoundsSection(Section):
    """Where the base may go; around the start and all poses where not given."""

    x: Interval | None = None
    """Lowest and highest x, m."""
    y: Interval | None = None
    """Lowest and highest y, m."""


class ZoneSection(Section):
    """A zone of the floor that the base must keep out of: a box or a polygon."""

    box: tuple[Interval, Interval] | None = None
    """Lowest and highest x, then lowest and highest y, m."""
    polygon: tuple[tuple[Metres, Metres], ...] | None = None
    """Corners [x, y] in their order, m; the last is joined to the first."""

    @model_validator(mode="after")
    def _one_sound_shape(self) -> Self:
        if (self.box is None) == (self.polygon is None):
            raise fault("expected one of box and polygon")
        if self.polygon is not None and (message := profile_fault(self.polygon)):
            raise fault_at(("polygon",), message)
        return self

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """The corners of either."""
        if self.polygon is not None:
            return self.polygon
        assert self.box is not None, "validated: one shape is given"
        (x_low, x_high), (y_low, y_high) = self.box
        return ((x_low, y_low), (x_high, y_low), (x_high, y_high), (x_low, y_high))


class RobotSection(Section):
    """Which robot, where it starts, where it may go."""

    model: str
    """A robot that is shipped, by name, or the path of a robot.yaml."""
    base: Literal["fixed"] | None = None
    """fixed: the base, of whatever type, stays where it starts."""
    at: PoseSection | None = None
    """Pose of a robot without a mobile base in the world."""
    start: StartSection
    """Where the robot stands before the first task."""
    forbidden: tuple[ZoneSection, ...] = ()
    """Zones of the floor that the circle around the base must keep out of."""
    bounds: BoundsSection = BoundsSection()
    """Where the base may go; around the start and all poses where not given."""

    @model_validator(mode="after")
    def _start_within_bounds(self) -> Self:
        for i, (value, axis) in enumerate(zip(self.start.base, "xy", strict=False)):
            bounds = getattr(self.bounds, axis)
            if bounds is not None and not bounds[0] <= value <= bounds[1]:
                message = f"{value:g} is outside robot.bounds.{axis}"
                raise fault_at(("start", "base", i), message)
        return self


class ObstacleSection(ShapeKeys):
    """A thing that stays where it is: one shape, or a fixture's URDF, and its pose."""

    urdf: FileName | None = None
    """File of an articulated fixture, held still."""
    configuration: dict[str, float] = Field(default_factory=dict)
    """With urdf: position of its joints by name, rad or m; others are at 0."""
    ground: bool = False
    """true for what the base drives on: no obstacle for the base's own links."""
    at: PoseSection = PoseSection()
    """Pose of the shape's frame in the world."""

    @model_validator(mode="after")
    def _configured(self) -> Self:
        if self.configuration and self.urdf is None:
            raise fault("'configuration' goes with 'urdf' only")
        return self


class ObjectSection(ShapeKeys):
    """A thing to be moved: one shape, its pose at the start, its grasps."""

    at: PoseSection
    """Pose of the object's frame in the world before the first task."""
    grasps: dict[Name, GraspSection] = Field(default_factory=dict)
    """Ways to grasp it by names of your choice; by default those of its shape."""
    mass: Positive | None = None
    """Mass, kg; without it grasps are not judged by the weight that they hold."""
    friction: Friction = 0.5
    """Coefficient of friction between the fingers and the object."""

    @model_validator(mode="after")
    def _graspable(self) -> Self:
        for name, grasp in self.grasps.items():
            if isinstance(grasp, str):
                continue
            if message := grasp.fault_on(self):
                raise fault_at(("grasps", name), message)
        return self

    def grasp_files(self) -> Iterator[tuple[str, str]]:
        """The grasps that come from files, by name, and the names of these."""
        for name, grasp in self.grasps.items():
            if isinstance(grasp, str):
                yield name, grasp
            elif isinstance(grasp, FileSection):
                yield name, grasp.file


class TaskSection(Section):
    """Move one object to a pose; tasks are done in their order."""

    move: str
    """Name of the object."""
    to: PoseSection
    """Pose of the object's frame in the world at the end."""
    approach: Distance | None = None
    """Straight way of the tool along its z before the grasp, m; 0: none."""
    lift: Distance | None = None
    """Straight way up with the object after the grasp, m; 0: none."""
    lower: Distance | None = None
    """Straight way down with the object before the release, m; 0: none."""
    retreat: Distance | None = None
    """Straight way of the tool back along its z after the release, m; 0: none."""
    carry: CarrySection = CarrySection()
    """What holds while the object is in the hand."""


def _not_empty(tasks: tuple[TaskSection, ...]) -> tuple[TaskSection, ...]:
    if not tasks:
        raise fault("no tasks; expected at least one '- {move: ..., to: ...}'")
    return tasks


class SceneSection(Section):
    """A scene: a robot, obstacles, objects, and what is to be moved where."""

    mmplan: Annotated[
        int,
        version("scene", SCENE_VERSION),
        Field(json_schema_extra={"const": SCENE_VERSION}),
    ]
    """Version of the scene format: 1."""
    name: Name
    """Name of the scene."""
    description: Line = ""
    """One line that says what the scene is about."""
    robot: RobotSection
    """Which robot, where it starts, where it may go."""
    obstacles: dict[Name, ObstacleSection] = Field(default_factory=dict)
    """What must not be touched, by names of your choice."""
    objects: dict[Name, ObjectSection]
    """What can be moved, by names of your choice."""
    tasks: Annotated[
        tuple[TaskSection, ...],
        AfterValidator(_not_empty),
        Field(json_schema_extra={"minItems": 1}),
    ]
    """What is to be moved where, in this order."""
    score: ScoreSection = ScoreSection()
    """Weights of the score's terms."""
    optimizer: OptimizerSection = OptimizerSection()
    """What chooses the grasp and both base placements."""
    planner: PlannerSection = PlannerSection()
    """What finds the motion between the configurations chosen."""
