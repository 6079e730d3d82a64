"""What the tests of path benchmarks share: small files of problems, and records."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from mmplan.benchmarking.paths.arena import Arena, Contestant, contestant, make_arena
from mmplan.benchmarking.paths.problems import PathProblem, load_path_problems
from mmplan.benchmarking.paths.records import PathRecord
from mmplan.problem import Obstacle
from mmplan.shapes import Box

MOTIONBENCHMAKER = (
    Path(__file__).parents[3] / "benchmarks/data/panda_motionbenchmaker.json.gz"
)
HOME = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
TURNED = [1.6, *HOME[1:]]


def thing(**changes: Any) -> dict[str, Any]:
    """A pillar that a straight way from HOME to TURNED would hit."""
    pose = np.eye(4)
    pose[:3, 3] = 0.244, 0.251, 0.5
    return {
        "name": "pillar",
        "type": "box",
        "dims": [0.06, 0.06, 1.0],
        "pose": pose.tolist(),
    } | changes


def problem(**changes: Any) -> dict[str, Any]:
    """A turn around the pillar."""
    return {
        "index": 1,
        "family": "pillar",
        "start": HOME,
        "goal": TURNED,
        "objects": [thing()],
    } | changes


def problem_file(folder: Path, *problems: dict[str, Any], name: str = "p.json") -> Path:
    """A file of one family of problems."""
    path = folder / name
    path.write_text(json.dumps({"pillar": list(problems or (problem(),))}))
    return path


@cache
def panda() -> Contestant:
    return contestant()


@cache
def motionbenchmaker() -> tuple[PathProblem, ...]:
    return load_path_problems(MOTIONBENCHMAKER).problems


def arena(*obstacles: Obstacle) -> Arena:
    """From HOME to TURNED among obstacles."""
    q_start, q_goal = np.array(HOME), np.array(TURNED)
    return make_arena(panda(), PathProblem("made", 1, q_start, q_goal, obstacles))


def box(size: tuple[float, float, float], *xyz: float) -> Obstacle:
    T = np.eye(4)
    T[:3, 3] = xyz
    return Obstacle("box", Box(size), T)


def record(**changes: Any) -> PathRecord:
    """A record of a run that went well."""
    values: dict[str, Any] = {
        "problems": "p",
        "family": "pillar",
        "number": 1,
        "planner": "RRTConnect",
        "settings": "{}",
        "seed": 0,
        "solved": True,
        "valid_first": True,
        "valid": True,
        "collides": False,
        "fault": "",
        "setup_seconds": 0.002,
        "first_seconds": 0.01,
        "seconds": 0.02,
        "first_length": 3.0,
        "first_way": 2.0,
        "length": 1.5,
        "way": 1.0,
        "clearance": 0.01,
        "states": 100,
        "edges": 10,
        "step": 0.01,
        "first": [[0.0], [1.0]],
        "path": [[0.0], [1.0]],
        "host": "here",
        "finished": "2026-01-01T00:00:00+00:00",
    }
    return PathRecord(**(values | changes))
