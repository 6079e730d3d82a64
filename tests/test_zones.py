"""Forbidden zones: their geometry, and that search, paths and proof keep out."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.collision import CollisionWorld
from mmplan.hermite import HermiteCurve
from mmplan.motion.zoned_world import with_zones
from mmplan.optimizers import search_space
from mmplan.pipeline import score_function, solve
from mmplan.planning import plan_path, transit_joints
from mmplan.scene_file import load_problem
from mmplan.scoring import End, Outcome
from mmplan.shapes import Array
from mmplan.verification import examine
from mmplan.zones import Zone, base_clearances
from tests.tabletop import cup_problem, cup_scene

SEEDS = st.integers(0, 2**32 - 1)
# Before the table, between where the robot starts and where it has to go.
WALL = Zone(
    "forbidden zone 1",
    np.array([[-0.6, -0.5], [-0.4, -0.5], [-0.4, 1.2], [-0.6, 1.2]]),
)


def star(rng: np.random.Generator) -> Zone:
    """A polygon with corners in all directions from the origin, often not convex."""
    k = int(rng.integers(3, 9))
    angles = (np.arange(k) + rng.uniform(0.1, 0.9, k)) * 2 * np.pi / k
    radii = rng.uniform(0.3, 2.0, k)
    return Zone("star", np.stack([radii * np.cos(angles), radii * np.sin(angles)], 1))


def outline(zone: Zone, parts: int = 2000) -> Array:
    t = np.linspace(0.0, 1.0, parts)[:, None]
    ends = zip(zone.corners, np.roll(zone.corners, -1, axis=0), strict=True)
    return np.concatenate([a + t * (b - a) for a, b in ends])


@given(SEEDS)
def test_distances_are_those_to_the_outline(seed: int) -> None:
    rng = np.random.default_rng(seed)
    zone = star(rng)
    points = rng.uniform(-3, 3, (20, 2))
    apart = np.linalg.norm(points[:, None] - outline(zone), axis=2).min(axis=1)
    np.testing.assert_allclose(np.abs(zone.distances(points)), apart, atol=2e-3)


@given(SEEDS)
def test_the_inside_of_a_star_is_what_its_middle_sees(seed: int) -> None:
    rng = np.random.default_rng(seed)
    zone = star(rng)
    points = outline(zone, 7)
    if zone.distances(np.zeros((1, 2)))[0] >= 0.0:
        return  # its widest gap is above half a turn
    assert np.all(zone.distances(0.999 * points) < 0.0)
    assert np.all(zone.distances(1.001 * points) > 0.0)


@given(SEEDS)
def test_distances_do_not_depend_on_where_the_outline_begins(seed: int) -> None:
    rng = np.random.default_rng(seed)
    zone, points = star(rng), rng.uniform(-3, 3, (20, 2))
    for corners in (np.roll(zone.corners, 1, axis=0), zone.corners[::-1]):
        again = Zone("again", corners).distances(points)
        np.testing.assert_allclose(again, zone.distances(points), atol=1e-12)


def test_the_circle_must_keep_out_and_not_only_its_middle() -> None:
    square = Zone("square", np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]))
    q_base = np.array([[-0.5, 0.5, 3.0], [-0.2, 0.5, 0.0], [0.5, 0.5, 0.0]])
    clearances = base_clearances([square], q_base, 0.3)
    np.testing.assert_allclose(clearances, [0.2, -0.1, -0.8])
    assert np.all(np.isinf(base_clearances([], q_base, 0.3)))


def test_no_placement_is_drawn_in_a_zone() -> None:
    problem = replace(cup_problem(), forbidden=(WALL,))
    score, radius = score_function(problem), problem.robot.base_radius
    free = score_function(cup_problem())
    rng = np.random.default_rng(0)
    q_base = rng.uniform([-1.5, -1.5], [1.5, 1.5], (300, 2))
    inside = base_clearances([WALL], q_base, radius) < 0.0
    outcomes = score.base_outcomes(End.START, q_base)
    assert 20 < inside.sum() < 280
    assert np.all(outcomes[inside] == Outcome.OUT_OF_BOUNDS)
    expected = free.base_outcomes(End.START, q_base)
    assert np.array_equal(outcomes[~inside], expected[~inside])
    placements = search_space(score).bases[End.START]
    drawn = placements.q_base(placements.sample(100, rng))
    assert np.all(base_clearances([WALL], drawn, radius) >= 0.0)


@pytest.mark.parametrize("seed", range(3))
def test_paths_go_round_a_zone(seed: int) -> None:
    problem = replace(cup_problem(), forbidden=(WALL,))
    world = CollisionWorld.of_problem(problem)
    q_goal = problem.q_start.copy()
    q_goal[:2] = 0.0, 1.2
    ends = problem.q_start, q_goal
    zoned = with_zones(world, problem, *ends)
    assert zoned.any_collision(np.linspace(*ends, 100))
    assert not world.any_collision(np.linspace(*ends, 100))
    rng = np.random.default_rng(seed)
    settings = problem.planner
    joints = transit_joints(problem)
    path = plan_path(zoned, ends[0], q_goal[None], joints, settings, rng).path
    assert path is not None
    finely = np.concatenate([np.linspace(a, b, 500) for a, b in pairwise(path)])
    assert base_clearances([WALL], finely, problem.robot.base_radius).min() > 0.0


def test_what_is_in_the_way_is_named() -> None:
    problem = replace(cup_problem(), forbidden=(WALL,))
    world = CollisionWorld.of_problem(problem)
    q = problem.q_start.copy()
    q[:2] = -0.5, 0.0
    zoned = with_zones(world, problem, problem.q_start)
    assert tuple(zoned.contacts(q)[0]) == ("the base", "forbidden zone 1")


def test_a_plan_keeps_out_and_a_zone_across_its_way_is_found() -> None:
    problem = replace(cup_problem(), forbidden=(WALL,))
    plan = solve(problem, seed=0)
    curves = [
        HermiteCurve(s.times, s.positions, s.velocities) for s in plan.tasks[0].segments
    ]
    q = np.concatenate([c.positions(np.arange(0, c.times[-1], 1e-3)) for c in curves])
    assert base_clearances([WALL], q, problem.robot.base_radius).min() > -1e-6
    assert examine(plan, problem).ok
    # A zone as small as a pin, right beside the way.
    way = q[:, :2][len(q) // 8]
    assert np.abs(way - problem.q_start[:2]).max() > 0.01, "the base has moved"
    pin = Zone("pin", way + np.array([[0.0, 0], [1e-3, 0], [0, 1e-3]]))
    report = examine(plan, replace(problem, forbidden=(WALL, pin)))
    assert {fault.kind for fault in report.faults} == {"zone"}
    assert "in pin at t =" in report.faults[0].message


def test_zones_of_a_scene_file(tmp_path: Path) -> None:
    text = (
        "{model: puma_mobile, start: {base: [-1.0, 0.0], arm: tucked}, forbidden: "
        "[{box: [[-2, -1.5], [1, 2]]}, {polygon: [[3, 3], [4, 3], [3, 4]]}]}"
    )
    path = cup_scene(tmp_path)
    lines, kept = path.read_text().splitlines(), []
    for line in lines:
        inside = kept and kept[-1].startswith("robot:") and line.startswith(" ")
        if not inside:
            kept.append(f"robot: {text}" if line.startswith("robot:") else line)
    path.write_text("\n".join(kept))
    box, polygon = load_problem(path).forbidden
    assert box.corners.tolist() == [[-2, 1], [-1.5, 1], [-1.5, 2], [-2, 2]]
    assert polygon.corners.tolist() == [[3, 3], [4, 3], [3, 4]]
    assert (box.name, polygon.name) == ("forbidden zone 1", "forbidden zone 2")
