import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.planning import PathChecker
from mmplan.planning.checking import even_fractions

RESOLUTION = 0.02


@given(st.lists(st.integers(1, 9), min_size=1, max_size=9))
def test_even_fractions_end_every_piece_at_one(counts):
    piece, fraction = even_fractions(np.array(counts))
    assert [list(piece).count(i) for i in range(len(counts))] == counts
    assert np.sum(fraction == 1.0) == len(counts)
    assert np.all(np.diff(piece + fraction) > 0.0)


@pytest.mark.parametrize("seed", range(200))
def test_a_wall_as_thick_as_the_resolution_is_never_jumped(stick_among, seed):
    rng = np.random.default_rng(seed)
    x = rng.uniform(-0.5, 0.5)
    world = stick_among(wall=(x, -10.0, x + RESOLUTION, 10.0))
    checker = PathChecker(world, RESOLUTION)
    q_left = np.array([x - rng.uniform(0.6, 1.4), *rng.uniform(-1.5, 1.5, 2)])
    q_right = np.array([x + rng.uniform(0.6, 1.4), *rng.uniform(-1.5, 1.5, 2)])
    assert not world.any_collision(np.array([q_left]))
    assert not checker.edge_free(q_left, q_right)
    blocked = checker.first_blocked_edge(np.vstack([q_left, q_left, q_right]))
    assert blocked is not None
    assert blocked[0] == 1
    assert world.any_collision(blocked[1][None])


def test_an_edge_is_checked_at_its_end_and_counted(stick_among):
    world = stick_among(post=(0.9, -0.1, 1.1, 0.1))
    checker = PathChecker(world, RESOLUTION)
    free, hit = np.array([-1.0, 0.0, 0.0]), np.array([0.45, 0.0, 0.0])
    assert checker.edge_free(free, free + np.array([0.1, 0.0, 0.0]))
    assert (checker.edges, checker.states) == (1, 5)
    assert not checker.edge_free(free, hit)


def test_the_first_point_counts_where_a_path_is_followed(stick_among):
    world = stick_among(post=(-0.1, -0.1, 0.1, 0.1))
    path = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    edge, q = PathChecker(world, RESOLUTION).first_blocked_edge(path)
    assert edge == 0
    assert q == pytest.approx(path[0])
