"""The files that a robot.yaml names, found and read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import get_args
from xml.etree import ElementTree as ET

from mmplan import assets
from mmplan.exceptions import Diagnostic, InputError
from mmplan.files.document import Document, Fault, KeyPath
from mmplan.files.located_xml import read_xml
from mmplan.files.robot_parts import JointType
from mmplan.files.suggestions import unknown
from mmplan.files.urdf import Urdf, mesh_files, urdf_facts
from mmplan.files.urdf_faults import urdf_faults
from mmplan.files.urdf_meshes import find_mesh


@dataclass(frozen=True, eq=False)
class UrdfFile:
    """A URDF and where its meshes are, by the names in it."""

    path: Path
    root: ET.Element
    meshes: Mapping[str, Path]


@dataclass(frozen=True, eq=False)
class RobotSources:
    """The URDF of a robot, that of a hand fixed to it, and an SRDF, if they are named.

    `pieces` are convex meshes that links collide with, by link, in the link's frame.
    Where a file is at fault the others are there nevertheless. `faults` are those
    inside of URDFs, with their places there.
    """

    urdf: UrdfFile | None = None
    hand: UrdfFile | None = None
    srdf: Path | None = None
    pieces: Mapping[str, tuple[Path, ...]] = field(default_factory=dict)
    faults: tuple[Diagnostic, ...] = ()

    @property
    def facts(self) -> tuple[Urdf, ...]:
        """What the URDFs say."""
        found = (file for file in (self.urdf, self.hand) if file is not None)
        return tuple(urdf_facts(file.root, file.meshes) for file in found)

    def files(self) -> Iterator[tuple[str, Path]]:
        """Every file by the role that it plays."""
        for role, file in (("robot urdf", self.urdf), ("hand urdf", self.hand)):
            if file is not None:
                yield role, file.path
                yield from ((f"{role} {n}", path) for n, path in file.meshes.items())
        if self.srdf is not None:
            yield "robot srdf", self.srdf
        for link, files in self.pieces.items():
            yield from ((f"piece of {link} {file.name}", file) for file in files)


def robot_sources(document: Document) -> tuple[RobotSources, tuple[Fault, ...]]:
    """The files that a robot.yaml names, and what is wrong with them.

    Names that are no names or of no file beside the robot.yaml are left to the
    validation of its sections.
    """
    faults: list[Fault] = []
    within: list[Diagnostic] = []
    urdf = _urdf(document, ("urdf",), faults, within)
    hand = _urdf(document, ("hand", "urdf"), faults, within)
    srdf = _location(document, ("srdf",), faults)
    roots = [file.root for file in (urdf, hand) if file is not None]
    joints = [j.get("name", "") for root in roots for j in root.findall("joint")]
    for name in document.keys("types"):
        if name not in joints and urdf is not None:
            message = unknown("joint", name, joints)
            faults.append(Fault(("types", name), message, at_key=True))
    path = srdf[0] if srdf else None
    pieces = _pieces(document, faults)
    return RobotSources(urdf, hand, path, pieces, tuple(within)), tuple(faults)


def _urdf(
    document: Document, key: KeyPath, faults: list[Fault], within: list[Diagnostic]
) -> UrdfFile | None:
    location = _location(document, key, faults)
    if location is None:
        return None
    path, package_dirs = location
    try:
        xml = read_xml(path)
    except InputError as error:
        within += error.diagnostics
        return None
    _change_types(xml.root, document)
    if found := urdf_faults(xml, package_dirs):
        within += found
        return None
    _leave_out_unseen(xml.root, path, package_dirs)
    return UrdfFile(path, xml.root, mesh_files(xml.root, path, package_dirs))


def _leave_out_unseen(
    root: ET.Element, path: Path, package_dirs: tuple[Path, ...]
) -> None:
    """Remove what is only shown where its mesh is missing: plans need no looks."""
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            name = "" if mesh is None else mesh.get("filename", "")
            if name and find_mesh(name, path, package_dirs) is None:
                link.remove(visual)


def _change_types(root: ET.Element, document: Document) -> None:
    """Give joints the types that the robot.yaml says."""
    for joint in root.findall("joint"):
        kind = document.get("types", joint.get("name", ""))
        if isinstance(kind, str) and kind in get_args(JointType):
            joint.set("type", kind)


def pieces_folder(robot: Path, link: str) -> Path:
    """Where the pieces of a link that is `decomposed` are kept, for a robot.yaml."""
    return robot.parent / "collision" / link


def _pieces(document: Document, faults: list[Fault]) -> dict[str, tuple[Path, ...]]:
    found = {}
    for link in document.keys("collision"):
        if document.get("collision", link) == "decomposed":
            folder = pieces_folder(document.path.resolve(), link)
            found[link] = tuple(sorted(folder.glob("*.obj")))
            if not found[link]:
                message = f"no pieces (*.obj) in {folder}"
                hint = "'mmplan robot import' makes them"
                faults.append(Fault(("collision", link), f"{message}; {hint}"))
    return found


def _location(
    document: Document, key: KeyPath, faults: list[Fault]
) -> tuple[Path, tuple[Path, ...]] | None:
    """A file and the folders of its packages; None where it is not there."""
    here = document.path.parent.resolve()
    name = document.get(*key)
    if isinstance(name, str) and assets.is_file(here / name):
        return here / name, (here, here.parent)
    example = document.get(*key, "example_robot_data")
    if not isinstance(example, str):
        return None
    share = assets.example_robots()
    path = (*key, "example_robot_data")
    if share is None:
        message = "needs example-robot-data: pip install 'mmplan[robots]'"
        faults.append(Fault(path, message))
        return None
    folder = share / "example-robot-data" / "robots"
    if not assets.is_file(folder / example):
        faults.append(Fault(path, f"no such file in {folder}: '{example}'"))
        return None
    return folder / example, (share,)
