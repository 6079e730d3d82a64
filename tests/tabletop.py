"""A small scene for tests: quick to solve, and with room for what a test adds."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from mmplan.problem import Obstacle, Problem
from mmplan.scene_file import load_problem

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
