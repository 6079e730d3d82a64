"""Faults of a scene that show only across its sections, or against its robot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mmplan.assets import is_file
from mmplan.files.document import Document, Fault, KeyPath
from mmplan.files.robot_checks import joint_value_faults
from mmplan.files.suggestions import unknown
from mmplan.files.urdf import Urdf, UrdfError, read_urdf

HAND_STATES = ("open", "closed")


@dataclass(frozen=True)
class RobotFacts:
    """What a scene is checked against: groups of joints and named configurations."""

    urdf: Urdf
    base: Sequence[str]
    arm: Sequence[str]
    hand: Sequence[str]
    configurations: Mapping[str, tuple[float, ...]]


def scene_faults(document: Document) -> Iterator[Fault]:
    """The faults that need no robot.

    Works on the document, so that one malformed section hides no fault of another.
    """
    yield from _names_taken_twice(document)
    yield from _task_faults(document)
    for name in document.keys("obstacles"):
        yield from _fixture_faults(document, ("obstacles", name))


def start_faults(document: Document, robot: RobotFacts) -> Iterator[Fault]:
    """The faults of the start and of names, given the robot."""
    start: KeyPath = ("robot", "start")
    yield from _base_faults(document, robot.base)
    named = {"arm": robot.configurations, "hand": HAND_STATES, "base": ()}
    joints = {"arm": robot.arm, "hand": robot.hand, "base": robot.base}
    for group, names in named.items():
        path = (*start, group)
        value = document.get(*path)
        if isinstance(value, str) and group != "base" and value not in names:
            yield Fault(path, unknown("configuration", value, names))
        if isinstance(value, tuple) and joints[group]:
            for fault in joint_value_faults(value, joints[group], robot.urdf):
                yield fault._replace(path=path + fault.path)
    for section in ("obstacles", "objects"):
        for name in set(document.keys(section)) & set(robot.urdf.bodies):
            message = f"'{name}' is the name of a link of the robot; choose another"
            yield Fault((section, name), message, at_key=True)


def _base_faults(document: Document, base: Sequence[str]) -> Iterator[Fault]:
    """A start without the base that the robot has, or with one that it lacks."""
    start: KeyPath = ("robot", "start")
    given = document.get(*start, "base")
    if base and given is None and isinstance(document.get(*start), dict):
        message = f"missing key 'base': one number for each of {', '.join(base)}"
        yield Fault(start, message, at_key=True)
    if not base and given:
        message = "the robot has no mobile base; robot.at says where it stands"
        yield Fault((*start, "base"), message)
    if base and document.get("robot", "at") is not None:
        message = "goes with robots without a mobile base; robot.start.base says where"
        yield Fault(("robot", "at"), f"{message} this one starts", at_key=True)


def _names_taken_twice(document: Document) -> Iterator[Fault]:
    obstacles = document.keys("obstacles")
    for name in document.keys("objects"):
        if name in obstacles:
            message = f"'{name}' is also the name of an obstacle; choose another"
            yield Fault(("objects", name), message, at_key=True)


def _task_faults(document: Document) -> Iterator[Fault]:
    tasks = document.get("tasks")
    objects = document.keys("objects")
    moved = set()
    for i in range(len(tasks) if isinstance(tasks, tuple) else 0):
        name = document.get("tasks", i, "move")
        if not isinstance(name, str):
            continue
        moved.add(name)
        if name not in objects and isinstance(document.get("objects"), dict):
            yield Fault(("tasks", i, "move"), unknown("object", name, objects))
    for name in objects:
        path: KeyPath = ("objects", name, "grasps")
        if name in moved and document.get(*path) == {}:
            message = f"'{name}' is to be moved and has no grasps; give it some, or"
            message += " leave the key out for those of its shape"
            yield Fault(path, message, at_key=True)


def _fixture_faults(document: Document, path: KeyPath) -> Iterator[Fault]:
    """Faults of an obstacle's URDF, and of its configuration against that."""
    name = document.get(*path, "urdf")
    if not isinstance(name, str):
        return
    file = document.path.parent / name
    if not is_file(file):
        return
    try:
        urdf = read_urdf(file, package_folders(file))
    except UrdfError as error:
        yield Fault((*path, "urdf"), str(error))
        return
    for joint in document.keys(*path, "configuration"):
        yield from _joint_faults(document, (*path, "configuration", joint), urdf)


def _joint_faults(document: Document, path: KeyPath, urdf: Urdf) -> Iterator[Fault]:
    joint = str(path[-1])
    if joint not in urdf.joints:
        yield Fault(path, unknown("joint", joint, urdf.joints), at_key=True)
    else:
        for fault in joint_value_faults((document.get(*path),), [joint], urdf):
            yield fault._replace(path=path)


def package_folders(urdf: Path) -> tuple[Path, ...]:
    """The folders in which `package://` names of a URDF are looked up."""
    here = urdf.resolve().parent
    return (here, here.parent)
