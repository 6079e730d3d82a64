"""What is wrong with a URDF, found in its XML before any model is built of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan.exceptions import Diagnostic, InputError
from mmplan.files.located_xml import LocatedXml, read_xml
from mmplan.files.urdf_meshes import PACKAGE, find_mesh, folders_of
from mmplan.files.urdf_numbers import (
    inertia_faults,
    limit_faults,
    origin_faults,
    shape_faults,
)
from mmplan.files.urdf_structure import (
    Found,
    axis_fault,
    mimic_faults,
    structure_faults,
)

_WITHOUT_AXIS = ("fixed", "floating")


def read_sound_urdf(path: Path, package_dirs: Sequence[Path] = ()) -> LocatedXml:
    """Read a URDF file; `package://` names are looked up in `package_dirs` too.

    Raises:
        InputError: It is no URDF, or a robot cannot be made of it; every fault is
            named with its line and element.
    """
    xml = read_xml(path)
    faults = urdf_faults(xml, package_dirs)
    if faults:
        raise InputError(*faults)
    return xml


def urdf_faults(
    xml: LocatedXml, package_dirs: Sequence[Path] = ()
) -> tuple[Diagnostic, ...]:
    """Every fault of a URDF, in the order of the file."""
    if xml.root.tag != "robot":
        text = f"is no URDF: its root is <{xml.root.tag}>, <robot> was expected"
        return (xml.diagnostic(xml.root, text),)
    if any(element.tag.startswith("xacro:") for element in xml.root.iter()):
        text = "is a xacro file; make a URDF of it first: xacro FILE -o robot.urdf"
        return (xml.diagnostic(xml.root, text),)
    owners = {inner: part for part in xml.root for inner in part.iter()}
    found = [
        xml.diagnostic(element, _sentence(owners.get(element), element, message))
        for element, message in _found(xml, package_dirs)
    ]
    return tuple(sorted(found, key=lambda d: d.line or 0))


def _found(xml: LocatedXml, package_dirs: Sequence[Path]) -> Found:
    yield from structure_faults(xml.root)
    yield from mimic_faults(xml.root)
    for joint in xml.root.findall("joint"):
        yield from limit_faults(joint)
        for axis in joint.findall("axis"):
            if joint.get("type") not in _WITHOUT_AXIS and (fault := axis_fault(axis)):
                yield axis, fault
    for link in xml.root.findall("link"):
        for inertial in link.findall("inertial"):
            yield from inertia_faults(inertial)
    for part in (*xml.root.findall("link"), *xml.root.findall("joint")):
        for origin in part.iter("origin"):
            yield from ((origin, fault) for fault in origin_faults(origin))
    yield from _body_faults(xml, package_dirs)


def _body_faults(xml: LocatedXml, package_dirs: Sequence[Path]) -> Found:
    for collision in xml.root.iterfind("link/collision"):
        geometry = collision.find("geometry")
        if geometry is None:
            yield collision, "has no <geometry>"
            continue
        yield from shape_faults(geometry)
        for mesh in geometry.findall("mesh"):
            if fault := _mesh_fault(mesh, xml.path, package_dirs):
                yield mesh, fault


def _mesh_fault(
    mesh: ET.Element, urdf: Path, package_dirs: Sequence[Path]
) -> str | None:
    """Why the file of a mesh is not found, with all folders that were tried."""
    name = mesh.get("filename", "")
    if not name:
        return "has no 'filename'"
    if find_mesh(name, urdf, package_dirs) is not None:
        return None
    tried = ", ".join(str(f) for f in folders_of(name, urdf, package_dirs))
    if not name.startswith(PACKAGE):
        return f"no such mesh: '{name}'; folders tried: {tried}"
    package = name.removeprefix(PACKAGE).partition("/")[0]
    return f"no package '{package}' with '{name}'; folders tried: {tried}"


def _sentence(owner: ET.Element | None, element: ET.Element, message: str) -> str:
    """The message after the link or joint that it belongs to, and its element."""
    words = [] if owner is None else [f"{owner.tag} '{owner.get('name', '')}'"]
    words += [] if element in (owner, None) else [f"<{element.tag}>"]
    return f"{', '.join(words)}: {message}" if words else message


def unresolved_visuals(
    xml: LocatedXml, package_dirs: Sequence[Path] = ()
) -> Iterator[str]:
    """Names of meshes that are only shown, and whose files are missing, each once."""
    meshes = xml.root.iterfind("link/visual/geometry/mesh")
    for name in dict.fromkeys(mesh.get("filename", "") for mesh in meshes):
        if find_mesh(name, xml.path, package_dirs) is None:
            yield name
