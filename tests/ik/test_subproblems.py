"""Laws of the canonical subproblems, on random vectors."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.ik.rotation import along, cross, dot, rotate
from mmplan.ik.subproblems import (
    subproblem_1,
    subproblem_2,
    subproblem_3,
    subproblem_4,
)
from mmplan.shapes import Array

SLACK = 1e-12
M = 40
seeds = st.integers(0, 2**32 - 1)


def axis(rng: np.random.Generator) -> Array:
    """A unit vector: now any, now a coordinate axis, either way."""
    if rng.random() < 0.5:
        return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def vectors(rng: np.random.Generator) -> Array:
    return rng.normal(size=(3, M))


def apart(a: Array, b: Array) -> Array:
    return np.abs((a - b + np.pi) % (2 * np.pi) - np.pi)


@given(seeds)
def test_rotate_is_the_exponential_of_the_axis(seed: int) -> None:
    rng = np.random.default_rng(seed)
    h, angle, v = axis(rng), rng.uniform(-7, 7, M), vectors(rng)
    expected = np.stack(
        [pin.exp3(h * a) @ x for a, x in zip(angle, v.T, strict=True)], axis=1
    )
    np.testing.assert_allclose(rotate(h, angle, v), expected, atol=1e-13)
    np.testing.assert_allclose(along(h, v), h @ v, atol=1e-14)
    np.testing.assert_allclose(cross(v, v[:, ::-1])[:, 0], np.cross(v[:, 0], v[:, -1]))


@given(seeds)
def test_1_finds_the_angle_that_was_turned_by(seed: int) -> None:
    rng = np.random.default_rng(seed)
    h, angle, start = axis(rng), rng.uniform(-np.pi, np.pi, M), vectors(rng)
    found = subproblem_1(h, start, rotate(h, angle, start))
    assert apart(found, angle).max() < 1e-9


@given(seeds)
def test_1_comes_nearest_where_it_cannot_reach(seed: int) -> None:
    rng = np.random.default_rng(seed)
    h, start, end = axis(rng), vectors(rng), vectors(rng)
    best = np.linalg.norm(rotate(h, subproblem_1(h, start, end), start) - end, axis=0)
    for angle in np.linspace(-np.pi, np.pi, 25):
        other = rotate(h, np.full(M, angle), start) - end
        assert np.all(best <= np.linalg.norm(other, axis=0) + 1e-12)


@given(seeds)
def test_2_brings_vectors_together_and_finds_the_source(seed: int) -> None:
    rng = np.random.default_rng(seed)
    h1, h2 = axis(rng), axis(rng)
    if np.linalg.norm(np.cross(h1, h2)) < 0.1:
        return
    angles = rng.uniform(-np.pi, np.pi, (2, M))
    start_2 = vectors(rng)
    start_1 = rotate(-h1, angles[0], rotate(h2, angles[1], start_2))
    found = subproblem_2(h1, start_1, h2, start_2, SLACK)
    assert found.exists[0].all()
    for first, second, exists in zip(*found, strict=True):
        miss = rotate(h1, first, start_1) - rotate(h2, second, start_2)
        assert np.abs(miss[:, exists]).max(initial=0.0) < 1e-6
    difference = apart(found.first, angles[0]) + apart(found.second, angles[1])
    assert np.median(difference.min(axis=0)) < 1e-9
    assert np.where(found.exists, difference, 9.0).min(axis=0).max() < 1e-4


@given(seeds)
def test_3_brings_a_point_to_its_distance(seed: int) -> None:
    rng = np.random.default_rng(seed)
    h, angle = axis(rng), rng.uniform(-np.pi, np.pi, M)
    start, centre = vectors(rng), vectors(rng)
    wanted = rotate(h, angle, start) - centre
    found = subproblem_3(h, start, centre, dot(wanted, wanted), SLACK)
    assert found.exists[0].all()
    assert (
        np.where(found.exists, apart(found.values, angle), 9).min(axis=0).max() < 1e-4
    )
    for values in found.values:
        seen = rotate(h, values, start) - centre
        np.testing.assert_allclose(dot(seen, seen), dot(wanted, wanted), atol=1e-9)


@given(seeds, st.floats(1.001, 3.0))
def test_4_has_no_solution_above_the_circle(seed: int, factor: float) -> None:
    rng = np.random.default_rng(seed)
    h, start, normal = axis(rng), vectors(rng), vectors(rng)
    middle = along(h, start) * along(h, normal)
    top = np.sqrt(dot(start, start) - along(h, start) ** 2) * np.sqrt(
        dot(normal, normal) - along(h, normal) ** 2
    )
    assert not subproblem_4(h, start, normal, middle + factor * top, SLACK).exists.any()
    below = subproblem_4(h, start, normal, middle + top / factor, SLACK)
    assert below.exists.all()
    assert apart(*below.values).min() > 1e-6


def test_4_has_one_solution_at_the_top() -> None:
    z, x = np.array([0.0, 0.0, 1.0]), np.array([[1.0], [0.0], [0.0]])
    found = subproblem_4(z, x, x, np.array([1.0]), SLACK)
    assert found.exists.tolist() == [[True], [False]]
    assert found.values[0] == pytest.approx(0.0)


def test_4_takes_angle_0_where_any_will_do() -> None:
    z = np.array([0.0, 0.0, 1.0])
    found = subproblem_4(z, z[:, None], z[:, None], np.array([1.0, 0.5]), SLACK)
    assert found.exists.tolist() == [[True, False], [False, False]]
    assert found.values[0, 0] == 0.0
