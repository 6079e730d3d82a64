"""Solids of revolution are enclosed by their pieces, and stay as hollow as they are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mmplan.collision import Scenery
from mmplan.collision.revolve import SURFACE_TOLERANCE, convex_pieces
from mmplan.collision.solids import geometries
from mmplan.problem import Object
from mmplan.shapes import Array, Revolve
from tests.collision.worlds import point_distance, scene

POINTS = 60  # felt for in each example
EXACT = 1e-7  # m

GLASS = np.array([*scene("wineglass").objects[0].shape.profile])
PLATE = np.array([*scene("plate").objects[0].shape.profile])
# A bottle's neck is wider than its throat and has a ring: r goes in and out with z.
JUG = np.array(
    [
        *([0, 0], [0.05, 0], [0.07, 0.05], [0.02, 0.1], [0.04, 0.11], [0.03, 0.12]),
        *([0.03, 0.15], [0.026, 0.15], [0.026, 0.12], [0.016, 0.1], [0.06, 0.05]),
        *([0.04, 0.01], [0.0, 0.01]),
    ]
)
TYRE = np.array([[0.2, -0.05], [0.3, -0.03], [0.28, 0.04], [0.22, 0.05]])
CONE = np.array([[0.0, 0.0], [0.1, 0.2], [0.0, 0.2]])
PIT = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.02]])  # a conical hollow
PROFILES = {
    "glass": GLASS,
    "plate": PLATE,
    "jug": JUG,
    "tyre": TYRE,
    "cone": CONE,
    "pit": PIT,
    "table": TYRE * [4.0, 1.0],
}

each_profile = pytest.mark.parametrize("name", PROFILES)


@st.composite
def vessels(draw: st.DrawFn) -> Array:
    """Profiles (n, 2) of anything from a rod to a cup, to fractions of a millimetre."""
    n = draw(st.integers(2, 6))
    steps = draw(st.lists(st.integers(1, 500), min_size=n - 1, max_size=n - 1))
    heights = np.cumsum([0, *steps]) * 1e-4
    outer = (
        np.array(draw(st.lists(st.integers(20, 900), min_size=n, max_size=n))) * 1e-4
    )
    wall = np.array(draw(st.lists(st.integers(5, 300), min_size=n, max_size=n))) * 1e-4
    inner = np.maximum(outer - wall, 0.0005)
    if draw(st.booleans()):  # open below, too
        return _outline(outer, heights, inner[::-1], heights[::-1])
    bottom = heights[0] + 0.3 * (heights[1] - heights[0])
    up = [*heights[:0:-1], bottom, bottom]
    # The hollow ends inside the lowest part, where the wall is at least as thick.
    floor = min(inner[0], np.interp(bottom, heights, inner))
    return _outline(outer, heights, [*inner[:0:-1], floor, 0.0], up, [0.0, 0.0])


def _outline(
    outer: Array, up: Array, inner: Array, down: Array, *start: list[float]
) -> Array:
    sides = np.stack([np.r_[outer, inner], np.r_[up, down]], axis=1)
    return np.concatenate([np.reshape(start, (-1, 2)), sides])


def signed_depths(profile: Array, points: Array) -> Array:
    """How deep points (n, 2) of (r, z) lie in the material, negative outside."""
    a, b = profile, np.roll(profile, -1, axis=0)
    p = points[:, None]
    along = np.einsum("nei,ei->ne", p - a, b - a)
    squared = np.einsum("ei,ei->e", b - a, b - a)
    t = np.clip(along / np.where(squared > 0, squared, 1), 0, 1)[..., None]
    distance = np.linalg.norm(p - (a + t * (b - a)), axis=2)
    distance = np.where(on_axis(a) & on_axis(b), np.inf, distance).min(axis=1)
    crosses = (a[:, 1] <= p[..., 1]) != (b[:, 1] <= p[..., 1])
    rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
    r = a[:, 0] + (b[:, 0] - a[:, 0]) * (p[..., 1] - a[:, 1]) / rise
    inside = (crosses & (r > p[..., 0])).sum(axis=1) % 2 == 1
    return np.where(inside, distance, -distance)


def on_axis(corners: Array) -> Array:
    return corners[:, 0] == 0.0


def draw_points(profile: Array, seed: int, n: int = POINTS) -> tuple[Array, Array]:
    """Points (n, 3) about the solid and their depths (n,) in it."""
    rng = np.random.default_rng(seed)
    low, high = profile.min(axis=0), profile.max(axis=0)
    margin = 0.1 * (high - low).max()
    rz = rng.uniform(np.maximum(low - margin, [0.0, -np.inf]), high + margin, (n, 2))
    turn = rng.uniform(0, 2 * np.pi, n)
    points = np.stack(
        [rz[:, 0] * np.cos(turn), rz[:, 0] * np.sin(turn), rz[:, 1]], axis=1
    )
    return points, signed_depths(profile, rz)


def assert_enclosed_closely(profile: Array, seed: int, n: int = POINTS) -> None:
    solids = geometries(Revolve(profile))
    stand_off = max(SURFACE_TOLERANCE, 0.0012 * profile[:, 0].max())
    points, depths = draw_points(profile, seed, n)
    for point, depth in zip(points, depths, strict=True):
        if depth > 0.0:
            assert point_distance(solids, point) <= EXACT
        elif depth < -stand_off - EXACT:
            assert point_distance(solids, point) > 0.0


@each_profile
def test_pieces_enclose_the_solid_and_stand_off_no_more_than_said(name: str) -> None:
    for seed in range(3):
        assert_enclosed_closely(PROFILES[name], seed, n=150)


@settings(max_examples=25)
@given(vessels(), st.integers(0, 1000))
def test_pieces_of_any_vessel_enclose_it_closely(profile: Array, seed: int) -> None:
    assert_enclosed_closely(profile, seed)


@each_profile
def test_points_on_the_surface_are_enclosed(name: str) -> None:
    profile = PROFILES[name]
    solids, rng = geometries(Revolve(profile)), np.random.default_rng(0)
    for a, b in zip(profile, np.roll(profile, -1, axis=0), strict=True):
        for _ in range(5):
            r, z = a + rng.uniform() * (b - a)
            turn = rng.uniform(0, 2 * np.pi)
            point = np.array([r * np.cos(turn), r * np.sin(turn), z])
            assert point_distance(solids, point) <= EXACT


@each_profile
def test_the_volume_is_that_of_the_solid(name: str) -> None:
    """By Guldin's rule, the same for every profile that goes counter-clockwise."""
    profile = PROFILES[name]
    a, b = profile, np.roll(profile, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
    volume = np.pi / 3 * np.abs(np.sum((a[:, 0] + b[:, 0]) * cross))
    pieces = sum(g.computeVolume() for g in geometries(Revolve(profile)))
    surface = (
        2 * np.pi * np.sum((a[:, 0] + b[:, 0]) / 2 * np.linalg.norm(b - a, axis=1))
    )
    assert volume <= pieces <= volume + surface * SURFACE_TOLERANCE * 2


def test_a_hollow_stays_open() -> None:
    glass, tyre = geometries(Revolve(GLASS)), geometries(Revolve(TYRE))
    for z in np.linspace(0.13, 0.21, 9):
        to_floor = z - 0.125
        assert point_distance(glass, np.array([0.0, 0.0, z])) > min(
            0.02, to_floor - EXACT
        )
        assert point_distance(glass, np.array([0.025, 0.0, z])) > 0.001
    assert point_distance(tyre, np.zeros(3)) > 0.19
    assert point_distance(glass, np.array([0.0, 0.0, 0.12])) < 0.0  # below the hollow


def test_what_reaches_the_axis_is_not_cut_into_wedges() -> None:
    assert len(convex_pieces(CONE)) == 1
    assert len(convex_pieces(np.array([[0, 0], [0.1, 0], [0.1, 0.3], [0, 0.3]]))) == 1
    assert len(convex_pieces(TYRE)) >= 8


def test_the_order_and_the_first_corner_of_a_profile_do_not_matter() -> None:
    volumes = [
        sum(g.computeVolume() for g in geometries(Revolve(profile)))
        for profile in (JUG, JUG[::-1], np.roll(JUG, 5, axis=0))
    ]
    np.testing.assert_allclose(volumes, volumes[0], rtol=1e-9)


@pytest.mark.parametrize("step", [1e-5, 1e-7, 1e-8, 1.1e-9, 4e-10])
@pytest.mark.parametrize("lift", [0.0, 4e-10])
def test_corners_at_almost_the_same_height_do_no_harm(step: float, lift: float) -> None:
    z = 0.1 + lift
    profile = np.array(
        [[0, 0], [0.05, 0], [0.05, z], [0.03, z + step], [0.03, 0.2], [0, 0.2]]
    )
    solids = geometries(Revolve(profile))
    assert point_distance(solids, np.array([0.04, 0, 0.0999])) < 0
    assert point_distance(solids, np.array([0.04, 0, 0.1002])) > 0
    assert point_distance(solids, np.array([0.052, 0, 0.1])) > 0


def test_the_centre_of_mass_lies_on_the_axis() -> None:
    glass = Object("glass", Revolve(GLASS), np.eye(4))
    scenery = Scenery((), frozenset(), {"glass": Scenery.solids_of_object(glass)})
    x, y, z = scenery.centre_of_mass("glass")
    assert abs(x) < 1e-9
    assert abs(y) < 1e-9
    assert 0.0 < z < 0.2
