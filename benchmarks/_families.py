"""A picture of every grasp family: an object on a table with grasps of it.

Each grasp is drawn as a fork: its prongs are the fingers, as far apart as the hand
opens, and its handle is on the side that the hand comes from.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from _objects import OBJECTS
from PIL import Image

from mmplan.cli import main

SCENE = """mmplan: 1
name: {name}
robot:
  model: puma_mobile
  start: {{base: [-1.5, 0.0], arm: tucked, hand: open}}
  bounds: {{x: [-2.0, 2.5], y: [-2.0, 2.0]}}
obstacles:
  table: {{box: [0.6, 0.6, 0.75], at: {{xyz: [0.4, 0.5, 0.375]}}}}
objects:
  thing:
    {shape}
    grasps: {{some: {grasps}}}
    at: {{xyz: [0.4, 0.5, {height}]}}
tasks: [{{move: thing, to: {{xyz: [0.5, 0.6, {height}]}}}}]
"""
GLASS = (
    "revolve: [[0, 0], [0.034, 0], [0.034, 0.003], [0.005, 0.01], [0.0045, 0.09], "
    "[0.036, 0.13], [0.033, 0.2], [0.03, 0.2], [0.033, 0.13], [0, 0.108]]"
)
PLATE = "revolve: [[0, 0], [0.06, 0], [0.11, 0.015], [0.11, 0.02], [0, 0.005]]"
CAN = "cylinder: {radius: 0.03, length: 0.14}"
ON_STEM = "{xyz: [0, 0, 0.05], rpy: [0, -1.570796, 0]}"
# By family: the shape, the keys of the grasps, and the height of the object's frame
# over the table, m.
FAMILIES = {
    "axis": (GLASS, "along: [0.02, 0.08]", 0.0),
    "cylinder_side": (CAN, "along: [-0.02, 0.04]", 0.07),
    "cylinder_top": (CAN, "", 0.07),
    "rim": (PLATE, "radius: 0.1, height: 0.016", 0.0),
    "box_faces": ("box: [0.12, 0.07, 0.05]", "faces: [+z, -x]", 0.025),
    "sphere": ("sphere: {radius: 0.035}", "", 0.035),
    "handle": (
        "mesh: mug.stl",
        "start: [0.067, 0, 0.035], end: [0.067, 0, 0.065], outward: [1, 0, 0]",
        0.0,
    ),
    "antipodal": ("mesh: mug.stl", "samples: 30", 0.0),
    "poses": (
        GLASS,
        f"poses: [{ON_STEM}, {{xyz: [0, 0, 0.17], rpy: [3.141593, 0, 0]}}]",
        0.0,
    ),
    "tsr": (
        GLASS,
        f"tool: {ON_STEM}, z: [-0.03, 0.03], yaw: [-0.7, 0.7]",
        0.0,
    ),
    "file": (GLASS, "file: saved.yaml", 0.0),
}
ACROSS, SIZE = 4, (240, 200)


def draw_families(picture: Path) -> None:
    """Draw all of them in rows, in the order of `FAMILIES`."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        OBJECTS["mug"](1).export(folder / "mug.stl")
        tiles = [_tile(folder, family) for family in FAMILIES]
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % ACROSS)
    rows = [np.hstack(tiles[i : i + ACROSS]) for i in range(0, len(tiles), ACROSS)]
    Image.fromarray(np.vstack(rows)).save(picture, quality=75)


def _tile(folder: Path, family: str) -> np.ndarray:
    """A picture of one family; the file is that of an isaac_grasp saved by mmplan."""
    shape, keys, above = FAMILIES[family]
    scene, picture = folder / f"{family}.yaml", folder / f"{family}.png"
    grasps = f"{{family: {family}, {keys}}}"
    height = 0.751 + above
    scene.write_text(
        SCENE.format(name=family, shape=shape, grasps=grasps, height=height)
    )
    size = "x".join(map(str, SIZE))
    camera = f"215,25,0.45,0.4,0.5,{0.83 if shape == GLASS else 0.79}"
    _run("render", str(scene), "-o", str(picture), "--quiet", "--size", size,
         "--camera", camera, "--hide", "robot,reach,ghosts")  # fmt: skip
    if family == "poses":
        saved = ("--save", str(folder / "saved.yaml"), "--bases", "1", "--json")
        _run("grasps", str(scene), "--object", "thing", "--samples", "8", *saved)
    return np.asarray(Image.open(picture).convert("RGB"))


def _run(*arguments: str) -> None:
    if main(arguments) != 0:
        raise SystemExit(1)
