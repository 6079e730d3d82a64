"""Distances of links are the least of all pairs, whatever bounds let be skipped."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from mmplan.collision import CollisionWorld, LinkDistances, make_exact
from mmplan.problem import Object, Obstacle
from mmplan.shapes import Array, Box, Sphere
from tests.collision.worlds import (
    SCENES,
    among,
    carrying,
    draw,
    fresh_data,
    held_at,
    q_tucked,
    shipped,
)
from tests.honest import shift

MANY = 150
ROBOT, OBSTACLES = ("base", "arm", "finger"), ("ground", "obstacle", "standing")


@cache
def distances_in(name: str) -> LinkDistances:
    return LinkDistances(shipped(name))


def all_of(distances: LinkDistances, q: Array) -> dict[str, Array]:
    values = distances(q, np.arange(len(distances.links)))
    return dict(zip(distances.links, values.T, strict=True))


def brute_force(world: CollisionWorld, q: Array) -> dict[str, Array]:
    """The least distance (n,) of each link over all pairs, by `computeDistances`."""
    geometry, bodies = world.geometry.clone(), world.bodies
    geometry.removeAllCollisionPairs()
    owners = []
    for i, body in enumerate(bodies):
        for j, other in enumerate(bodies):
            if body.kind not in ROBOT or other.kind not in OBSTACLES:
                continue
            if (body.kind, other.kind) != ("base", "ground"):
                geometry.addCollisionPair(pin.CollisionPair(i, j))
                owners.append(body.owner)
    data, geometry_data = world.model.createData(), geometry.createData()
    make_exact(geometry_data)
    rows = []
    for row in q:
        pin.computeDistances(world.model, data, geometry, geometry_data, row)
        rows.append([r.min_distance for r in geometry_data.distanceResults])
    found = np.array(rows)
    return {o: found[:, np.array(owners) == o].min(axis=1) for o in set(owners)}


@pytest.mark.parametrize("name", SCENES)
def test_distances_are_the_least_of_all_pairs(name: str) -> None:
    q = draw(MANY, 7)
    found = all_of(distances_in(name), q)
    expected = brute_force(shipped(name), q)
    assert set(found) == set(expected)
    for link, values in found.items():
        apart = np.maximum(values, 0.0), np.maximum(expected[link], 0.0)
        np.testing.assert_allclose(*apart, atol=1e-9, err_msg=link)
        assert np.all((values <= 0.0) == (expected[link] <= 0.0))


@pytest.mark.parametrize("name", SCENES)
def test_some_links_are_the_same_as_all(name: str) -> None:
    distances, q = distances_in(name), draw(20, 8)
    everything = distances(q, np.arange(len(distances.links)))
    for links in (np.array([0]), np.array([1, 3, 4]), np.array([2, 6])):
        np.testing.assert_array_equal(distances(q, links), everything[:, links])


def test_a_batch_is_the_same_as_its_rows_in_any_order() -> None:
    distances, q = distances_in("plate"), draw(30, 9)
    links = np.arange(len(distances.links))
    together = distances(q, links)
    for row in np.random.default_rng(0).permutation(30):
        np.testing.assert_array_equal(distances(q[row][None], links)[0], together[row])


def test_a_link_overlaps_an_obstacle_where_its_distance_is_not_positive() -> None:
    distances, q = distances_in("wineglass"), draw(60, 10)
    values = all_of(distances, q)
    for row, configuration in enumerate(q):
        contacts = shipped("wineglass").contacts(configuration)
        hit = {c.first for c in contacts} & set(distances.links)
        scenery = {c.first for c in contacts if c.second not in distances.links}
        assert {link for link, d in values.items() if d[row] <= 0.0} == hit & scenery


def test_the_ground_counts_for_the_arm_and_not_for_the_base() -> None:
    floor = Obstacle("floor", Box((8, 8, 0.1)), shift(0, 0, -0.05), ground=True)
    q = q_tucked()[None]
    found = all_of(LinkDistances(among(floor)), q)
    assert found["base"][0] == np.inf
    assert 0.2 < found["forearm"][0] < 2.0
    wall = Obstacle("wall", Box((0.1, 1, 1)), shift(1.05, 0, 0.5))
    found = all_of(LinkDistances(among(floor, wall)), q)
    assert found["base"][0] == pytest.approx(1.0 - 0.28, abs=1e-6)


def test_what_is_carried_or_left_out_is_no_obstacle() -> None:
    q = q_tucked()
    world = among(Object("ball", Sphere(0.1), shift(0.5, 0.0, 0.2)))
    assert all_of(LinkDistances(world), q[None])["base"][0] == pytest.approx(0.12)
    carried = held_at(world, "ball", q, shift(0.5, 0.0, 0.2))
    for other in (carried, world.without("ball")):
        found = all_of(LinkDistances(other), q[None])
        assert all(d == [np.inf] for d in found.values())


def test_no_configurations_have_no_distances() -> None:
    distances = distances_in("plate")
    none = np.empty((0, shipped("plate").model.nq))
    assert distances(none, np.array([0, 2])).shape == (0, 2)


def test_the_geometry_of_the_world_is_left_alone() -> None:
    world = carrying("wineglass", "attached")
    pairs = len(world.geometry.collisionPairs)
    all_of(LinkDistances(world), draw(1, 0))
    assert len(world.geometry.collisionPairs) == pairs
    assert len(fresh_data(world).collisionRequests) == pairs
