"""What a URDF says by itself: joints, links, meshes. Plain XML, no model is built."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

# A fixture's joints of other types stay where they are.
MOVING = ("revolute", "prismatic", "continuous")


class UrdfError(Exception):
    """A URDF that cannot be used; caught where the file is named."""


@dataclass(frozen=True)
class UrdfJoint:
    """A joint with one degree of freedom, and its position limits (rad or m)."""

    name: str
    lower: float
    upper: float


@dataclass(frozen=True)
class Urdf:
    """The joints that move, the links, and the mesh files by the names in the URDF.

    `bodies` are the links that can collide.
    """

    joints: Mapping[str, UrdfJoint]
    links: tuple[str, ...]
    bodies: tuple[str, ...]
    meshes: Mapping[str, Path]


def read_urdf(path: Path, package_dirs: Sequence[Path] = ()) -> Urdf:
    """Read a URDF file; `package://` names are looked up in `package_dirs`.

    Raises:
        UrdfError: It is no URDF, or a mesh that it names is missing.
    """
    try:
        root = ET.parse(path).getroot()
    except ET.ParseError as error:
        raise UrdfError(f"'{path.name}' is not XML: {error}") from None
    except OSError as error:
        raise UrdfError(f"'{path}' cannot be read: {error.strerror}") from None
    if root.tag != "robot":
        raise UrdfError(f"'{path.name}' is no URDF: its root is <{root.tag}>")
    links = root.findall("link")
    folders = (path.parent, *package_dirs)
    names = {mesh.get("filename", "") for mesh in root.iter("mesh")}
    return Urdf(
        joints={j.name: j for j in map(_joint, _moving(root))},
        links=tuple(link.get("name", "") for link in links),
        bodies=tuple(
            link.get("name", "") for link in links if link.find("collision") is not None
        ),
        meshes={name: _mesh_path(path, name, folders) for name in sorted(names)},
    )


def _moving(root: ET.Element) -> list[ET.Element]:
    return [j for j in root.findall("joint") if j.get("type") in MOVING]


def _joint(element: ET.Element) -> UrdfJoint:
    limit = element.find("limit")
    bounds = (-math.inf, math.inf)
    if limit is not None and element.get("type") != "continuous":
        bounds = (_number(limit, "lower"), _number(limit, "upper"))
    return UrdfJoint(element.get("name", ""), *bounds)


def _number(element: ET.Element, name: str) -> float:
    text = element.get(name, "0")
    try:
        return float(text)
    except ValueError:
        message = f"expected a number for '{name}' of <{element.tag}>, got '{text}'"
        raise UrdfError(message) from None


def _mesh_path(urdf: Path, name: str, folders: Sequence[Path]) -> Path:
    relative = name.removeprefix("package://").removeprefix("file://")
    for folder in folders:
        path = folder / relative
        if path.is_file():
            return path
    raise UrdfError(f"'{urdf.name}' needs a mesh that is missing: '{name}'")
