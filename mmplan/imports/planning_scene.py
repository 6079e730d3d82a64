"""PlanningScene messages of MoveIt as YAML, and the requests of MotionBenchMaker."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mmplan.exceptions import InputError
from mmplan.files.foreign_yaml import read_foreign_yaml
from mmplan.imports.foreign_scene import ForeignScene, Triangles, pose_of, primitive
from mmplan.imports.scene_text import is_scene_text, merged, read_scene_text
from mmplan.shapes import Array

# The numbers of shape_msgs/SolidPrimitive, which YAML may have in place of names.
_PRIMITIVES = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone"}
_OBJECT_KEYS = {
    "header",
    "id",
    "pose",
    "primitives",
    "primitive_poses",
    "meshes",
    "mesh_poses",
    "operation",
    "type",
}
_SCENE_KEYS = {"name", "world", "robot_model_name", "is_diff", "robot_state"}
_REQUEST_KEYS = {"start_state", "goal_constraints", "group_name"}


def read_moveit_scenes(files: Sequence[Path]) -> ForeignScene:
    """Read `.scene` texts and PlanningScene YAML files into one scene.

    Raises:
        InputError: A file is neither.
    """
    return merged(
        read_scene_text(f) if is_scene_text(f) else _read_yaml(f) for f in files
    )


def read_motionbenchmaker(files: Sequence[Path]) -> ForeignScene:
    """Read scene YAML files of MotionBenchMaker, and request files for the start.

    A request's goal is a configuration, which no task of mmplan can be.

    Raises:
        InputError: A file is neither.
    """
    return merged(_read_yaml(f) for f in files)


def _read_yaml(path: Path) -> ForeignScene:
    data = read_foreign_yaml(path)
    scene = ForeignScene(path.stem)
    if not isinstance(data, Mapping):
        raise InputError(f"{path}: is no mapping, as a PlanningScene is")
    if isinstance(data.get("world"), Mapping):
        _scene(data, scene, path)
    elif _REQUEST_KEYS & set(data):
        _request(data, scene, path)
    else:
        raise InputError(
            f"{path}: has neither 'world', as a PlanningScene has, nor 'start_state', "
            "as a request has"
        )
    return scene


def _scene(data: Mapping[str, Any], scene: ForeignScene, path: Path) -> None:
    scene.name = str(data.get("name") or scene.name)
    world = data["world"]
    for number, item in enumerate(world.get("collision_objects") or ()):
        _collision_object(item, scene, f"{path}: collision_objects[{number}]")
    _start(data.get("robot_state"), scene)
    ignored = [f"world.{k}" for k in set(world) - {"collision_objects"}]
    ignored += set(data) - _SCENE_KEYS
    scene.unsupported += [f"{path.name}: {key}" for key in sorted(ignored)]


def _request(data: Mapping[str, Any], scene: ForeignScene, path: Path) -> None:
    _start(data.get("start_state"), scene)
    if data.get("goal_constraints"):
        scene.unsupported.append(
            f"{path.name}: goal_constraints: tasks of mmplan move objects; give --move"
        )
    ignored = sorted(set(data) - _REQUEST_KEYS)
    scene.unsupported += [f"{path.name}: {key}" for key in ignored]


def _start(state: object, scene: ForeignScene) -> None:
    """Take joint positions of a RobotState; what is attached is named."""
    if not isinstance(state, Mapping):
        return
    joints = state.get("joint_state") or {}
    pairs = zip(joints.get("name") or (), joints.get("position") or (), strict=False)
    scene.start.update({str(name): float(value) for name, value in pairs})
    for item in state.get("attached_collision_objects") or ():
        name = (item.get("object") or {}).get("id", "?")
        scene.unsupported.append(f"robot_state: attached object '{name}'")


def _collision_object(item: Any, scene: ForeignScene, where: str) -> None:
    if not isinstance(item, Mapping) or not item.get("id"):
        raise InputError(f"{where}: expected a mapping with 'id'")
    name = str(item["id"])
    T = _pose(item.get("pose"), where)
    parts: list[tuple[Any, Array]] = []
    for kind, read in (("primitive", _primitive), ("mesh", _mesh)):
        plural = "meshes" if kind == "mesh" else "primitives"
        shapes, poses = item.get(plural) or (), item.get(f"{kind}_poses") or ()
        if poses and len(poses) != len(shapes):
            raise InputError(f"{where}: {len(shapes)} {plural}, {len(poses)} poses")
        for i, shape in enumerate(shapes):
            found = read(shape, scene, f"{where}.{plural}[{i}]")
            T_part = _pose(poses[i] if poses else None, f"{where}.{kind}_poses[{i}]")
            if found is not None:
                parts.append((found, T @ T_part))
    ignored = [k for k in item if k not in _OBJECT_KEYS and item[k]]
    scene.unsupported += [f"{name}: {key}" for key in ignored]
    scene.add(name, parts)


def _primitive(shape: Any, _: ForeignScene, where: str) -> dict[str, Any]:
    kind = shape.get("type") if isinstance(shape, Mapping) else None
    name = _PRIMITIVES.get(kind, kind) if isinstance(kind, int) else kind
    return primitive(str(name).lower(), shape.get("dimensions") or (), where)


def _mesh(shape: Any, scene: ForeignScene, where: str) -> Triangles | None:
    """The triangles of shape_msgs/Mesh; a mesh by the name of a file is named."""
    if "vertices" not in shape:
        scene.unsupported.append(f"{where}: mesh '{shape.get('resource', '?')}'")
        return None
    vertices = [list(_values(v)) for v in shape["vertices"]]
    triangles = [
        t.get("vertex_indices", t) if isinstance(t, Mapping) else t
        for t in shape.get("triangles") or ()
    ]
    return Triangles(np.array(vertices, dtype=np.float64).reshape(-1, 3), triangles)


def _pose(pose: Any, where: str) -> Array:
    if not pose:
        return np.eye(4)
    xyz = list(_values(pose.get("position") or (0.0, 0.0, 0.0)))
    turn = list(_values(pose.get("orientation") or (0.0, 0.0, 0.0, 1.0)))
    return pose_of(xyz, turn, where)


def _values(numbers: Any) -> Iterator[float]:
    """Numbers as a list has them, or the mapping of a message, in its order."""
    values = numbers
    if isinstance(numbers, Mapping):
        values = [numbers[axis] for axis in "xyzw" if axis in numbers]
    yield from (float(value) for value in values)
