"""Upper bounds of distances hold, and are not far off."""

from __future__ import annotations

import coal
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.collision import LinkBounds, LinkDistances
from mmplan.collision.inner_balls import inner_balls
from mmplan.collision.meshes import hull
from mmplan.collision.separation import signed_distance, transform
from mmplan.kinematics import joint_placements
from mmplan.problem import Object
from mmplan.shapes import Array, Sphere
from tests.collision.worlds import SCENES, among, draw, q_tucked, shipped
from tests.honest import shift

SHAPES = {
    "sphere": coal.Sphere(0.2),
    "capsule": coal.Capsule(0.1, 0.4),
    "rod": coal.Cylinder(0.05, 0.5),
    "disc": coal.Cylinder(0.4, 0.05),
    "box": coal.Box(0.1, 0.6, 0.2),
    "cube": coal.Box(0.3, 0.3, 0.3),
    "cone": coal.Cone(0.2, 0.5),
    "hull": hull(np.random.default_rng(0).normal(size=(60, 3)) * [0.1, 0.2, 0.3] + 0.3),
    "tetrahedron": hull(np.concatenate([np.eye(3), np.zeros((1, 3))])),
}
POINT = coal.Sphere(1e-6)


@pytest.mark.parametrize("name", SHAPES)
@given(x=st.tuples(*[st.floats(-2.0, 2.0)] * 3))
def test_no_body_is_further_from_a_point_than_its_balls(
    name: str, x: tuple[float, float, float]
) -> None:
    body, at_x = SHAPES[name], transform(shift(*x))
    distance = signed_distance(body, transform(np.eye(4)), POINT, at_x)
    balls = inner_balls(body)
    bounds = np.linalg.norm(balls.centres - x, axis=1) - balls.radii
    assert max(distance, 0.0) <= max(bounds.min(), 0.0) + 1e-5


def bounds_and_distances(name: str, q: Array) -> tuple[Array, Array]:
    world = shipped(name)
    exact = LinkDistances(world)
    arm = [k for k, link in enumerate(exact.links) if link != "base"]
    bounds = LinkBounds(world, tuple(exact.links[k] for k in arm))
    T = joint_placements(world.model, q)
    distances = np.maximum(exact(q, np.array(arm)), 0.0)
    # Nodes are found anew by the first half and known to the second.
    half = len(q) // 2
    return np.concatenate([bounds(T[:half]), bounds(T[half:])]), distances


@pytest.mark.parametrize("name", SCENES)
def test_bounds_hold_and_are_close(name: str) -> None:
    bounds, distances = bounds_and_distances(name, draw(150, 3))
    assert np.all(bounds >= distances)
    assert np.median(bounds - distances) < 0.03


def test_bounds_hold_far_beyond_the_grid() -> None:
    q = draw(30, 4)
    q[15:, :2] += 50.0
    bounds, distances = bounds_and_distances("wineglass", q)
    assert np.all(bounds >= distances)
    assert np.median(bounds[15:] - distances[15:]) < 20.0


def test_without_obstacles_there_is_no_bound() -> None:
    world = among(Object("ball", Sphere(0.1), shift(1.0, 0.0, 0.2))).without("ball")
    bounds = LinkBounds(world, ("forearm",))
    assert bounds(joint_placements(world.model, q_tucked()[None])) == [[np.inf]]


def test_distances_are_the_same_with_bounds_given() -> None:
    world, q = shipped("wineglass"), draw(60, 5)
    exact = LinkDistances(world)
    links = np.arange(1, 5)
    bounds = LinkBounds(world, tuple(exact.links[k] for k in links))
    most = bounds(joint_placements(world.model, q))
    needed = np.random.default_rng(0).random((60, 4)) < 0.5
    found = exact(q, links, needed, most)
    expected = np.where(needed, exact(q, links), np.inf)
    overlap = expected <= 0.0
    np.testing.assert_array_equal(found <= 0.0, overlap)
    np.testing.assert_array_equal(found[~overlap], expected[~overlap])
