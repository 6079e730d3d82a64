"""A scene of another program as a scene file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mmplan.exceptions import InputError
from mmplan.files.suggestions import unknown
from mmplan.files.yaml_writer import yaml_text
from mmplan.imports.foreign_scene import ForeignScene, ForeignThing, Triangles
from mmplan.robot_file import RobotDescription
from mmplan.shapes import Array
from mmplan.visualization.rotations import pose_numbers

_DIGITS = 9  # of lengths and quaternions, as they are written
_REACH = 1.0  # m, of a robot that does not say it
_MARGIN = 2.0  # m, of the floor around all that is imported
_FLOOR_THICKNESS = 0.1  # m
_TASK = """There is no task yet: an obstacle that is to be moved goes to 'objects', and

    tasks:
      - {move: NAME, to: {xyz: [x, y, z]}}"""


@dataclass(frozen=True)
class TaskWish:
    """Which thing is to be moved, and where: x, y, z, and roll, pitch, yaw."""

    move: str
    to: tuple[float, ...]


@dataclass(frozen=True)
class Wishes:
    """What another program's scene does not say: the robot, its place, the task.

    `base` is where the base starts; None: outside of all that is imported, on the side
    of negative x.
    """

    robot: RobotDescription
    model: str  # the robot as the scene file names it
    base: tuple[float, ...] | None = None
    task: TaskWish | None = None


def scene_text(scene: ForeignScene, wishes: Wishes) -> tuple[str, dict[Path, str]]:
    """The scene file, and the mesh files that are to stand beside it.

    What has no place in the scene is added to `scene.unsupported`. Without a task the
    file ends in a comment that says what to add before it can be solved.

    Raises:
        InputError: The thing that is to be moved is not there, or cannot be.
    """
    title = _identifier(scene.name)
    meshes: dict[Path, str] = {}
    entries = {
        name: _entry(thing, name, title, meshes)
        for thing, name in zip(scene.things, _names(scene.things), strict=True)
    }
    data: dict[str, Any] = {
        "mmplan": 1,
        "name": title,
        "robot": _robot(scene, wishes),
    }
    objects, tasks = _task(entries, wishes.task)
    floor = {} if any(t.ground for t in scene.things) else {"floor": _floor(scene)}
    data["obstacles"] = {**floor, **entries}
    comment = f"Imported from {scene.name}."
    if wishes.task is None:
        comment += f"\n{_TASK}"
        scene.unsupported.append("there is no task; the file says what to add")
        return yaml_text(data, comment), meshes
    data.update(objects=objects, tasks=tasks)
    return yaml_text(data, comment), meshes


def _names(things: Sequence[ForeignThing]) -> Iterator[str]:
    """A name for each thing that a scene file takes, no two alike."""
    taken: set[str] = set() if any(t.ground for t in things) else {"floor"}
    for thing in things:
        name = base = _identifier(thing.name)
        number = 2
        while name in taken:
            name, number = f"{base}_{number}", number + 1
        taken.add(name)
        yield name


def _identifier(text: str) -> str:
    name = re.sub(r"[^A-Za-z0-9_-]", "_", text) or "scene"
    return name if name[0].isalpha() else f"o{name}"


def _entry(
    thing: ForeignThing, name: str, scene: str, meshes: dict[Path, str]
) -> dict[str, Any]:
    entry: dict[str, Any]
    if isinstance(thing.shape, Triangles):
        file = Path(f"{scene}_meshes") / f"{name}.obj"
        meshes[file] = _obj(thing.shape)
        entry = {"mesh": file.as_posix()}
    else:
        entry = dict(thing.shape)
    if thing.ground:
        entry["ground"] = True
    return {**entry, "at": _pose(thing.T_world_thing)}


def _obj(mesh: Triangles) -> str:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.triangles]
    return "\n".join([*lines, ""])


def _pose(T: Array) -> dict[str, Any]:
    (numbers,) = np.round(pose_numbers(T[None]), _DIGITS) + 0.0
    pose: dict[str, Any] = {"xyz": numbers[:3].tolist()}
    if not np.allclose(T[:3, :3], np.eye(3), atol=1e-12):
        pose["quat"] = numbers[3:].tolist()
    return pose


def _robot(scene: ForeignScene, wishes: Wishes) -> dict[str, Any]:
    """The robot's section; a start is taken over where it names all of its arm."""
    robot = wishes.robot
    start: dict[str, Any] = {}
    if robot.base_joints:
        start["base"] = list(wishes.base or _outside(scene, robot))
    missing = [name for name in robot.arm_joints if name not in scene.start]
    if scene.start and not missing:
        start["arm"] = [scene.start[name] for name in robot.arm_joints]
    else:
        start["arm"] = next(iter(robot.configurations))
    if scene.start and missing:
        scene.unsupported.append(
            f"the start of {', '.join(scene.start)}: the arm of {robot.name} has other "
            "joints"
        )
    return {"model": wishes.model, "start": start}


def _outside(scene: ForeignScene, robot: RobotDescription) -> Iterator[float]:
    """Where the base starts: before all that is imported, looking at it."""
    x, y = _middles(scene)
    away = (robot.reach or _REACH) + _MARGIN / 2
    yield round(float(x.min()) - away, 3)
    yield round(float(y.mean()), 3)
    yield from [0.0] * (len(robot.base_joints) - 2)


def _floor(scene: ForeignScene) -> dict[str, Any]:
    """A floor at height 0 below all things and about them."""
    x, y = _middles(scene)
    edge = [float(np.ptp(v)) + 6.0 * _MARGIN for v in (x, y)]
    at = [float(v.min() + v.max()) / 2 for v in (x, y)]
    box = [round(v, 3) for v in (*edge, _FLOOR_THICKNESS)]
    xyz = [round(v, 3) for v in (*at, -_FLOOR_THICKNESS / 2)]
    return {"box": box, "at": {"xyz": xyz}, "ground": True}


def _middles(scene: ForeignScene) -> tuple[Array, Array]:
    """The x and y of the origins of all things."""
    origins = [t.T_world_thing[:2, 3] for t in scene.things] or [np.zeros(2)]
    x, y = np.array(origins).T
    return x, y


def _task(
    entries: dict[str, Any], wish: TaskWish | None
) -> tuple[Mapping[str, Any], Sequence[Mapping[str, Any]]]:
    """The sections `objects` and `tasks`; what is moved leaves the obstacles."""
    if wish is None:
        return {}, ()
    if wish.move not in entries:
        raise InputError(f"--move: {unknown('thing', wish.move, tuple(entries))}")
    item = entries.pop(wish.move)
    if "urdf" in item or item.get("ground"):
        raise InputError(f"--move: '{wish.move}' is a fixture or the ground")
    to: dict[str, Any] = {"xyz": list(wish.to[:3])}
    if any(wish.to[3:]):
        to["rpy"] = list(wish.to[3:])
    elif "quat" in item["at"] and len(wish.to) == 3:
        to["quat"] = item["at"]["quat"]
    return {wish.move: item}, [{"move": wish.move, "to": to}]
