"""What sampling grasps of a mesh takes, and what grasp quality adds to a search.

Sampling: 1,000 antipodal grasps of the Puma's hand on meshes (`_objects.py`) of some
20,000 triangles, the mesh read anew and nothing in the cache. Quality: searches of
6,940 evaluations on shipped scenes with the quality that the family vouches for and
with epsilon and weight, one after the other with equal seeds. Quality has no weight in
the score, so that both searches ask for the same evaluations. CPU times in seconds.

    python benchmarks/grasps.py [--grasps 1000] [--seeds 6]

Needs the extra `meshes`.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from _objects import OBJECTS

from mmplan.collision import antipodal_poses
from mmplan.optimizers import OPTIMIZERS, optimize, search_space
from mmplan.pipeline import score_function
from mmplan.problem import Problem
from mmplan.robot_build import load_robot
from mmplan.scene_file import load_problem
from mmplan.shapes import Mesh

TRIANGLES, FRICTION = 20_000, 0.5
SCENES = ("wineglass", "plate")
MASS = 0.15  # kg


def sampling(name: str, grasps: int) -> tuple[int, int, float]:
    """The triangles of a mesh, how many grasps were found, and the time, s."""
    robot = load_robot("puma_mobile")
    fine = 1
    while len((mesh := OBJECTS[name](fine)).faces) < TRIANGLES:
        fine += 1
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        path = Path(folder) / f"{name}.stl"
        mesh.export(path)
        begin = time.process_time()
        found = antipodal_poses(Mesh(path), robot, FRICTION, grasps, 0)
        return len(mesh.faces), len(found), time.process_time() - begin


def searches(scene: str, seeds: int) -> np.ndarray:
    """The time of searches without and with quality, s, (seeds, 2)."""
    problem = load_problem(scene)
    (item,) = problem.objects
    problem = replace(problem, objects=(replace(item, mass=MASS),))
    rated = replace(problem.score, quality="epsilon", grasp=0.0)
    both = (problem, replace(problem, score=rated))
    return np.array([[search(p, seed) for p in both] for seed in range(seeds)])


def search(problem: Problem, seed: int) -> float:
    """The time of one search, s."""
    score, rng = score_function(problem), np.random.default_rng(seed)
    begin = time.process_time()
    space, settings = search_space(score), problem.optimizer
    optimizer = OPTIMIZERS[settings.name](space, settings, rng)
    optimize(score, optimizer, settings.evaluations, 1)
    return time.process_time() - begin


def main(arguments: Sequence[str] | None = None) -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grasps", type=int, default=1000)
    parser.add_argument("--seeds", type=int, default=6)
    options = parser.parse_args(arguments)
    sampling("box", 10)  # imports what is imported only once
    print("| mesh | triangles | grasps | CPU s |")
    print("|---|---|---|---|")
    rows = []
    for name in OBJECTS:
        triangles, found, seconds = sampling(name, options.grasps)
        rows.append(seconds)
        print(f"| {name} | {triangles} | {found} | {seconds:.2f} |", flush=True)
    print(f"| median, largest | | | {np.median(rows):.2f}, {max(rows):.2f} |\n")
    print("| scene | without quality, CPU s | with | ratio of medians |")
    print("|---|---|---|---|")
    for scene in SCENES:
        off, on = np.median(searches(scene, options.seeds), axis=0)
        print(f"| {scene} | {off:.2f} | {on:.2f} | {on / off:.3f} |", flush=True)


if __name__ == "__main__":
    main()
