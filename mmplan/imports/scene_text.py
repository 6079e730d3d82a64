"""MoveIt's text format for scenes, `.scene`, in both of its forms."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mmplan.exceptions import Diagnostic, InputError
from mmplan.imports.foreign_scene import ForeignScene, Triangles, pose_of, primitive
from mmplan.shapes import Array


def read_scene_text(path: Path) -> ForeignScene:
    """Read a `.scene` file.

    Each object has a pose of its own in the newer form; in the older one the poses of
    its shapes are in the world. Which it is shows in the line after the object's name,
    as in MoveIt itself.

    Raises:
        InputError: Naming the line at which it is no such file.
    """
    lines = _Lines(path)
    scene = ForeignScene(lines.next("the scene's name") or path.stem)
    while (line := lines.next("'* NAME' or '.'")) != ".":
        if not line.startswith("*"):
            raise lines.fault(f"expected '* NAME' or '.', got '{line}'")
        _object(lines, line[1:].strip(), scene)
    return scene


class _Lines:
    """The lines of a file that are not empty, with their numbers."""

    def __init__(self, path: Path) -> None:
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            raise InputError(f"{path}: is not a text file") from None
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from None
        self._path = path
        self._all = text.splitlines()
        self._at = 0

    def next(self, wanted: str) -> str:
        while self._at < len(self._all):
            self._at += 1
            line = self._all[self._at - 1].strip()
            if line:
                return line
        raise self.fault(f"the file ends where {wanted} should be")

    def numbers(self, count: int, wanted: str) -> list[float]:
        words = self.next(wanted).split()
        try:
            values = [float(word) for word in words]
        except ValueError:
            values = []
        if len(values) != count or not np.isfinite(values).all():
            message = f"expected {wanted}, {count} numbers, got '{' '.join(words)}'"
            raise self.fault(message)
        return values

    def count(self, wanted: str) -> int:
        (value,) = self.numbers(1, wanted)
        if value != int(value) or value < 0:
            raise self.fault(f"expected {wanted}, got {value:g}")
        return int(value)

    def peek(self) -> str:
        at = self._at
        line = self.next("an object")
        self._at = at
        return line

    def fault(self, message: str) -> InputError:
        return InputError(Diagnostic(message, str(self._path), self._at))

    @property
    def place(self) -> str:
        return f"{self._path}:{self._at}"


def _object(lines: _Lines, name: str, scene: ForeignScene) -> None:
    newer = " " in lines.peek()
    T_world_object = _pose(lines) if newer else np.eye(4)
    parts = []
    for _ in range(lines.count("the number of shapes")):
        shape = _shape(lines, name, scene)
        T_object_shape = _pose(lines)
        lines.numbers(4, "a colour")
        if shape is not None:
            parts.append((shape, T_world_object @ T_object_shape))
    if newer:
        for _ in range(lines.count("the number of subframes")):
            frame = lines.next("the name of a subframe")
            _pose(lines)
            scene.unsupported.append(f"{name}: subframe '{frame}'")
    scene.add(name, parts)


def _shape(
    lines: _Lines, name: str, scene: ForeignScene
) -> dict[str, object] | Triangles | None:
    kind = lines.next("a shape")
    if kind == "mesh":
        return _mesh(lines)
    if kind == "plane":
        lines.numbers(4, "the four numbers of a plane")
        scene.unsupported.append(f"{name}: a plane; give the scene a floor instead")
        return None
    sizes = lines.numbers(
        {"box": 3, "sphere": 1}.get(kind, 2), f"the sizes of a {kind}"
    )
    # This format has the radius first, shape_msgs the length.
    return primitive(kind, sizes[::-1] if len(sizes) == 2 else sizes, lines.place)


def _mesh(lines: _Lines) -> Triangles:
    corners, faces = map(int, lines.numbers(2, "the numbers of vertices and triangles"))
    vertices = [lines.numbers(3, "a vertex") for _ in range(corners)]
    triangles = [list(map(int, lines.numbers(3, "a triangle"))) for _ in range(faces)]
    if any(not 0 <= i < corners for t in triangles for i in t):
        raise lines.fault(f"a triangle has a vertex that is none of {corners}")
    return Triangles(np.array(vertices).reshape(-1, 3), triangles)


def _pose(lines: _Lines) -> Array:
    xyz = lines.numbers(3, "a position")
    return pose_of(xyz, lines.numbers(4, "a quaternion"), lines.place)


def is_scene_text(path: Path) -> bool:
    """Whether a file is named as such a text."""
    return path.suffix == ".scene"


def merged(scenes: Iterator[ForeignScene]) -> ForeignScene:
    """All scenes as one, named as the first."""
    first = next(scenes)
    for scene in scenes:
        first.things += scene.things
        first.start.update(scene.start)
        first.unsupported += scene.unsupported
    return first
