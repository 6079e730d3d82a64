"""One plan that all exports are tested with, and its samples from the plan file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from mmplan.pipeline import solve
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.shapes import Array
from tests.tabletop import cup_scene


@dataclass(frozen=True, eq=False)
class Solved:
    """A plan and its file, with the samples as the file has them."""

    problem: Problem
    plan: Plan
    path: Path
    times: Array
    positions: Array
    velocities: Array


@pytest.fixture(scope="session")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Solved:
    folder = tmp_path_factory.mktemp("exports")
    problem = load_problem(cup_scene(folder))
    plan = solve(problem, seed=3)
    path = folder / "plan.json"
    plan.save(path)
    (task,) = json.loads(path.read_text())["tasks"]
    start, times, positions, velocities = 0.0, [], [], []
    for number, s in enumerate(task["segments"]):
        first = 1 if number else 0
        times += [start + t for t in s["times"][first:]]
        positions += s["positions"][first:]
        velocities += s["velocities"][first:]
        start += s["times"][-1]
    return Solved(
        problem,
        plan,
        path,
        np.array(times),
        np.array(positions),
        np.array(velocities),
    )
