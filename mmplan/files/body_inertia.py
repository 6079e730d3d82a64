"""Mass, centre and inertia of a link made of boxes, spheres and cylinders."""

from __future__ import annotations

import math
from collections.abc import Sequence
from xml.etree import ElementTree as ET

from mmplan.files.rigid_pose import Matrix, RigidPose, Vector

DENSITY = 400.0  # kg/m^3, about that of mobile platforms on the market

Solid = tuple[ET.Element, RigidPose]


def inertial(solids: Sequence[Solid]) -> ET.Element:
    """A URDF's <inertial> for primitives of even density at poses in the link."""
    masses = [DENSITY * _volume(shape) for shape, _ in solids]
    total = sum(masses)
    centre = tuple(
        sum(m * pose.xyz[k] for m, (_, pose) in zip(masses, solids, strict=True))
        / total
        for k in range(3)
    )
    moments = [[0.0] * 3 for _ in range(3)]
    for mass, (shape, pose) in zip(masses, solids, strict=True):
        about_centre = _about(centre, mass, pose, _principal(shape))
        for row, values in zip(moments, about_centre, strict=True):
            row[:] = [a + b for a, b in zip(row, values, strict=True)]
    element = ET.Element("inertial")
    ET.SubElement(element, "origin", xyz=" ".join(map(repr, centre)))
    ET.SubElement(element, "mass", value=repr(total))
    names = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2)}
    names["izz"] = (2, 2)
    entries = {name: repr(moments[i][j]) for name, (i, j) in names.items()}
    ET.SubElement(element, "inertia", entries)
    return element


def _about(
    centre: Sequence[float], mass: float, pose: RigidPose, principal: Vector
) -> list[list[float]]:
    """Inertia (3, 3) about a point: R diag R' and the parallel axes' share."""
    R: Matrix = pose.R
    d = [a - b for a, b in zip(pose.xyz, centre, strict=True)]
    square = sum(component * component for component in d)
    return [
        [
            mass * sum(R[i][k] * principal[k] * R[j][k] for k in range(3))
            + mass * ((square if i == j else 0.0) - d[i] * d[j])
            for j in range(3)
        ]
        for i in range(3)
    ]


def _numbers(shape: ET.Element, name: str) -> list[float]:
    return [float(word) for word in shape.get(name, "").split()]


def _volume(shape: ET.Element) -> float:
    if shape.tag == "box":
        return math.prod(_numbers(shape, "size"))
    (radius,) = _numbers(shape, "radius")
    if shape.tag == "sphere":
        return 4.0 / 3.0 * math.pi * radius**3
    return math.pi * radius**2 * _numbers(shape, "length")[0]


def _principal(shape: ET.Element) -> Vector:
    """Moments of inertia by mass about the shape's own axes, m^2."""
    if shape.tag == "box":
        x, y, z = (side**2 / 12.0 for side in _numbers(shape, "size"))
        return (y + z, x + z, x + y)
    (radius,) = _numbers(shape, "radius")
    if shape.tag == "sphere":
        return (0.4 * radius**2,) * 3
    (length,) = _numbers(shape, "length")
    across = radius**2 / 4.0 + length**2 / 12.0
    return (across, across, radius**2 / 2.0)
