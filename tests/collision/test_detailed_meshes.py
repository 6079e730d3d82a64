"""Meshes of many triangles: read quickly, enclosed by few corners, and kept."""

from __future__ import annotations

import multiprocessing
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from mmplan.collision import mesh_files, meshes, simplification
from mmplan.collision.enclosing import RELATIVE_TOLERANCE, TOLERANCE, enclosing
from mmplan.collision.mesh_files import TriangleMesh, content_key, read_surface
from mmplan.collision.simplification import grown, simplified
from mmplan.collision.solids import geometries
from mmplan.shapes import Array, Mesh
from tests.collision.meshes import ball, u_shape, write_obj
from tests.collision.worlds import point_distance


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the cache, which is the test's own and does not exist yet."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "mmplan" / "meshes"


def write_binary_stl(path: Path, vertices: Array, triangles: Array) -> Path:
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    records = np.zeros(len(triangles), kind)
    records["corners"] = vertices[triangles]
    head = bytes(80) + len(triangles).to_bytes(4, "little")
    path.write_bytes(head + records.tobytes())
    return path


def ring(n: int, m: int) -> tuple[Array, Array]:
    """A ring about z, of radius 0.2 m and 0.12 m thick, of 2 n m triangles."""
    u, v = 2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m
    U, V = np.meshgrid(u, v, indexing="ij")
    r = 0.2 + 0.06 * np.cos(V)
    points = np.stack([r * np.cos(U), r * np.sin(U), 0.06 * np.sin(V)], axis=-1)
    i, j = np.indices((n, m)).reshape(2, -1)
    east, up = (i + 1) % n, (j + 1) % m
    a, b, c, d = i * m + j, east * m + j, east * m + up, i * m + up
    one, two = np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)
    return points.reshape(-1, 3), np.concatenate([one, two])


def outside(pieces: list[Array], points: Array) -> Array:
    """How far points (n, 3) are outside of the nearest piece's planes, m."""
    depths = []
    for piece in pieces:
        planes = ConvexHull(piece).equations
        depths.append((points @ planes[:, :3].T + planes[:, 3]).max(axis=1))
    return np.min(depths, axis=0)


# Reading


def test_a_binary_stl_file_reads_as_coal_reads_it(tmp_path: Path) -> None:
    path = write_binary_stl(tmp_path / "ring.stl", *ring(40, 20))
    mesh = Mesh(path, (1.0, 2.0, 3.0))
    theirs = mesh_files.read_triangles(mesh_files.read_mesh(mesh))
    ours = read_surface(mesh)
    assert len(ours.vertices) == 800
    np.testing.assert_allclose(_corners(ours), _corners(theirs), atol=1e-12)


def test_vertices_at_one_place_become_one_and_triangles_stay(tmp_path: Path) -> None:
    vertices, faces = ball(6)
    apart = [tuple(range(3 * i, 3 * i + 3)) for i in range(len(faces))]
    corners = np.concatenate([vertices[list(face)] for face in faces])
    surface = read_surface(Mesh(write_obj(tmp_path / "ball.obj", corners, apart)))
    assert len(surface.vertices) == len(vertices)
    whole = TriangleMesh(vertices, np.array(faces))
    np.testing.assert_allclose(_corners(surface), _corners(whole), atol=1e-6)


def _corners(surface: TriangleMesh) -> Array:
    """The corners of each triangle, turned so that the first has the lowest number.

    Numbers are those of the places in their order by x, then y, then z.
    """
    places, triangles = np.round(surface.vertices, 6) + 0.0, surface.triangles
    _, number = np.unique(places, axis=0, return_inverse=True)
    numbered = number.reshape(-1)[triangles]
    turn = (np.argmin(numbered, axis=1)[:, None] + np.arange(3)) % 3
    turned = np.take_along_axis(numbered, turn, axis=1)
    order = np.lexsort(turned.T)
    rows = np.take_along_axis(triangles, turn, axis=1)[order]
    return surface.vertices[rows]


# Few corners about many


@settings(max_examples=5, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    size=st.tuples(*[st.floats(0.02, 2.0)] * 3),
    power=st.sampled_from([0.3, 1.0]),
)
def test_what_encloses_holds_all_corners_and_stands_off_little(
    seed: int, size: tuple[float, float, float], power: float
) -> None:
    """Round bodies, and flatter ones as the power is lower; none of them thin."""
    directions = np.random.default_rng(seed).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = np.sign(directions) * np.abs(directions) ** power * size
    corners = points[ConvexHull(points).vertices]
    about = enclosing(corners)
    assert len(about) <= len(corners)
    assert outside([about], points).max() <= 1e-9
    tolerance = max(TOLERANCE, RELATIVE_TOLERANCE * np.ptp(points, axis=0).max())
    hull = [meshes.hull(points)]
    assert max(point_distance(hull, c) for c in about) <= tolerance + 1e-6


@pytest.mark.parametrize("sides", [500, 3000])
def test_a_cylinder_of_many_sides_keeps_few(tmp_path: Path, sides: int) -> None:
    """Coal itself takes no face with more corners than it counts in a byte."""
    turn = 2 * np.pi * np.arange(sides) / sides
    circle = 0.3 * np.column_stack([np.cos(turn), np.sin(turn)])
    ends = [np.column_stack([circle, np.full(sides, z)]) for z in (-0.1, 0.1)]
    points = np.concatenate([*ends, [[0, 0, -0.1], [0, 0, 0.1]]])
    here = np.arange(sides)
    there = (here + 1) % sides
    bottom, top = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    faces = [(bottom, there, here), (top, here + sides, there + sides)]
    faces += [(here, there, there + sides), (here, there + sides, here + sides)]
    triangles = np.concatenate([np.stack(face, axis=1) for face in faces])
    mesh = Mesh(write_binary_stl(tmp_path / "drum.stl", points, triangles))
    (solid,) = geometries(mesh)
    assert len(solid.points()) <= 150
    assert solid.computeVolume() == pytest.approx(np.pi * 0.09 * 0.2, rel=2e-3)


@pytest.mark.parametrize("height", [1, 3])
@pytest.mark.parametrize("cuts", [1, 4])
def test_boxes_that_touch_with_a_side_are_two_pieces(
    tmp_path: Path, height: int, cuts: int
) -> None:
    """Whether or not the triangles of both sides have the same corners."""
    box = np.indices((2, 2, 2)).reshape(3, -1).T * 0.1
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4)]
    quads.append((1, 5, 7, 3))
    steps = np.arange(cuts + 1) / cuts
    corners = []
    for place in (box, box * [1, 1, height] + [0.1, 0, 0]):
        for a, b, _, d in quads:
            u, v = place[b] - place[a], place[d] - place[a]
            grid = place[a] + steps[:, None, None] * u + steps[:, None] * v
            one, two, three, four = (
                grid[i : i + cuts, j : j + cuts].reshape(-1, 3)
                for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
            )
            corners += [np.stack([one, two, three], 1), np.stack([one, three, four], 1)]
    points = np.concatenate(corners).reshape(-1, 3)
    triangles = np.arange(len(points)).reshape(-1, 3)
    mesh = Mesh(write_binary_stl(tmp_path / "two.stl", points, triangles))
    volumes = sorted(solid.computeVolume() for solid in geometries(mesh))
    np.testing.assert_allclose(volumes, [0.001, 0.001 * height], rtol=1e-5)


# Fewer triangles


def test_a_simplified_surface_is_closed_and_moves_little() -> None:
    pytest.importorskip("manifold3d", reason="it is of the extra 'meshes'")
    surface = TriangleMesh(*ring(180, 90))
    coarse = simplified(surface)
    assert len(coarse.triangles) <= simplification.MOST_TRIANGLES
    assert meshes._fault(coarse) is None
    # Its vertices are on the ring, and the middles of its triangles near it.
    middles = coarse.vertices[coarse.triangles].mean(axis=1)
    for points, most in ((coarse.vertices, 1e-9), (middles, 0.005)):
        r = np.hypot(np.hypot(*points[:, :2].T) - 0.2, points[:, 2])
        assert np.abs(r - 0.06).max() <= most


def test_grown_pieces_hold_all_points() -> None:
    rng = np.random.default_rng(0)
    cube = np.indices((2, 2, 2)).reshape(3, -1).T * 1.0
    pieces = [cube, cube + np.eye(3)[0]]
    points = rng.uniform([0, 0, 0], [2, 1, 1], (500, 3)) * 1.004
    whole = grown(pieces, points)
    assert outside(pieces, points).max() > 0.001
    assert outside(whole, points).max() <= 1e-9
    for before, after in zip(pieces, whole, strict=True):
        assert np.abs(np.ptp(after, axis=0) - np.ptp(before, axis=0)).max() < 0.01


def test_pieces_of_a_simplified_mesh_hold_every_vertex_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """CoACD is replaced by what cuts a ring into sixteen pieces at once."""
    pytest.importorskip("manifold3d", reason="it is of the extra 'meshes'")
    coacd = pytest.importorskip("coacd", reason="it is of the extra 'meshes'")

    def wedges(mesh: Any, **_: object) -> list[tuple[Array, None]]:
        assert len(mesh.indices) < 3600
        x, y, _z = mesh.vertices.T
        wedge = np.floor(8 * np.arctan2(y, x) / np.pi)
        return [(mesh.vertices[wedge == w], None) for w in range(-8, 8)]

    monkeypatch.setattr(coacd, "run_coacd", wedges)
    monkeypatch.setattr(simplification, "MOST_TRIANGLES", 2000)
    mesh = Mesh(write_binary_stl(tmp_path / "ring.stl", *ring(60, 30)))
    pieces = meshes.convex_pieces(mesh)
    assert outside(pieces, read_surface(mesh).vertices).max() <= 1e-9
    assert outside(pieces, np.zeros((1, 3))).min() > 0.1  # the hole stays open


# What is kept


def test_kept_pieces_are_those_made(tmp_path: Path, cache: Path) -> None:
    mesh = Mesh(write_binary_stl(tmp_path / "ball.stl", *_ball()))
    fresh = meshes.convex_pieces(mesh)
    (entry,) = cache.iterdir()
    whole = entry.read_bytes()
    for kept, made in zip(meshes.convex_pieces(mesh), fresh, strict=True):
        np.testing.assert_array_equal(kept, made)
    entry.write_bytes(whole[: len(whole) // 2])
    for again, made in zip(meshes.convex_pieces(mesh), fresh, strict=True):
        np.testing.assert_array_equal(again, made)
    assert entry.read_bytes() == whole


def test_the_triangles_of_kept_pieces_are_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor is CoACD wanted, which may be missing where a scene was solved before."""
    mesh = Mesh(write_obj(tmp_path / "u.obj", *u_shape()))
    monkeypatch.setattr(meshes, "cut", lambda *_: [0.1 * np.eye(4, 3), np.eye(4, 3)])
    pieces = meshes.convex_pieces(mesh)
    monkeypatch.undo()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setitem(sys.modules, "coacd", None)
    monkeypatch.setattr(meshes, "read_surface", None)
    np.testing.assert_array_equal(meshes.convex_pieces(mesh), pieces)


def test_keys_tell_contents_scales_and_kinds_of_files_apart(tmp_path: Path) -> None:
    vertices, faces = ball(4)
    one = write_obj(tmp_path / "one.obj", vertices, faces)
    same = write_obj(tmp_path / "same.obj", vertices, faces)
    other = write_obj(tmp_path / "other.obj", 1.5 * vertices, faces)
    stl = tmp_path / "one.stl"
    stl.write_bytes(one.read_bytes())
    assert content_key(Mesh(one)) == content_key(Mesh(same))
    different = [Mesh(one), Mesh(one, (1.0, 1.0, 2.0)), Mesh(other), Mesh(stl)]
    keys = {content_key(mesh) for mesh in different} | {content_key(Mesh(one), 7)}
    assert len(keys) == 5


def test_processes_that_write_at_once_do_no_harm(tmp_path: Path, cache: Path) -> None:
    mesh = Mesh(write_binary_stl(tmp_path / "ball.stl", *_ball()))
    context = multiprocessing.get_context("fork")
    workers = [
        context.Process(target=meshes.convex_pieces, args=(mesh,)) for _ in range(4)
    ]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert [worker.exitcode for worker in workers] == [0] * 4
    (entry,) = cache.iterdir()
    kept = meshes.convex_pieces(mesh)
    entry.unlink()
    for a, b in zip(kept, meshes.convex_pieces(mesh), strict=True):
        np.testing.assert_array_equal(a, b)


def _ball() -> tuple[Array, Array]:
    vertices, faces = ball(16)
    return vertices, np.array(faces)
