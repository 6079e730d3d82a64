"""Wrench spaces against known answers and against a linear program."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog, minimize

from mmplan.grasps.contacts import EDGES, Contacts, soft_finger_wrenches
from mmplan.grasps.wrench_space import WrenchSpace
from mmplan.shapes import Array

SEEDS = st.integers(0, 10_000)
# A pyramid of that many edges lies in its cone, touching it at the edges only, and with
# the two corners of pure torsion in the ellipsoid of friction and torsion.
APOTHEM = np.cos(np.pi / EDGES)
INSCRIBED = APOTHEM / np.hypot(APOTHEM, 1.0)


def pushing(points: Array, normals: Array, arm: float) -> Contacts:
    """One grasp of k contacts (k, 3), all with one arm of torsion."""
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return Contacts(points[None], normals[None], np.full((1, len(points)), arm))


def wrenches(contacts: Contacts, friction: float) -> Array:
    return soft_finger_wrenches(contacts, friction)[0].reshape(-1, 6)


def space(contacts: Contacts, friction: float = 0.5) -> WrenchSpace:
    return WrenchSpace.of_wrenches(wrenches(contacts, friction))


def on_ball(half: float, arm: float) -> Contacts:
    """Two opposing contacts through the middle, `half` away from it."""
    points = half * np.array([[1.0, 0, 0], [-1, 0, 0]])
    return pushing(points, -points, arm)


def random_contacts(seed: int, k: int) -> Contacts:
    """Contacts on a unit ball that push inward, aslant."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(k, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return pushing(points, -points + rng.normal(0.0, 0.4, (k, 3)), 0.1)


@settings(max_examples=40)
@given(seed=SEEDS, k=st.integers(1, 5), friction=st.floats(0.1, 1.2))
def test_wrenches_keep_to_the_soft_finger_limit(
    seed: int, k: int, friction: float
) -> None:
    contacts = random_contacts(seed, k)
    found = soft_finger_wrenches(contacts, friction)[0]
    assert found.shape == (k, EDGES + 2, 6)
    for finger, (p, n) in enumerate(
        zip(contacts.points[0], contacts.normals[0], strict=True)
    ):
        force, torque = np.split(found[finger], 2, axis=1)
        np.testing.assert_allclose(force @ n, 1.0)
        slide = np.linalg.norm(force - n, axis=1)
        own = torque - np.cross(p, force)
        np.testing.assert_allclose(np.cross(own, n), 0.0, atol=1e-12)
        limit = slide**2 + (own @ n / 0.1) ** 2
        np.testing.assert_allclose(limit, friction**2)


@pytest.mark.parametrize("half", [0.3, 1.0])
@pytest.mark.parametrize("arm", [0.02, 0.9])
@pytest.mark.parametrize("friction", [0.2, 0.8])
def test_two_opposing_contacts_on_a_ball(
    half: float, arm: float, friction: float
) -> None:
    """Pyramids resist less than the round cones, and more than the cones inside."""
    epsilon = space(on_ball(half, arm), friction).epsilon
    assert epsilon <= round_epsilon(half, arm, friction) * (1 + 1e-6)
    assert epsilon >= round_epsilon(half, arm, INSCRIBED * friction) * (1 - 1e-6)
    # Pushed across the line, turned about it, turned across it.
    assert epsilon <= friction * min(1.0, arm, half) * (1 + 1e-9)


def round_epsilon(half: float, arm: float, friction: float) -> float:
    """Epsilon of two opposing soft fingers with round cones, minimized numerically."""

    def support(w: Array) -> Array:
        w = w / np.linalg.norm(w, axis=-1, keepdims=True)
        sides = []
        for x in (half, -half):
            slide = w[..., 1:3] + x * np.stack([w[..., 5], -w[..., 4]], axis=-1)
            slip = np.sqrt((slide**2).sum(axis=-1) + (arm * w[..., 3]) ** 2)
            sides.append(-np.sign(x) * w[..., 0] + friction * slip)
        return np.maximum(*sides)

    ways = np.random.default_rng(0).normal(size=(20_000, 6))
    best = ways[np.argsort(support(ways))[:4]]
    options = {"maxiter": 800, "xatol": 1e-9, "fatol": 1e-12}
    return min(
        minimize(support, w, method="Nelder-Mead", options=options).fun
        for w in [*np.eye(6)[3:], *best]
    )


def test_small_pads_are_weakest_in_turning_about_the_line_between_them() -> None:
    epsilon = space(on_ball(1.0, 0.005)).epsilon
    assert epsilon == pytest.approx(0.5 * 0.005, rel=1e-3)


def test_two_points_without_torsion_never_close() -> None:
    assert not space(on_ball(1.0, 0.0)).closes
    assert space(on_ball(1.0, 0.0)).volume == 0.0


@pytest.mark.parametrize(
    ("slant", "closes"), [(0.0, True), (0.8, True), (1.05, False), (2.0, False)]
)
@pytest.mark.parametrize("friction", [0.3, 0.7])
def test_contacts_on_a_cube_close_where_their_line_is_in_both_cones(
    slant: float, friction: float, closes: bool
) -> None:
    """Nguyen's criterion; the line is at `slant` times the cone's angle."""
    shift = slant * friction
    points = np.array([[1.0, shift, 0], [-1, -shift, 0]])
    contacts = pushing(points, np.array([[-1.0, 0, 0], [1, 0, 0]]), 0.1)
    assert space(contacts, friction).closes == closes


@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_three_fingers_on_a_disc(friction: float) -> None:
    """One pushes alone one way, two push together the other way."""
    angle = 2 * np.pi * np.arange(3) / 3
    points = np.stack([np.cos(angle), np.sin(angle), np.zeros(3)], axis=1)
    held = space(pushing(points, -points, 0.1), friction)
    assert held.closes
    with_one, with_two = np.zeros((1, 6)), np.zeros((1, 6))
    with_one[0, 0], with_two[0, 0] = -1.0, 1.0
    assert held.margin(with_one) == pytest.approx(1.0)
    both = np.cos(np.pi / 3) + friction * np.sin(np.pi / 3)
    assert held.margin(with_two) == pytest.approx(both)
    assert held.margin(np.concatenate([with_one, with_two])) == pytest.approx(both)


def test_fingers_on_one_side_do_not_close() -> None:
    points = np.array([[1.0, 0, 0], [0.9, 0.3, 0], [0.9, -0.3, 0.2]])
    held = space(pushing(points, -points, 0.1))
    assert (held.epsilon, held.margin(np.ones((1, 6)))) == (0.0, 0.0)


def room_of_weights(found: Array) -> float:
    """The largest d with weights of at least d that cancel all wrenches (w, 6).

    Above 0, where the wrenches span all directions: force closure.
    """
    n = len(found)
    cancel = np.hstack([found.T, np.zeros((6, 1))])
    whole = np.append(np.ones(n), 0.0)[None]
    least = np.hstack([-np.eye(n), np.ones((n, 1))])
    solution = linprog(
        np.append(np.zeros(n), -1.0),
        A_ub=least,
        b_ub=np.zeros(n),
        A_eq=np.vstack([cancel, whole]),
        b_eq=np.append(np.zeros(6), 1.0),
        bounds=[(None, None)] * (n + 1),
    )
    return float(-solution.fun) if solution.success else -1.0


@settings(max_examples=150)
@given(seed=SEEDS, k=st.integers(2, 5), friction=st.floats(0.1, 1.0))
def test_force_closure_is_that_of_a_linear_program(
    seed: int, k: int, friction: float
) -> None:
    contacts = random_contacts(seed, k)
    found = wrenches(contacts, friction)
    room = room_of_weights(found)
    assume(abs(room) > 1e-6)
    closes = room > 0.0 and np.linalg.matrix_rank(found) == 6
    assert WrenchSpace.of_wrenches(found).closes == closes


@settings(max_examples=40)
@given(seed=SEEDS, k=st.integers(2, 4))
def test_epsilon_is_the_least_support_in_any_direction(seed: int, k: int) -> None:
    contacts = on_ball(0.6, 0.1) if k == 2 else random_contacts(seed, k)
    found = wrenches(contacts, 0.8)
    held = WrenchSpace.of_wrenches(found)
    assume(held.closes)
    ways = np.random.default_rng(seed).normal(size=(500, 6))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    assert np.all((ways @ found.T).max(axis=1) >= held.epsilon - 1e-9)
    weakest = held.facets[held.facets[:, 6].argmax(), :6]
    assert (found @ weakest).max() == pytest.approx(held.epsilon, abs=1e-8)
    margins = [held.margin(way[None]) for way in ways[:20]]
    assert min(margins) >= held.epsilon - 1e-9


@given(seed=SEEDS, scale=st.floats(0.01, 100.0))
def test_the_unit_of_length_and_the_origin_do_not_matter(
    seed: int, scale: float
) -> None:
    contacts = on_ball(0.5, 0.1)
    shift = np.random.default_rng(seed).normal(size=3)
    moved = Contacts(
        scale * contacts.points + shift, contacts.normals, scale * contacts.arms
    )
    back = moved.about(shift, scale)
    assert space(back).epsilon == pytest.approx(space(contacts).epsilon, rel=1e-6)
    assert space(back).volume == pytest.approx(space(contacts).volume, rel=1e-4)
