"""What the world answers is what coal says of every pair, however it is asked."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from mmplan.collision import supports
from mmplan.shapes import Array
from tests.collision.worlds import (
    SCENES,
    carrying,
    draw,
    fresh_data,
    held_at,
    pair_distances,
    q_tucked,
    scene,
    shipped,
)
from tests.honest import shift

MANY, SOME, FEW = 1000, 250, 25
# Distances this near to what is allowed are left to coal's rounding, m.
UNSURE = 1e-6

everywhere = pytest.mark.parametrize(
    ("name", "where"), [(n, w) for n in SCENES for w in ("standing", "attached")]
)


@cache
def answers(name: str, where: str) -> Array:
    """What the world says of `draw(MANY, 0)`, all at once."""
    return carrying(name, where).in_collision(draw(MANY, 0))


@everywhere
def test_the_configurations_are_worth_asking_about(name: str, where: str) -> None:
    assert 0.1 < answers(name, where).mean() < 0.9


@everywhere
def test_a_batch_is_the_same_as_all_pairs_one_by_one(name: str, where: str) -> None:
    """In another order, with geometry data that is used again and again."""
    world, q = carrying(name, where), draw(MANY, 0)
    data, geometry_data = world.model.createData(), fresh_data(world)
    for row in np.random.default_rng(1).permutation(MANY):
        collides = pin.computeCollisions(
            world.model, data, world.geometry, geometry_data, q[row], True
        )
        assert collides == answers(name, where)[row]


@everywhere
def test_a_batch_is_the_same_as_single_questions(name: str, where: str) -> None:
    world, q = carrying(name, where), draw(MANY, 0)
    for row in np.random.default_rng(2).permutation(MANY)[:SOME]:
        assert world.in_collision(q[row : row + 1])[0] == answers(name, where)[row]


@everywhere
def test_a_batch_is_the_same_as_fresh_data_each_time(name: str, where: str) -> None:
    world, q = carrying(name, where), draw(MANY, 0)
    data = world.model.createData()
    for row in np.random.default_rng(3).permutation(MANY)[:FEW]:
        fresh = fresh_data(world)
        collides = pin.computeCollisions(
            world.model, data, world.geometry, fresh, q[row], True
        )
        assert collides == answers(name, where)[row]


@everywhere
def test_the_order_of_a_batch_does_not_matter(name: str, where: str) -> None:
    order = np.random.default_rng(4).permutation(MANY)
    shuffled = carrying(name, where).in_collision(draw(MANY, 0)[order])
    np.testing.assert_array_equal(shuffled, answers(name, where)[order])


@everywhere
def test_any_collision_is_any_of_the_answers(name: str, where: str) -> None:
    world, q, expected = carrying(name, where), draw(MANY, 0), answers(name, where)
    free = q[~expected]
    assert not world.any_collision(free)
    assert world.any_collision(np.concatenate([free, q[expected][:1]]))
    for start in range(0, MANY, 50):
        batch = slice(start, start + 3)
        assert world.any_collision(q[batch]) == expected[batch].any()


@everywhere
def test_contacts_are_the_overlapping_pairs_with_their_depths(
    name: str, where: str
) -> None:
    world, q = carrying(name, where), draw(MANY, 0)
    for row in np.random.default_rng(5).permutation(MANY)[:FEW]:
        contacts = world.contacts(q[row])
        assert bool(contacts) == answers(name, where)[row]
        depths: dict[tuple[str, str], float] = {}
        for (i, j), distance in zip(
            world.pairs.tolist(), pair_distances(world, q[row]), strict=True
        ):
            key = (world.owner_of(i), world.owner_of(j))
            depths[key] = max(-distance, depths.get(key, -np.inf))
        overlapping = {key for key, depth in depths.items() if depth > UNSURE}
        found = {(c.first, c.second): c.depth for c in contacts}
        assert overlapping <= set(found)
        for key, depth in found.items():
            assert depth == pytest.approx(depths[key], abs=1e-5)
        assert [c.depth for c in contacts] == sorted(found.values(), reverse=True)


@pytest.mark.parametrize("name", SCENES)
def test_a_stated_depth_is_allowed_and_no_more(name: str) -> None:
    """An object around the place where it stands, allowed 1 mm into its support."""
    world, q = shipped(name), q_tucked(-0.5, 0.5)
    (item,) = scene(name).objects
    below = supports(world.scenery, item.name, item.T_world_object, 0.001)
    seen = set()
    for height in np.linspace(-0.0025, 0.0015, 8):
        T = shift(0.0, 0.0, height) @ item.T_world_object
        held = held_at(world, item.name, q, T).permit_touch(item.name, supports=below)
        margins = pair_distances(held, q) + held.allowed_depth
        assert np.abs(margins).min() > UNSURE
        assert held.in_collision(q[None])[0] == (margins.min() <= 0.0)
        seen.add(bool(margins.min() <= 0.0))
    assert seen == {True, False}


def test_no_configurations_have_no_answers() -> None:
    world = shipped("wineglass")
    none = np.empty((0, world.model.nq))
    assert world.in_collision(none).shape == (0,)
    assert not world.any_collision(none)
