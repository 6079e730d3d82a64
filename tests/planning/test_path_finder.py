"""Paths that are checked continuously: nothing is jumped, however thin it is."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from mmplan.collision import CollisionWorld, compile_motions
from mmplan.planning import (
    MovingJoints,
    PathChecker,
    PathOutcome,
    PathResult,
    path_finder,
    plan_path,
)
from mmplan.planning.metric import Metric
from mmplan.planning.search import Search
from mmplan.problem import Obstacle, PlannerSettings
from mmplan.shapes import Array, Box
from tests.collision.worlds import among, q_tucked
from tests.honest import shift

SHEET = 1e-3  # m
SETTINGS = PlannerSettings(
    motion_check="continuous", resolution=0.3, range=1.0, shortcuts=10, time_limit=60.0
)


def wall(door: float) -> CollisionWorld:
    """A sheet across the way of the base, with a door of a width (m) in it."""
    side = (4.0 - door) / 2.0
    y = (door + side) / 2.0
    return among(
        Obstacle("left", Box((SHEET, side, 3.0)), shift(0.0, y, 1.0)),
        Obstacle("right", Box((SHEET, side, 3.0)), shift(0.0, -y, 1.0)),
    )


def joints_of(world: CollisionWorld) -> MovingJoints:
    """The base within 2 m of the middle, and the arm."""
    robot = world.robot
    base = robot.base
    limit = np.where(base.wraps, np.inf, 2.0)
    near = replace(
        base,
        lower=np.where(base.wraps, base.lower, -limit),
        upper=np.where(base.wraps, base.upper, limit),
    )
    return MovingJoints.of_groups([near, robot.arm])


def path_through(world: CollisionWorld, seed: int, **settings: int) -> PathResult:
    q_from, q_to = q_tucked(-1.2, 1.0), q_tucked(1.2, 1.0)
    planner = replace(SETTINGS, **settings)  # type: ignore[arg-type]
    rng = np.random.default_rng(seed)
    compile_motions()
    return plan_path(world, q_from, q_to[None], joints_of(world), planner, rng)


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The iterations that each search was allowed."""
    allowed: list[int] = []
    search = path_finder.PathFinder._search

    def counted(
        self: path_finder.PathFinder, checker: PathChecker, *ends: Array
    ) -> Search:
        allowed.append(self.settings.iterations)
        return search(self, checker, *ends)

    monkeypatch.setattr(path_finder.PathFinder, "_search", counted)
    return allowed


def test_nothing_is_jumped_and_ways_are_mended(searches: list[int]) -> None:
    world = wall(door=1.0)
    for seed in range(4):
        result = path_through(world, seed)
        assert result.path is not None
        assert len(result.path) > 2
        for q, q_next in pairwise(result.path):
            assert not world.steps_collide(q, q_next - q, 300)
            assert not world.motion_collides(q, q_next - q)
    assert path_finder._MENDING in searches


def test_where_mending_fails_all_is_searched_anew(
    searches: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(path_finder, "_MENDING", 1)
    world = wall(door=1.0)
    whole = [SETTINGS.iterations] * 2
    again = 0
    for seed in range(4):
        searches.clear()
        result = path_through(world, seed)
        assert result.path is not None
        again += [n for n in searches if n > 1] == whole
        for q, q_next in pairwise(result.path):
            assert not world.motion_collides(q, q_next - q)
    assert again > 0


def test_straight_ways_are_one_edge() -> None:
    """Of steps that go straight on no waypoints are left."""
    world = wall(door=1.0)
    joints = joints_of(world)
    q_from, q_to = q_tucked(-1.2, 1.0), q_tucked(1.2, 1.0)
    finder = path_finder.PathFinder(joints, replace(SETTINGS, range=0.1), 3)
    checker = PathChecker(world, SETTINGS.resolution)
    found, path = finder.find(checker, q_from, q_to[None])
    assert path is not None
    assert found.waypoints is not None
    assert 2 < len(path) < len(found.waypoints)
    ways = np.diff(path, axis=0)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    assert np.all(np.sum(ways[1:] * ways[:-1], axis=1) < 1.0 - 1e-15)
    # Every waypoint that the planner went through lies on one of the edges.
    metric = Metric.of_joints(joints, checker.sweep.weights)
    through = metric.unwrapped(np.vstack([q_from, found.waypoints[1:]]))
    edges = list(pairwise(path))
    assert all(any(between(q, *edge) for edge in edges) for q in through)


def between(q: Array, q_from: Array, q_to: Array) -> bool:
    """Whether q is on the straight line between two others."""
    lengths = (np.linalg.norm(b - a) for a, b in ((q_from, q), (q, q_to)))
    return bool(sum(lengths) < np.linalg.norm(q_to - q_from) + 1e-9)


def test_no_way_is_found_through_a_closed_sheet() -> None:
    result = path_through(wall(door=0.0), 0, iterations=150)
    assert result.outcome is PathOutcome.ITERATIONS
