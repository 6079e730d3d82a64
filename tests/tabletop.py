"""A small scene for tests: quick to solve, and with room for what a test adds."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from mmplan.problem import Obstacle, Problem
from mmplan.scene_file import load_problem
from mmplan.shapes import Box
from tests.honest import shift

SCENE = Path(__file__).parent / "scenes" / "tabletop.yaml"


@cache
def two_tasks() -> Problem:
    """A cup moved along a table, then a bottle to where the cup was."""
    return load_problem(SCENE)


def cup_problem(*more: Obstacle) -> Problem:
    """The cup's task alone, among `more` obstacles if wanted."""
    problem = two_tasks()
    return replace(
        problem, obstacles=(*problem.obstacles, *more), tasks=problem.tasks[:1]
    )


def cup_scene(folder: Path, **settings: str) -> Path:
    """The cup's task alone as a scene file in `folder`, with more sections if wanted.

    `settings` replace the sections of those names.
    """
    lines = SCENE.read_text().splitlines()
    kept = [line for line in lines if "move: bottle" not in line]
    for name, text in settings.items():
        kept = [line for line in kept if not line.startswith(f"{name}:")]
        kept.append(f"{name}: {text}")
    path = folder / "cup.yaml"
    path.write_text("\n".join(kept) + "\n")
    return path


def walled_in() -> Problem:
    """The robot at the outset between four walls without a door."""
    x = y = -1.3
    problem = cup_problem(
        Obstacle("north", Box((1.4, 0.02, 2.0)), shift(x, y + 0.7, 1.0)),
        Obstacle("south", Box((1.4, 0.02, 2.0)), shift(x, y - 0.7, 1.0)),
        Obstacle("east", Box((0.02, 1.4, 2.0)), shift(x + 0.7, y, 1.0)),
        Obstacle("west", Box((0.02, 1.4, 2.0)), shift(x - 0.7, y, 1.0)),
    )
    q_start = problem.q_start.copy()
    q_start[problem.robot.base.indices] = x, y
    return replace(problem, q_start=q_start)
