"""The files that an imported robot is made of: taken over, or named where they are."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan import assets
from mmplan.exceptions import InputError
from mmplan.files.located_xml import LocatedXml, read_xml
from mmplan.files.urdf_faults import unresolved_visuals, urdf_faults
from mmplan.files.urdf_meshes import PACKAGE, find_mesh


def read_urdf(path: Path, package_dirs: Sequence[Path]) -> LocatedXml:
    """A URDF that a robot can be made of.

    Raises:
        InputError: It has faults; each is named.
    """
    xml = read_xml(path)
    if faults := urdf_faults(xml, package_dirs):
        raise InputError(*faults)
    return xml


def in_wheel(urdf: Path) -> Path | None:
    """The path of a URDF of example-robot-data inside its folder of robots."""
    share = assets.example_robots()
    if share is None:
        return None
    folder = (share / "example-robot-data" / "robots").resolve()
    path = urdf.resolve()
    return path.relative_to(folder) if path.is_relative_to(folder) else None


def take_over(
    xml: LocatedXml, folder: Path, package_dirs: Sequence[Path]
) -> tuple[str, list[str]]:
    """Copy a URDF and its meshes into a folder; its name there, and what is lacking.

    The text stays as it is but for the names of the meshes, which become
    `meshes/<package>/<path>`.
    """
    text = xml.path.read_text(encoding="utf-8")
    lacking = list(unresolved_visuals(xml, package_dirs))
    for name in _mesh_names(xml.root):
        source = find_mesh(name, xml.path, package_dirs)
        if source is None:
            continue
        local = Path("meshes") / _local(name)
        (folder / local).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, folder / local)
        for quote in "\"'":
            text = text.replace(f"{quote}{name}{quote}", f"{quote}{local}{quote}")
    (folder / xml.path.name).write_text(text, encoding="utf-8")
    return xml.path.name, [f"no mesh to show: {name}" for name in lacking]


def _mesh_names(root: ET.Element) -> list[str]:
    return sorted({mesh.get("filename", "") for mesh in root.iter("mesh")} - {""})


def _local(name: str) -> Path:
    """A mesh's path inside the folder of meshes, from its name in the URDF."""
    parts = Path(name.removeprefix(PACKAGE).removeprefix("file://")).parts
    inside = [part for part in parts if part not in ("/", "..", ".", "meshes")]
    return Path(*inside)


def beside(urdf: Path) -> Path | None:
    """The SRDF that belongs to a URDF: of its name, beside it or in `../srdf`."""
    name = urdf.with_suffix(".srdf").name
    for folder in (urdf.parent, urdf.parent.parent / "srdf"):
        if assets.is_file(folder / name):
            return folder / name
    return None
