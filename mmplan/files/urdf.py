"""What a URDF says by itself: joints, links, meshes. Plain XML, no model is built."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan.files.urdf_meshes import find_mesh

# A fixture's joints of other types stay where they are.
MOVING = ("revolute", "prismatic", "continuous")


class UrdfError(Exception):
    """A URDF that cannot be used; caught where the file is named."""


@dataclass(frozen=True)
class Mimic:
    """A joint follows another: its position is multiplier * leader + offset."""

    leader: str
    multiplier: float
    offset: float

    def position(self, leader: float) -> float:
        """The position that goes with one of the leader."""
        return self.multiplier * leader + self.offset


@dataclass(frozen=True)
class UrdfJoint:
    """A joint with one degree of freedom, and its position limits (rad or m).

    A joint without limits, such as a continuous one, has infinite ones.
    """

    name: str
    lower: float
    upper: float
    continuous: bool = False
    mimic: Mimic | None = None


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
    root = parse_urdf(path)
    return urdf_facts(root, mesh_files(root, path, package_dirs))


def parse_urdf(path: Path) -> ET.Element:
    """The root element of a URDF file.

    Raises:
        UrdfError: It is no URDF.
    """
    try:
        root = ET.parse(path).getroot()
    except ET.ParseError as error:
        raise UrdfError(f"'{path.name}' is not XML: {error}") from None
    except OSError as error:
        raise UrdfError(f"'{path}' cannot be read: {error.strerror}") from None
    if root.tag != "robot":
        raise UrdfError(f"'{path.name}' is no URDF: its root is <{root.tag}>")
    return root


def urdf_facts(root: ET.Element, meshes: Mapping[str, Path]) -> Urdf:
    """What a URDF says, given where its meshes are.

    Raises:
        UrdfError: A number in it is not one.
    """
    links = root.findall("link")
    moving = [j for j in root.findall("joint") if j.get("type") in MOVING]
    return Urdf(
        joints={j.name: j for j in map(_joint, moving)},
        links=tuple(link.get("name", "") for link in links),
        bodies=tuple(
            link.get("name", "") for link in links if link.find("collision") is not None
        ),
        meshes=meshes,
    )


def mesh_files(
    root: ET.Element, path: Path, package_dirs: Sequence[Path]
) -> dict[str, Path]:
    """The mesh files that a URDF names, which stands at `path`, by these names.

    Raises:
        UrdfError: A mesh is missing.
    """
    names = sorted({mesh.get("filename", "") for mesh in root.iter("mesh")})
    files = {name: find_mesh(name, path, package_dirs) for name in names}
    for name, file in files.items():
        if file is None:
            raise UrdfError(f"'{path.name}' needs a mesh that is missing: '{name}'")
    return {name: file for name, file in files.items() if file is not None}


def number_of(element: ET.Element, name: str, default: str = "0") -> float:
    """An attribute that is a number.

    Raises:
        UrdfError: It is none.
    """
    text = element.get(name, default)
    try:
        return float(text)
    except ValueError:
        message = f"expected a number for '{name}' of <{element.tag}>, got '{text}'"
        raise UrdfError(message) from None


def _joint(element: ET.Element) -> UrdfJoint:
    limit = element.find("limit")
    continuous = element.get("type") == "continuous"
    bounds = (-math.inf, math.inf)
    if limit is not None and not continuous:
        bounds = (number_of(limit, "lower"), number_of(limit, "upper"))
    return UrdfJoint(
        element.get("name", ""), *bounds, continuous, _mimic(element.find("mimic"))
    )


def _mimic(element: ET.Element | None) -> Mimic | None:
    if element is None:
        return None
    multiplier = number_of(element, "multiplier", "1")
    return Mimic(element.get("joint", ""), multiplier, number_of(element, "offset"))
