"""Path-planning problems in a file: arm configurations among simple shapes."""

from __future__ import annotations

import gzip
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mmplan.problem import Obstacle
from mmplan.shapes import Array, Box, Cylinder, Shape, Sphere, read_only


@dataclass(frozen=True, eq=False)
class PathProblem:
    """A start and a goal of the arm, and what is in the way."""

    family: str
    index: int
    q_start: Array  # (arm joints,)
    q_goal: Array
    obstacles: tuple[Obstacle, ...]

    @property
    def name(self) -> str:
        """What tells the problem from all others of its file."""
        return f"{self.family} {self.index}"


def load_path_problems(path: Path) -> tuple[PathProblem, ...]:
    """The problems of a file, family by family."""
    content = path.read_bytes()
    text = gzip.decompress(content) if path.suffix == ".gz" else content
    families = json.loads(text)
    return tuple(_problem(p) for problems in families.values() for p in problems)


def _problem(data: dict[str, Any]) -> PathProblem:
    return PathProblem(
        family=data["family"],
        index=data["index"],
        q_start=read_only(data["start"]),
        q_goal=read_only(data["goal"]),
        obstacles=tuple(
            Obstacle(o["name"], _shape(o["type"], o["dims"]), read_only(o["pose"]))
            for o in data["objects"]
        ),
    )


def _shape(kind: str, dims: list[float]) -> Shape:
    if kind == "box":
        x, y, z = dims
        return Box((x, y, z))
    if kind == "cylinder":
        length, radius = dims
        return Cylinder(radius, length)
    return Sphere(*np.ravel(dims).tolist())
