"""Wrench spaces against known answers and against a linear program."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from mmplan.grasps.contacts import FORCES, Contacts, contact_wrenches
from mmplan.grasps.wrench_space import WrenchSpace
from mmplan.shapes import Array

SEEDS = st.integers(0, 10_000)
# Two opposite edges each of two directions: a pyramid of four edges.
INSCRIBED = np.cos(np.pi / 4)


def pushing(points: Array, normals: Array, half: float) -> Contacts:
    """One grasp of k contacts (k, 3), square patches with sides of twice `half`."""
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    u = np.cross(normals, [0.36, 0.48, 0.8])
    u *= half / np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(normals, u)
    corners = [points + u + v, points - u + v, points - u - v, points + u - v]
    return Contacts(np.stack(corners, axis=1)[None], normals[None])


def wrenches(contacts: Contacts, friction: float) -> Array:
    return contact_wrenches(contacts, friction)[0].reshape(-1, 6)


def space(contacts: Contacts, friction: float = 0.5) -> WrenchSpace:
    return WrenchSpace.of_wrenches(wrenches(contacts, friction))


def on_ball(away: float, half: float) -> Contacts:
    """Two opposing contacts through the middle, `away` from it."""
    points = away * np.array([[1.0, 0, 0], [-1, 0, 0]])
    return pushing(points, -points, half)


def random_contacts(seed: int, k: int) -> Contacts:
    """Contacts on a unit ball that push inward, aslant."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(k, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return pushing(points, -points + rng.normal(0.0, 0.4, (k, 3)), 0.1)


@settings(max_examples=40)
@given(seed=SEEDS, k=st.integers(1, 5), friction=st.floats(0.1, 1.2))
def test_forces_keep_to_the_law_of_coulomb_at_their_corners(
    seed: int, k: int, friction: float
) -> None:
    contacts = random_contacts(seed, k)
    found = contact_wrenches(contacts, friction)[0]
    assert found.shape == (k, FORCES, 6)
    for finger, (corners, n) in enumerate(
        zip(contacts.corners[0], contacts.normals[0], strict=True)
    ):
        force, torque = np.split(found[finger], 2, axis=1)
        np.testing.assert_allclose(force @ n, 1.0)
        slide = np.linalg.norm(force - n, axis=1)
        np.testing.assert_allclose(slide, friction)
        places = np.concatenate([corners, corners])
        np.testing.assert_allclose(torque, np.cross(places, force), atol=1e-12)


@settings(max_examples=60)
@given(seed=SEEDS, long=st.floats(0.0, 0.3), wide=st.floats(0.0, 0.3))
def test_a_patch_resists_torsion_by_friction_on_its_sides(
    seed: int, long: float, wide: float
) -> None:
    """At most what its corners can, and never much less than its longer side can."""
    contacts = random_contacts(seed, 2)
    flat = pushing(contacts.points[0], contacts.normals[0], 1.0)
    away = flat.corners - flat.points[:, :, None]
    u, v = away[:, :, 0] + away[:, :, 3], away[:, :, 0] + away[:, :, 1]
    sides = [long * u + wide * v, wide * v - long * u]
    corners = np.stack([sides[0], sides[1], -sides[0], -sides[1]], axis=2) / 2
    points = flat.points[:, :, None]
    found = contact_wrenches(Contacts(points + corners, flat.normals), 0.5)[0]
    at = np.cross(points[0], found[..., :3])
    torsion = np.einsum("kfi,ki->kf", found[..., 3:] - at, flat.normals[0])
    most = 0.5 * np.hypot(long, wide)
    assert np.all(np.abs(torsion) <= most + 1e-12)
    np.testing.assert_allclose(torsion.sum(axis=1), 0.0, atol=1e-12)
    assert np.all(torsion.max(axis=1) >= INSCRIBED * most - 1e-12)


@pytest.mark.parametrize("away", [0.3, 1.0])
@pytest.mark.parametrize("half", [0.02, 0.6])
@pytest.mark.parametrize("friction", [0.2, 0.8])
def test_two_opposing_contacts_on_a_ball(
    away: float, half: float, friction: float
) -> None:
    """Edges resist less than round cones, and more than what is certainly inside."""
    contacts = on_ball(away, half)
    held, found = space(contacts, friction), wrenches(contacts, friction)
    ways = np.random.default_rng(0).normal(size=(2000, 6))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    ways = np.concatenate([ways, held.facets[:, :6]])
    resisted = (ways @ found.T).max(axis=1)
    assert np.all(resisted <= round_support(contacts, friction, ways) + 1e-9)
    assert np.all(resisted >= inner_support(contacts, friction, ways) - 1e-9)
    assert held.epsilon == pytest.approx(resisted.min(), rel=1e-6)
    # Pushed across the line, turned about it.
    assert held.epsilon <= friction * min(1.0, np.sqrt(2.0) * half) * (1 + 1e-9)


def patches(contacts: Contacts) -> list[tuple[Array, Array]]:
    """The corners (4, 3) and the normal (3,) of each contact of one grasp."""
    return list(zip(contacts.corners[0], contacts.normals[0], strict=True))


def round_support(contacts: Contacts, friction: float, w: Array) -> Array:
    """How far wrenches of round cones at all corners go along directions (n, 6)."""
    return np.max(
        [
            along(corner, normal, friction, w)
            for corners, normal in patches(contacts)
            for corner in corners
        ],
        axis=0,
    )


def inner_support(contacts: Contacts, friction: float, w: Array) -> Array:
    """Likewise of cones inside the pyramids at the middles, and of normal forces."""
    middles = [
        along(corners.mean(axis=0), normal, INSCRIBED * friction, w)
        for corners, normal in patches(contacts)
    ]
    pressed = [
        along(corner, normal, 0.0, w)
        for corners, normal in patches(contacts)
        for corner in corners
    ]
    return np.max(middles + pressed, axis=0)


def along(point: Array, normal: Array, friction: float, w: Array) -> Array:
    """How far a round friction cone goes along directions (n, 6), (n,)."""
    push = w[:, :3] + np.cross(w[:, 3:], point)
    ahead = push @ normal
    across = np.linalg.norm(push - ahead[:, None] * normal, axis=1)
    found: Array = ahead + friction * across
    return found


def test_small_pads_are_weakest_in_turning_about_the_line_between_them() -> None:
    epsilon = space(on_ball(1.0, 0.005)).epsilon
    most = 0.5 * np.sqrt(2.0) * 0.005
    assert INSCRIBED * most * 0.999 <= epsilon <= most


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
    contacts = pushing(points, np.array([[-1.0, 0, 0], [1, 0, 0]]), 0.002)
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
    moved = Contacts(scale * contacts.corners + shift, contacts.normals)
    back = moved.about(shift, scale)
    assert space(back).epsilon == pytest.approx(space(contacts).epsilon, rel=1e-6)
    assert space(back).volume == pytest.approx(space(contacts).volume, rel=1e-4)
