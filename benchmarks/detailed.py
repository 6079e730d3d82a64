"""Scenes of detailed models against the same scenes of primitives.

    python benchmarks/detailed.py [--scenes wineglass plate dishes] [--seeds 5]

Every obstacle of a scene, each link of a fixture, and, with `--objects`, each object
becomes a closed mesh of the same shape, all with so many triangles together. The scene
`dishes` is `wineglass` with bowls, rings and mugs on the counter: turned outlines in
the primitive scene, and rippled surfaces in the detailed ones.

Each scene is loaded once with an empty cache, then loaded and solved for every seed in
turn with the others. Times are CPU seconds in one process, imports done.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from _tessellation import refined, surface_of, turned, write_stl

import mmplan
from mmplan.assets import find_scene
from mmplan.collision import Scenery, solids_of_obstacle
from mmplan.collision.surfaces import appearance
from mmplan.shapes import Array

_SCENES, _TRIANGLES = ["wineglass", "plate", "dishes"], [300_000, 3_000_000]
# The dishes on the counter of `dishes`: outlines, and where they stand along it.
_TURN = 2 * np.pi * np.arange(16) / 16
_DISHES: dict[str, tuple[Sequence[Sequence[float]], float]] = {
    "bowl": (
        [(0, 0), (0.05, 0), (0.11, 0.06), (0.106, 0.063), (0.048, 0.005), (0, 0.005)],
        -0.2,
    ),
    "ring": (
        [(0.06 + 0.03 * np.cos(a), 0.031 + 0.03 * np.sin(a)) for a in _TURN],
        -0.7,
    ),
    "mug": (
        [(0, 0), (0.04, 0), (0.04, 0.09), (0.036, 0.09), (0.036, 0.006), (0, 0.006)],
        -1.1,
    ),
    "dish": (
        [(0, 0), (0.08, 0), (0.12, 0.02), (0.119, 0.023), (0.079, 0.004), (0, 0.004)],
        0.9,
    ),
}
_COUNTER_X, _COUNTER_Z, _RIPPLES = 1.72, 0.9, 0.001


def main() -> None:
    """Print a line for each scene and number of triangles."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenes", nargs="+", default=_SCENES)
    parser.add_argument("--triangles", nargs="+", type=int, default=_TRIANGLES)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--objects", action="store_true", help="objects as meshes too")
    options = parser.parse_args()
    print(
        "| scene | triangles | bodies | prepared in s | loaded again in s | solved |"
        " load and solve s, median | against primitives |"
    )
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        os.environ["XDG_CACHE_HOME"] = f"{name}/cache"
        for scene in options.scenes:
            _compare(scene, options, Path(name))


def _compare(name: str, options: argparse.Namespace, folder: Path) -> None:
    """Solve one scene in all its forms, seed by seed in turn."""
    scenes = {0: primitive_scene(name, folder)}
    for count in options.triangles:
        scenes[count] = detailed_scene(scenes[0], count, options.objects)
    prepared = {count: loading(scene) for count, scene in scenes.items()}
    again = {count: loading(scene) for count, scene in scenes.items()}
    mmplan.solve(mmplan.load_problem(scenes[0]), seed=0)  # compiles, and imports
    times: dict[int, list[float]] = {count: [] for count in scenes}
    solved = dict.fromkeys(scenes, 0)
    for seed in range(options.seeds):
        for count, scene in scenes.items():
            start = time.process_time()
            solved[count] += _solve(scene, seed)
            times[count].append(time.process_time() - start)
    for count, scene in scenes.items():
        half = float(np.median(times[count]))
        ratio = np.median(np.array(times[count]) / times[0])
        print(
            f"| {name} | {count:,} | {_bodies(scene)} | "
            f"{prepared[count]:.1f} | {again[count]:.2f} | "
            f"{solved[count]} of {options.seeds} | {half:.2f} | {ratio:.2f} |"
            if count
            else f"| {name} | primitives | {_bodies(scene)} | {prepared[0]:.1f} | "
            f"{again[0]:.2f} | {solved[0]} of {options.seeds} | {half:.2f} | 1 |"
        )
        sys.stdout.flush()


def _solve(scene: Path, seed: int) -> bool:
    try:
        mmplan.solve(mmplan.load_problem(scene), seed=seed)
    except mmplan.NoPlanError:
        return False
    return True


def loading(scene: Path) -> float:
    """CPU seconds to load a scene and to make its solids."""
    start = time.process_time()
    Scenery.of_problem(mmplan.load_problem(scene))
    return time.process_time() - start


def _bodies(scene: Path) -> int:
    """The number of convex bodies in a scene."""
    scenery = Scenery.of_problem(mmplan.load_problem(scene))
    return len(scenery.obstacles) + sum(map(len, scenery.objects.values()))


def primitive_scene(name: str, folder: Path) -> Path:
    """A scene without detailed models, copied into a folder of its own."""
    source = find_scene("wineglass" if name == "dishes" else name)
    path = folder / name / "scene.yaml"
    shutil.copytree(source.parent, path.parent)
    data = yaml.safe_load(source.read_text())
    if name == "dishes":
        for dish, (outline, y) in _DISHES.items():
            outline = [[float(r), float(z)] for r, z in outline]
            at = {"xyz": [_COUNTER_X, y, _COUNTER_Z]}
            data["obstacles"][dish] = {"revolve": outline, "at": at}
    path.write_text(yaml.safe_dump(data, sort_keys=False))
    return path


def detailed_scene(source: Path, count: int, objects: bool) -> Path:
    """The scene with meshes of `count` triangles together for all its obstacles."""
    data = yaml.safe_load(source.read_text())
    surfaces: dict[str, tuple[dict[str, Any], list[Array]]] = {}
    for obstacle in mmplan.load_problem(source).obstacles:
        entry = data["obstacles"].pop(obstacle.name)
        kept = {key: entry[key] for key in ("at", "ground") if key in entry}
        if "revolve" in entry:
            surface = turned(entry["revolve"], _RIPPLES)
            surfaces[obstacle.name] = (kept, [surface])
            continue
        for solid in solids_of_obstacle(obstacle):
            owner = solid.owner.replace("/", "_")
            T = solid.placement
            triangles = surface_of(appearance(solid.geometry))
            placed = triangles @ T[:3, :3].T + T[:3, 3]
            own = {"ground": True} if obstacle.ground else {}
            surfaces.setdefault(owner, (own, []))[1].append(placed)
    for name, entry in data["objects"].items() if objects else ():
        surfaces[name] = (entry, [turned(entry.pop("revolve"), 0.0)])
    _write_meshes(surfaces, count, source.parent)
    for name, (entry, _) in surfaces.items():
        kind = "objects" if name in data["objects"] else "obstacles"
        data[kind][name] = {"mesh": f"{count}/{name}.stl", **entry}
    path = source.with_name(f"{count}.yaml")
    path.write_text(yaml.safe_dump(data, sort_keys=False))
    return path


def _write_meshes(
    surfaces: dict[str, tuple[dict[str, Any], list[Array]]],
    count: int,
    folder: Path,
) -> None:
    """Write a mesh for each name, with so many triangles together."""
    parts = [(name, s) for name, (_, own) in surfaces.items() for s in own]
    fine = refined([surface for _, surface in parts], count)
    (folder / str(count)).mkdir()
    for name in surfaces:
        own = [s for (owner, _), s in zip(parts, fine, strict=True) if owner == name]
        write_stl(folder / str(count) / f"{name}.stl", np.concatenate(own))


if __name__ == "__main__":
    main()
