"""How cost grows with obstacles, triangles, populations and joints.

    python benchmarks/growth.py [--studies obstacles triangles populations joints]
        [--seeds 3] [--save growth.json] [--picture docs/pictures/growth.webp]

- obstacles: the scene `wineglass` among 0 to 1,000 boxes of 4 to 15 cm, wherever the
  robot does not need the room: under the ceiling, over the counter, along the walls.
- triangles: `wineglass` with meshes for its obstacles, as `detailed.py` makes them.
- populations: `wineglass`, all three populations and the budget times a factor.
- joints: a block moved on a table by every robot shipped, its base driving or fixed.

Each study prints a table. Results are added to those in the file to `--save` to, and
all of these together are one picture. Times are CPU seconds of
loading and solving in one process, imports done: the search for bases and grasp, and
all else, which is paths, timing and proof.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from detailed import detailed_scene, loading, primitive_scene
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

import mmplan
from mmplan.assets import robot_names
from mmplan.problem import Obstacle, Problem
from mmplan.shapes import Box, read_only

_OBSTACLES = (0, 10, 30, 100, 300, 1000)
_TRIANGLES = (10_000, 100_000, 300_000, 1_000_000, 3_000_000)
_FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
# The room of `wineglass`, the part of it that the robot needs, and how far from the
# glass, where it stands and where it goes, nothing is put, m.
_ROOM = np.array([[-2.8, -1.75, 0.0], [1.95, 2.1, 2.4]])
_NEEDED = np.array([[-1.5, -1.5, 0.0], [1.25, 1.8, 1.8]])
_ENDS, _KEPT_FREE = np.array([[1.72, 0.35, 1.0], [1.08, -0.53, 0.4]]), 0.5
_TABLE = """
mmplan: 1
name: block
robot: {{model: {robot}, base: {base}, start: {{base: {at}, arm: {arm}, hand: open}}}}
obstacles:
  floor: {{box: [6, 6, 0.1], at: {{xyz: [0, 0, -0.05]}}, ground: true}}
  table: {{box: [0.5, 1.2, 0.7], at: {{xyz: [0.85, 0, 0.35]}}}}
objects:
  block:
    box: [0.04, 0.04, 0.14]
    at: {{xyz: [0.66, 0.2, 0.77]}}
    grasps: {{side: {{family: axis, along: [-0.03, 0.05]}}}}
tasks: [{{move: block, to: {{xyz: [0.66, -0.2, 0.77]}}}}]
"""


class Cost(NamedTuple):
    """What one solve took, CPU seconds, and whether there was a plan."""

    search: float
    rest: float
    solved: bool


class Point(NamedTuple):
    """The costs of all seeds at one size."""

    size: float
    name: str
    costs: list[Cost]


def main() -> None:
    """Run the studies wanted, print their tables and draw them."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--studies", nargs="*", choices=_STUDIES, default=_NAMES)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--save", type=Path)
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    mmplan.solve(mmplan.load_problem("wineglass"), seed=0)  # imports and compiles
    results = _saved(options.save)
    for name in options.studies:
        print(
            f"\n| {name} | solved | search s, median | all else s, median | total s |"
        )
        print("|---|---|---|---|---|")
        results[name] = [_printed(p) for p in _STUDIES[name](options.seeds)]
        if options.save is not None:
            options.save.write_text(json.dumps(results))
    if options.picture is not None:
        _draw(results, options.picture)


def _saved(path: Path | None) -> dict[str, list[Point]]:
    """The results of studies before."""
    if path is None or not path.is_file():
        return {}
    return {
        study: [Point(x, name, [Cost(*c) for c in costs]) for x, name, costs in points]
        for study, points in json.loads(path.read_text()).items()
    }


def _printed(point: Point) -> Point:
    search, rest = _medians(point)
    total = np.median([c.search + c.rest for c in point.costs])
    solved = sum(c.solved for c in point.costs)
    print(
        f"| {point.name} | {solved} of {len(point.costs)} | {search:.2f} | {rest:.2f} "
        f"| {total:.2f} |",
        flush=True,
    )
    return point


def _medians(point: Point) -> tuple[float, float]:
    return (
        float(np.median([c.search for c in point.costs])),
        float(np.median([c.rest for c in point.costs])),
    )


def _obstacles(seeds: int) -> Iterator[Point]:
    problem = mmplan.load_problem("wineglass")
    boxes = list(_boxes(max(_OBSTACLES)))
    for count in _OBSTACLES:
        crowded = replace(problem, obstacles=(*problem.obstacles, *boxes[:count]))
        name = f"{len(crowded.obstacles)} obstacles"
        yield _measured(len(crowded.obstacles), name, crowded, seeds)


def _boxes(count: int) -> Iterator[Obstacle]:
    """Boxes at random places and of random sizes, out of the robot's way."""
    rng = np.random.default_rng(0)
    number = 0
    while number < count:
        place = rng.uniform(*_ROOM)
        needed = np.all((place > _NEEDED[0]) & (place < _NEEDED[1]))
        if needed or np.linalg.norm(_ENDS - place, axis=1).min() < _KEPT_FREE:
            continue
        T = np.eye(4)
        turn = rng.uniform(0, np.pi)
        T[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        T[:3, 3] = place
        x, y, z = rng.uniform(0.04, 0.15, 3).tolist()
        yield Obstacle(f"box_{number}", Box((x, y, z)), read_only(T))
        number += 1


def _triangles(seeds: int) -> Iterator[Point]:
    with tempfile.TemporaryDirectory() as name:
        os.environ["XDG_CACHE_HOME"] = f"{name}/cache"
        primitive = primitive_scene("wineglass", Path(name))
        for count in _TRIANGLES:
            scene = detailed_scene(primitive, count, objects=False)
            title = f"{count:,} triangles, prepared in {loading(scene):.1f} s"
            yield _measured(count, title, scene, seeds)


def _populations(seeds: int) -> Iterator[Point]:
    problem = mmplan.load_problem("wineglass")
    usual = problem.optimizer
    for factor in _FACTORS:
        settings = replace(
            usual,
            bases=round(usual.bases * factor),
            grasps=round(usual.grasps * factor),
            evaluations=round(usual.evaluations * factor),
        )
        title = f"2 × {settings.bases} bases, {settings.grasps} grasps"
        larger = replace(problem, optimizer=settings)
        yield _measured(factor, title, larger, seeds)


def _joints(seeds: int) -> Iterator[Point]:
    with tempfile.TemporaryDirectory() as folder:
        points = []
        for base in ("as it is", "fixed"):
            for robot in robot_names():
                scene = Path(folder) / f"{robot} {base}.yaml"
                problem = _block_problem(robot, base, scene)
                if problem is not None:
                    points.append((_joint_count(problem), f"{robot}, {base}", problem))
        for count, name, problem in sorted(points, key=lambda p: p[:2]):
            yield _measured(count, f"{count}: {name}", problem, seeds)


def _measured(size: float, name: str, scene: Problem | Path, seeds: int) -> Point:
    return Point(size, name, [_cost(scene, seed) for seed in range(seeds)])


def _cost(scene: Problem | Path, seed: int) -> Cost:
    """Load and solve once; the search is over when the first other stage is told of."""
    begin = time.process_time()
    ended = [begin]

    def progress(what: str, done: int, of: int | None) -> None:  # noqa: ARG001
        if what == "optimization":
            ended[0] = time.process_time()

    try:
        problem = mmplan.load_problem(scene) if isinstance(scene, Path) else scene
        mmplan.solve(problem, seed=seed, progress=progress)
        solved = True
    except mmplan.NoPlanError:
        solved = False
    return Cost(ended[0] - begin, time.process_time() - ended[0], solved)


def _block_problem(robot: str, base: str, scene: Path) -> Problem | None:
    """The problem of the block for a robot; None where that cannot begin."""
    drives = base != "fixed"
    for at in ([-0.7, 0.3], [-0.7, 0.3, 0.0]) if drives else ([0.0, 0.0], [0.0] * 3):
        for arm in ("home", "tucked"):
            line = _TABLE.format(
                robot=robot, base="robot" if drives else base, at=at, arm=arm
            ).replace("base: robot, ", "")
            scene.write_text(line)
            try:
                return mmplan.load_problem(scene)
            except mmplan.InputError:
                continue
    return None


def _joint_count(problem: Problem) -> int:
    return len(problem.robot.base) + len(problem.robot.arm)


def _draw(results: dict[str, list[Point]], path: Path) -> None:
    """Draw one panel for each study."""
    figure, panels = plt.subplots(2, 2, figsize=(9, 6.4), layout="constrained")
    for axes, (name, points) in zip(panels.flat, results.items(), strict=False):
        _panel(axes, name, points)
    figure.savefig(path, dpi=110)


def _panel(axes: Axes, name: str, points: list[Point]) -> None:
    sizes = [point.size for point in points]
    for i, (label, marker) in enumerate([("search", "o"), ("all else", "s")]):
        costs = [[c[i] for c in point.costs] for point in points]
        half = [float(np.median(c)) for c in costs]
        ends = [[min(c) for c in costs], [max(c) for c in costs]]
        errors = np.abs(np.array(ends) - half)
        line = "none" if name == "joints" else "-"
        axes.errorbar(
            sizes, half, errors, label=label, marker=marker, linestyle=line, capsize=2
        )
    axes.set_xlabel(_LABELS[name])
    axes.set_ylabel("CPU s")
    axes.set_ylim(bottom=0.0)
    if name != "joints":
        axes.set_xscale("log")
    if name == "populations":
        axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
        axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend()


_STUDIES = {
    "obstacles": _obstacles,
    "triangles": _triangles,
    "populations": _populations,
    "joints": _joints,
}
_NAMES = list(_STUDIES)
_LABELS = {
    "obstacles": "obstacles in the scene",
    "triangles": "triangles in the scene",
    "populations": "populations and budget, times the paper's",
    "joints": "joints of base and arm",
}


if __name__ == "__main__":
    main()
