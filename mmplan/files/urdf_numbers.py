"""Faults of the numbers in a URDF: what is no number, not finite, or out of range."""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.etree import ElementTree as ET

_SHAPES = {
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
}
_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def numbers(element: ET.Element, name: str, default: str = "") -> list[float] | None:
    """The numbers of an attribute; None where one of them is none."""
    try:
        return [float(word) for word in element.get(name, default).split()]
    except ValueError:
        return None


def count_fault(element: ET.Element, name: str, count: int) -> str | None:
    """Why an attribute that is given is not `count` finite numbers; None if it is."""
    values = numbers(element, name)
    if values is None or len(values) != count or not all(map(math.isfinite, values)):
        noun = "number" if count == 1 else "numbers"
        given = f"'{element.get(name)}'" if name in element.attrib else "nothing"
        return f"expected {count} finite {noun} for '{name}', got {given}"
    return None


def origin_faults(element: ET.Element) -> Iterator[str]:
    """Faults of <origin xyz rpy>."""
    for name in ("xyz", "rpy"):
        if name in element.attrib and (fault := count_fault(element, name, 3)):
            yield fault


def inertia_faults(inertial: ET.Element) -> Iterator[tuple[ET.Element, str]]:
    """Faults of <inertial>: mass and moments must be finite, the mass not below 0."""
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is None or inertia is None:
        lacking = "mass" if mass is None else "inertia"
        yield inertial, f"has no <{lacking}>; <inertial> needs <mass> and <inertia>"
        return
    if fault := count_fault(mass, "value", 1):
        yield mass, fault
    elif float(mass.get("value", "")) < 0:
        yield mass, f"must be at least 0 kg, got '{mass.get('value')}'"
    for name in _INERTIA:
        if fault := count_fault(inertia, name, 1):
            yield inertia, fault


def shape_faults(geometry: ET.Element) -> Iterator[tuple[ET.Element, str]]:
    """Faults of a collision body's <geometry>: one shape, with lengths above 0."""
    if len(geometry) != 1 or geometry[0].tag not in {*_SHAPES, "mesh"}:
        found = ", ".join(f"<{shape.tag}>" for shape in geometry) or "nothing"
        allowed = ", ".join(f"<{tag}>" for tag in (*_SHAPES, "mesh"))
        yield geometry, f"expected one of {allowed}; got {found}"
        return
    shape = geometry[0]
    for name, count in _SHAPES.get(shape.tag, {}).items():
        yield from ((shape, fault) for fault in _length_faults(shape, name, count))
    if shape.tag == "mesh" and "scale" in shape.attrib:
        if fault := count_fault(shape, "scale", 3):
            yield shape, fault
        elif 0.0 in (numbers(shape, "scale") or ()):
            yield shape, f"scale '{shape.get('scale')}' makes the body flat"


def _length_faults(shape: ET.Element, name: str, count: int) -> Iterator[str]:
    if fault := count_fault(shape, name, count):
        yield fault
    elif min(numbers(shape, name) or ()) <= 0.0:
        text = f"{name} must be above 0 m, got '{shape.get(name)}'"
        yield f"{text}: a body without volume collides with nothing"


def limit_faults(joint: ET.Element) -> Iterator[tuple[ET.Element, str]]:
    """Faults of the <limit> of a joint that moves; a continuous one needs no bounds."""
    limit, kind = joint.find("limit"), joint.get("type")
    if limit is None:
        if kind in ("revolute", "prismatic"):
            unit = "rad" if kind == "revolute" else "m"
            text = f"a {kind} joint needs <limit lower upper velocity effort> ({unit})"
            yield joint, f"has no limits; {text}"
        return
    given = [n for n in ("lower", "upper", "velocity", "effort") if n in limit.attrib]
    faults = [(limit, f) for n in given if (f := count_fault(limit, n, 1))]
    yield from faults
    if not faults and kind != "continuous":
        lower, upper = (float(limit.get(n, "0")) for n in ("lower", "upper"))
        if lower > upper:
            yield limit, f"lower {lower:g} is above upper {upper:g}"
