"""The plan file: its format as pydantic models, its text, its faults by key path."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    AwareDatetime,
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)

from mmplan.exceptions import Diagnostic, InputError

FORMAT_VERSION = 1
# More faults of one file than this are only counted.
_MOST_FAULTS = 20

Number = Annotated[float, Field(allow_inf_nan=False)]
Vector = list[Number]


def _rigid(rows: list[Vector]) -> list[Vector]:
    T = np.array(rows)
    R = T[:3, :3]
    turned = np.allclose(R @ R.T, np.eye(3), atol=1e-6) and np.linalg.det(R) > 0
    if not (turned and np.array_equal(T[3], [0.0, 0.0, 0.0, 1.0])):
        raise ValueError("not a pose: rotation and translation over a row 0 0 0 1")
    return rows


Row = Annotated[Vector, Field(min_length=4, max_length=4)]
Pose = Annotated[list[Row], Field(min_length=4, max_length=4), AfterValidator(_rigid)]


class _Model(BaseModel):
    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, use_attribute_docstrings=True
    )


class SegmentFile(_Model):
    """One motion from rest to rest, a cubic Hermite curve through its samples."""

    name: Annotated[str, Field(min_length=1)]
    """transit, approach, grasp, lift, transfer, lower, release or retreat."""
    times: Annotated[Vector, Field(min_length=2)]
    """Seconds from the segment's start, strictly increasing from 0."""
    positions: list[Vector]
    """A row a time: one number a joint, in the order of robot.joints, rad or m."""
    velocities: list[Vector]
    """As positions, rad/s or m/s."""
    attached: dict[str, Pose]
    """T_tool_object of the objects that the tool carries in this segment."""
    objects: dict[str, Pose]
    """T_world_object of every object at the segment's start."""

    @model_validator(mode="after")
    def _rows_match_times(self) -> SegmentFile:
        for key in ("positions", "velocities"):
            rows = len(getattr(self, key))
            if rows != len(self.times):
                raise ValueError(f"{rows} rows of {key} for {len(self.times)} times")
        return self


class GraspFile(_Model):
    """How the hand holds the object."""

    name: str
    """The grasp's name in the scene."""
    genes: Vector
    """What determines the grasp within its family."""
    T_object_tool: Pose
    hand_open: Vector
    """The hand's joints before grasping and after releasing, m or rad."""
    hand_closed: Vector
    """The hand's joints while it holds the object, m or rad."""


class TaskEndFile(_Model):
    """Where the robot stands at one end of a task, and how good that is."""

    base: Vector
    """The base's joints, m or rad."""
    scores: dict[str, Number]
    """Terms of the score by name."""


class TaskFile(_Model):
    """One object moved to its goal."""

    object: str
    grasp: GraspFile
    start: TaskEndFile
    goal: TaskEndFile
    segments: Annotated[list[SegmentFile], Field(min_length=1)]


class SceneFile(_Model):
    """The scene that the plan was made for."""

    name: str
    path: str | None
    """The scene file, relative to the plan's folder; null if it was not a file."""
    fingerprint: str
    """SHA-256 over the scene and the files that it uses."""


class RobotFile(_Model):
    """The robot that the plan moves."""

    name: str
    joints: Annotated[list[str], Field(min_length=1)]
    """The order of the numbers in a row of positions or velocities."""
    tool: str
    """The frame (link) of the URDF that carries objects."""


class FaultFile(_Model):
    """Something that the plan does not hold."""

    kind: str
    message: str


class ClearanceFile(_Model):
    """The smallest distance found between two things that must stay apart."""

    distance: Number
    """m"""
    task: Annotated[int, Field(ge=0)]
    """Index into tasks."""
    segment: str
    time: Number
    """Seconds from the segment's start."""
    first: str
    second: str


class PeakFile(_Model):
    """The largest value of what a rule limits."""

    rule: str
    """tilt (rad), tool_speed (m/s) or torque (as a share of its limit)."""
    limit: Number
    largest: Number
    proven: Number | None
    """Never exceeded; null where the limit is not kept, and for torques."""
    task: Annotated[int, Field(ge=0)]
    """Index into tasks."""
    segment: str
    time: Number
    """Seconds from the segment's start."""


class ReportFile(_Model):
    """What the verification found."""

    ok: bool
    faults: list[FaultFile]
    clearance: ClearanceFile | None
    proven: Number
    """m: nothing that must stay apart ever comes nearer than this."""
    queries: Annotated[int, Field(ge=0)]
    """Exact distance computations."""
    intervals: Annotated[int, Field(ge=0)]
    """Stretches of time looked at."""
    peaks: list[PeakFile] = []
    """Of every rule beside collisions of every task."""


class PlanFile(_Model):
    """A plan of mmplan. Metres, radians, seconds; poses are 4 x 4, row by row."""

    mmplan_plan: Literal[1]
    """Version of this format."""
    created: AwareDatetime
    """When the plan was made: the only content that one seed does not determine."""
    versions: dict[str, str]
    """mmplan, Python and the libraries that the plan depends on."""
    seed: int
    scene: SceneFile
    robot: RobotFile
    duration: Number
    """Seconds, all segments together."""
    tasks: Annotated[list[TaskFile], Field(min_length=1)]
    verification: ReportFile | None

    @model_validator(mode="after")
    def _rows_match_joints(self) -> PlanFile:
        joints = len(self.robot.joints)
        for t, task in enumerate(self.tasks):
            for s, segment in enumerate(task.segments):
                for key in ("positions", "velocities"):
                    for r, row in enumerate(getattr(segment, key)):
                        if len(row) != joints:
                            place = f"tasks[{t}].segments[{s}].{key}[{r}]"
                            raise ValueError(
                                f"{place}: {len(row)} numbers for {joints} joints"
                            )
        return self


def plan_schema() -> dict[str, Any]:
    """The JSON schema of a plan file."""
    schema = PlanFile.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def read_plan_file(path: Path) -> PlanFile:
    """Read and validate a plan file.

    Raises:
        InputError: naming the file and the key path of every fault.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise InputError(f"{path}: cannot be read: {reason}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file (UTF-8)") from error
    return parse_plan(text, str(path))


def parse_plan(text: str, file: str) -> PlanFile:
    """Validate the text of a plan file; `file` is its name in errors.

    Raises:
        InputError: naming the file and the key path of every fault.
    """
    try:
        return PlanFile.model_validate_json(text)
    except ValidationError as error:
        faults: list[Any] = error.errors(include_url=False, include_context=False)
    if faults[0]["type"] == "json_invalid":
        raise InputError(_syntax_fault(text, file, faults[0]["msg"]))
    for fault in faults:
        if fault["loc"] == ("mmplan_plan",):
            raise InputError(Diagnostic(_version_fault(fault), file))
    messages = [_message(fault) for fault in faults[:_MOST_FAULTS]]
    if len(faults) > _MOST_FAULTS:
        messages.append(f"and {len(faults) - _MOST_FAULTS} more faults")
    raise InputError(*(Diagnostic(message, file) for message in messages))


def plan_text(value: Any, depth: int = 0) -> str:
    """JSON with one line a key and one line a row of numbers.

    Numbers are written so that they read back as exactly the same.
    """
    children = value.values() if isinstance(value, dict) else value
    plain = not isinstance(value, dict | list)
    if plain or not any(isinstance(child, dict | list) for child in children):
        return json.dumps(value, ensure_ascii=False)
    pad = " " * (depth + 1)
    if isinstance(value, dict):
        lines = [
            f"{pad}{json.dumps(key, ensure_ascii=False)}: {plan_text(child, depth + 1)}"
            for key, child in value.items()
        ]
        return "{\n" + ",\n".join(lines) + "\n" + pad[1:] + "}"
    lines = [pad + plan_text(child, depth + 1) for child in value]
    return "[\n" + ",\n".join(lines) + "\n" + pad[1:] + "]"


def _syntax_fault(text: str, file: str, message: str) -> Diagnostic:
    """Where and why the text is not JSON."""
    if not text.strip():
        return Diagnostic("the file is empty; expected a plan of mmplan", file)
    try:
        json.loads(text)
    except json.JSONDecodeError as error:
        reason = f"not JSON: {error.msg}"
        return Diagnostic(reason, file, error.lineno, error.colno)
    except RecursionError:
        return Diagnostic("not a plan of mmplan: nested too deeply", file)
    return Diagnostic(message, file)


def _version_fault(fault: dict[str, Any]) -> str:
    if fault["type"] == "missing":
        return "not a plan of mmplan: no key 'mmplan_plan'"
    return (
        f"mmplan_plan: format version {fault['input']!r} is not known; "
        f"this mmplan reads version {FORMAT_VERSION}"
    )


def _message(fault: dict[str, Any]) -> str:
    """`tasks[0].segments[2].times[5]: what is wrong`."""
    place = "".join(
        f"[{part}]" if isinstance(part, int) else f".{part}" for part in fault["loc"]
    ).lstrip(".")
    message = fault["msg"].removeprefix("Value error, ")
    if fault["type"] in ("finite_number", "float_type"):
        message += f", not {fault['input']!r}"
    return f"{place}: {message}" if place else message
