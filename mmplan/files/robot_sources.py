"""The files that a robot.yaml names, found and read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan import assets
from mmplan.files.document import Document, Fault, KeyPath
from mmplan.files.urdf import Urdf, UrdfError, mesh_files, parse_urdf, urdf_facts


@dataclass(frozen=True, eq=False)
class UrdfFile:
    """A URDF and where its meshes are, by the names in it."""

    path: Path
    root: ET.Element
    meshes: Mapping[str, Path]


@dataclass(frozen=True, eq=False)
class RobotSources:
    """The URDF of a robot, that of a hand fixed to it, and an SRDF, if they are named.

    Where a file is at fault the others are there nevertheless.
    """

    urdf: UrdfFile | None = None
    hand: UrdfFile | None = None
    srdf: Path | None = None

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


def robot_sources(document: Document) -> tuple[RobotSources, tuple[Fault, ...]]:
    """The files that a robot.yaml names, and what is wrong with them.

    Names that are no names or of no file beside the robot.yaml are left to the
    validation of its sections.
    """
    faults: list[Fault] = []
    urdf = _urdf(document, ("urdf",), faults)
    hand = _urdf(document, ("hand", "urdf"), faults)
    srdf = _location(document, ("srdf",), faults)
    sources = RobotSources(urdf, hand, srdf[0] if srdf else None)
    return sources, tuple(faults)


def _urdf(document: Document, key: KeyPath, faults: list[Fault]) -> UrdfFile | None:
    location = _location(document, key, faults)
    if location is None:
        return None
    path, package_dirs = location
    try:
        root = parse_urdf(path)
        file = UrdfFile(path, root, mesh_files(root, path, package_dirs))
        urdf_facts(file.root, file.meshes)
    except UrdfError as error:
        faults.append(Fault(key, str(error)))
        return None
    return file


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
