"""Everyday things as closed triangle meshes, made from a few numbers each.

Things of two parts are two closed surfaces that overlap a little.

    python benchmarks/_objects.py FOLDER [--fine 1]     # writes one STL file each
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import trimesh

Points = Sequence[tuple[float, float]]


def turned(profile: Points, fine: int, sections: int = 32) -> trimesh.Trimesh:
    """A solid of revolution about z from its outline (r, z), in order."""
    outline = np.array([*profile, profile[0]])
    steps = [np.linspace(a, b, fine, endpoint=False) for a, b in pairwise(outline)]
    return trimesh.creation.revolve(
        np.concatenate([*steps, outline[-1:]]), sections=fine * sections
    )


def tube(path: np.ndarray, radii: np.ndarray, sides: int) -> trimesh.Trimesh:
    """A round tube about a path (n, 3) in the x-z plane, closed at both ends."""
    ahead = np.gradient(path, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    across = np.cross(ahead, [0.0, 1.0, 0.0])
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[None, :, None] * across[:, None] + np.sin(angle)[
        None, :, None
    ] * np.array([0.0, 1.0, 0.0])
    rings = path[:, None] + radii[:, None, None] * ring
    n = len(path)
    vertices = np.concatenate([rings.reshape(-1, 3), path[[0, -1]]])
    faces = []
    for k in range(sides):
        e = (k + 1) % sides
        faces += [
            (n * sides, e, k),
            (n * sides + 1, (n - 1) * sides + k, (n - 1) * sides + e),
        ]
        for i in range(n - 1):
            a, b = i * sides + k, i * sides + e
            faces += [(a, b, b + sides), (a, b + sides, a + sides)]
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    mesh.fix_normals()
    return mesh


def arc(
    centre: Sequence[float], radius: float, begin: float, end: float, n: int
) -> np.ndarray:
    """Points (n, 3) of an arc in the x-z plane; angles in degrees from x towards z."""
    angle = np.radians(np.linspace(begin, end, n))
    return np.stack(
        [
            centre[0] + radius * np.cos(angle),
            np.zeros(n),
            centre[1] + radius * np.sin(angle),
        ],
        axis=1,
    )


def mug(fine: int = 1) -> trimesh.Trimesh:
    """A mug with walls of 4 mm and a handle towards +x."""
    body = turned(
        [(0, 0), (0.04, 0), (0.04, 0.095), (0.036, 0.095), (0.036, 0.006), (0, 0.006)],
        fine,
    )
    path = arc((0.038, 0.048), 0.03, -85, 85, 14 * fine)
    return body + tube(path, np.full(14 * fine, 0.0055), 10 * fine)


def bottle(fine: int = 1) -> trimesh.Trimesh:
    """A bottle with a neck."""
    return turned(
        [(0, 0), (0.036, 0), (0.036, 0.15), (0.014, 0.19), (0.014, 0.24), (0, 0.24)],
        fine,
    )


def bowl(fine: int = 1) -> trimesh.Trimesh:
    """A bowl that is wider than a small hand opens."""
    outline = [(0, 0), (0.04, 0), (0.07, 0.03), (0.08, 0.065), (0.076, 0.065)]
    return turned([*outline, (0.066, 0.032), (0.038, 0.005), (0, 0.005)], fine)


def pan(fine: int = 1) -> trimesh.Trimesh:
    """A pan with a long handle towards +x."""
    outline = [(0, 0), (0.09, 0), (0.1, 0.045), (0.096, 0.045), (0.087, 0.004)]
    grip = np.linspace([0.094, 0, 0.035], [0.26, 0, 0.055], 14 * fine)
    body = turned([*outline, (0, 0.004)], fine)
    return body + tube(grip, np.full(len(grip), 0.011), 10 * fine)


def spray_can(fine: int = 1) -> trimesh.Trimesh:
    """A spray can with a nozzle."""
    outline = [(0, 0), (0.032, 0), (0.032, 0.17), (0.018, 0.183), (0.01, 0.183)]
    return turned([*outline, (0.01, 0.2), (0, 0.2)], fine)


def box(fine: int = 1) -> trimesh.Trimesh:
    """A box of tea."""
    mesh: trimesh.Trimesh = trimesh.creation.box((0.15, 0.07, 0.09))
    for _ in range(fine):
        mesh = mesh.subdivide()
    return mesh


def banana(fine: int = 1) -> trimesh.Trimesh:
    """A bent bar that is thinner towards its ends."""
    n = 20 * fine
    share = np.linspace(-1.0, 1.0, n)
    radii = 0.004 + 0.014 * np.sqrt(1.0 - 0.98 * share**2)
    return tube(arc((0.0, 0.13), 0.13, 225, 315, n), radii, 14 * fine)


def tray(fine: int = 1) -> trimesh.Trimesh:
    """A square tray with an upright rim."""
    outline = [(0, 0), (0.14, 0), (0.15, 0.035), (0.146, 0.035), (0.137, 0.005)]
    mesh = turned([*outline, (0, 0.005)], 1, sections=4)
    for _ in range(fine):
        mesh = mesh.subdivide()
    return mesh


def wineglass(fine: int = 1) -> trimesh.Trimesh:
    """A wineglass with a foot, a stem and a hollow bowl."""
    outline = [(0, 0), (0.034, 0), (0.034, 0.003), (0.005, 0.01), (0.0045, 0.09)]
    bowl_outside = [(0.024, 0.105), (0.036, 0.13), (0.033, 0.2)]
    inside = [(0.03, 0.2), (0.033, 0.13), (0.022, 0.11), (0, 0.108)]
    return turned([*outline, *bowl_outside, *inside], fine)


def hammer(fine: int = 1) -> trimesh.Trimesh:
    """A head across the end of a handle."""
    handle = np.linspace([0.0, 0, 0.0], [0.0, 0, 0.25], 12 * fine)
    head = np.linspace([-0.05, 0, 0.25], [0.05, 0, 0.25], 6 * fine)
    grip = tube(handle, np.full(len(handle), 0.013), 10 * fine)
    return grip + tube(head, np.full(len(head), 0.02), 10 * fine)


OBJECTS: dict[str, Callable[[int], trimesh.Trimesh]] = {
    "banana": banana,
    "bottle": bottle,
    "bowl": bowl,
    "box": box,
    "hammer": hammer,
    "mug": mug,
    "pan": pan,
    "spray_can": spray_can,
    "tray": tray,
    "wineglass": wineglass,
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Write all objects into a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument(
        "--fine", type=int, default=1, help="triangles grow as its square"
    )
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    for name, make in OBJECTS.items():
        mesh = make(options.fine)
        mesh.export(options.folder / f"{name}.stl")
        print(f"{name:10} {len(mesh.faces):7} triangles, closed: {mesh.is_watertight}")


if __name__ == "__main__":
    main()
