"""Grasps sampled from meshes: two opposite places, and room for the hand."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import trimesh

from mmplan.collision import HandCloser, Scenery, antipodal_poses, hand_size
from mmplan.collision.antipodal import antipodal_pairs
from mmplan.collision.hand_size import hands_open_by
from mmplan.grasps.contacts import contact_wrenches
from mmplan.grasps.wrench_space import WrenchSpace
from mmplan.problem import Object
from mmplan.shapes import Array, Mesh
from tests.collision.meshes import ball, write_obj
from tests.honest import puma

FRICTION = 0.5
CONE = np.arctan(FRICTION)


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the cache, which is the test's own and does not exist yet."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "mmplan" / "grasps"


@pytest.fixture
def egg(tmp_path: Path) -> Mesh:
    """A convex mesh, 8 x 6 x 12 cm."""
    vertices, faces = ball(12)
    return Mesh(write_obj(tmp_path / "egg.obj", vertices * [0.4, 0.3, 0.6], faces))


def poses(mesh: Mesh, n: int = 60, seed: int = 0) -> Array:
    return antipodal_poses(mesh, puma(), FRICTION, n, seed)


def surface(mesh: Mesh) -> trimesh.Trimesh:
    return trimesh.load(mesh.path, process=False)


def test_pairs_lie_on_the_surface_in_both_friction_cones(egg: Mesh) -> None:
    thing, hand = surface(egg), hand_size(puma())
    rng = np.random.default_rng(0)
    first, second, closing = antipodal_pairs(thing, hand, FRICTION, 400, rng)
    assert len(first) > 100
    between = second - first
    apart = np.linalg.norm(between, axis=1)
    assert np.all(apart <= hand.widest)
    flush = []
    for points, inward in ((first, between), (second, -between)):
        distance, face = nearest_faces(thing, points)
        np.testing.assert_allclose(distance, 0.0, atol=1e-6)
        cosine = np.einsum("ni,ni->n", -thing.face_normals[face], inward) / apart
        assert np.all(cosine >= np.cos(CONE) - 1e-6)
        # Flat pads across the closing direction are as aslant to both places.
        flush.append(np.abs(np.einsum("ni,ni->n", thing.face_normals[face], closing)))
    np.testing.assert_allclose(flush[0], flush[1], atol=1e-6)
    assert np.all(flush[0] >= np.cos(CONE) - 1e-6)


def nearest_faces(thing: trimesh.Trimesh, points: Array) -> tuple[Array, Array]:
    """The distance (n,) of points (n, 3) to the surface and where it is nearest."""
    n, m = len(points), len(thing.faces)
    pairs = np.tile(thing.triangles, (n, 1, 1)), np.repeat(points, m, axis=0)
    closest = trimesh.triangles.closest_point(*pairs)
    distance = np.linalg.norm(closest - pairs[1], axis=1).reshape(n, m)
    return distance.min(axis=1), distance.argmin(axis=1)


def test_pairs_are_drawn_by_area() -> None:
    """Two plates of one thickness: the larger gets more, as its area says."""
    large, small = (trimesh.creation.box((size, size, 0.02)) for size in (0.3, 0.15))
    small.apply_translation([1.0, 0.0, 0.0])
    both = trimesh.util.concatenate([large, small])
    hand = hand_size(puma())
    first, _, _ = antipodal_pairs(both, hand, 0.1, 4000, np.random.default_rng(0))
    share = np.mean(first[:, 0] > 0.5)
    # Through the flat sides only: the edges are too far apart for the hand.
    assert share == pytest.approx(0.15**2 / (0.15**2 + 0.3**2), abs=0.03)


def test_the_hand_closes_on_what_was_sampled_and_holds_it(egg: Mesh) -> None:
    T = poses(egg)
    assert len(T) == 60
    closer = HandCloser(puma(), Scenery.solids_of_object(Object("egg", egg, np.eye(4))))
    closings = closer.close(T)
    assert closings.touches.mean() > 0.95
    contacts = closer.contacts(T, closings).about(closer.centre_of_mass, closer.size)
    wrenches = contact_wrenches(contacts, FRICTION).reshape(60, -1, 6)
    closes = [WrenchSpace.of_wrenches(w).closes for w in wrenches[contacts.complete]]
    assert np.mean(closes) > 0.9


def test_the_same_seed_gives_the_same_grasps(egg: Mesh, cache: Path) -> None:
    first = poses(egg, seed=3)
    (kept,) = cache.iterdir()
    np.testing.assert_array_equal(poses(egg, seed=3), first)
    kept.unlink()
    np.testing.assert_array_equal(poses(egg, seed=3), first)
    assert not np.array_equal(poses(egg, seed=4), first)
    assert len(list(cache.iterdir())) == 2


@pytest.mark.parametrize("damage", [b"", b"nonsense", b"PK\x03\x04"])
def test_a_damaged_entry_is_made_anew(egg: Mesh, cache: Path, damage: bytes) -> None:
    first = poses(egg)
    (kept,) = cache.iterdir()
    kept.write_bytes(damage)
    np.testing.assert_array_equal(poses(egg), first)
    assert kept.stat().st_size > 100


def test_writers_at_the_same_time_do_no_harm(egg: Mesh, cache: Path) -> None:
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: poses(egg), range(8)))
    for T in found:
        np.testing.assert_array_equal(T, found[0])
    assert len(list(cache.iterdir())) == 1


def test_what_is_too_wide_has_no_grasps(tmp_path: Path) -> None:
    vertices, faces = ball(8)
    wide = Mesh(write_obj(tmp_path / "wide.obj", vertices * 2.0, faces))
    assert poses(wide, 10).shape == (0, 4, 4)


@pytest.mark.parametrize("opening", [0.0, 0.03, 0.1])
def test_the_hand_opens_by_what_is_wanted(opening: float) -> None:
    (hand,) = hands_open_by(puma(), np.array([opening]))
    np.testing.assert_allclose(hand, opening / 2.0, atol=1e-3)
