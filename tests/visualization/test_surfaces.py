"""Surfaces: closed, facing out, and as large as what they are the surface of."""

from __future__ import annotations

from pathlib import Path

import coal
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.collision import solids_of_obstacle
from mmplan.collision.mesh_files import TriangleMesh, read_surface
from mmplan.collision.separation import signed_distance, transform
from mmplan.collision.surfaces import appearance
from mmplan.problem import Obstacle
from mmplan.shapes import (
    Array,
    Box,
    Capsule,
    Cone,
    Cylinder,
    Mesh,
    Revolve,
    Shape,
    Sphere,
    read_only,
)
from mmplan.visualization.smoothing import coarsened, with_edges
from mmplan.visualization.surface import Surface, ring, surface_of, tube, turned

CUP = read_only(
    [[0, 0], [0.04, 0], [0.04, 0.1], [0.035, 0.1], [0.035, 0.01], [0, 0.01]]
)
SHAPES: list[tuple[Shape, float]] = [
    (Box((0.1, 0.2, 0.3)), 0.006),
    (Sphere(0.1), 4 / 3 * np.pi * 1e-3),
    (Cylinder(0.1, 0.4), np.pi * 0.004),
    (Capsule(0.1, 0.4), np.pi * 0.004 + 4 / 3 * np.pi * 1e-3),
    (Cone(0.1, 0.3), np.pi * 0.001),
    (Revolve(CUP), np.pi * (0.04**2 * 0.1 - 0.035**2 * 0.09)),
]
lengths = st.floats(0.01, 2.0)


def volume(surface: Surface) -> float:
    a, b, c = (surface.vertices[surface.triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def is_closed(surface: Surface) -> bool:
    """Whether every edge is passed as often one way as the other, by places."""
    places = np.round(surface.vertices * 1e7)
    _, place = np.unique(places, axis=0, return_inverse=True)
    a, b, c = place.reshape(-1)[surface.triangles].T
    start, end = np.concatenate([a, b, c]), np.concatenate([b, c, a])
    there, back = start * len(place) + end, end * len(place) + start
    return np.array_equal(np.sort(there), np.sort(back))


@pytest.mark.parametrize(("shape", "expected"), SHAPES, ids=lambda s: type(s).__name__)
def test_a_surface_is_closed_faces_out_and_encloses_the_volume(
    shape: Shape, expected: float
) -> None:
    surface = surface_of(shape)
    assert is_closed(surface)
    # Chords lie inside of circles, so that a little is missing.
    assert 0.985 * expected <= volume(surface) <= expected * (1 + 1e-9)


@given(st.lists(lengths, min_size=3, max_size=3), lengths)
def test_what_is_turned_about_an_axis_is_closed(radii: list[float], z: float) -> None:
    profile = np.array([[0.0, 0.0], *[[r, k * z] for k, r in enumerate(radii)]])
    profile = np.concatenate([profile, [[0.0, 2 * z]]])
    assert is_closed(turned(profile))
    assert volume(turned(profile[::-1])) == pytest.approx(volume(turned(profile)))


@pytest.mark.parametrize(("shape", "_"), SHAPES, ids=lambda s: type(s).__name__)
def test_surfaces_lie_on_the_solids_that_collide(shape: Shape, _: float) -> None:
    solids = solids_of_obstacle(Obstacle("thing", shape, np.eye(4)))
    here = transform(np.eye(4))
    vertices = surface_of(shape).vertices
    # Not in the middle of a cap, where coal finds no way out of a cylinder.
    for vertex in vertices[np.hypot(*vertices[:, :2].T) > 1e-6][::7]:
        point = np.eye(4)
        point[:3, 3] = vertex
        nearest = min(
            signed_distance(s.geometry, here, coal.Sphere(1e-6), transform(point))
            for s in solids
        )
        assert -0.002 < nearest < 1e-5


def test_a_box_has_sharp_edges_and_a_ball_none() -> None:
    box, ball = with_edges(surface_of(Box((1, 2, 3)))), surface_of(Sphere(1.0))
    assert len(box.vertices) == 24  # three at each corner
    normals = np.abs(box.normals)
    assert np.allclose(np.sort(normals, axis=1), [0, 0, 1])
    smooth = with_edges(ball)
    places = np.unique(np.round(ball.vertices * 1e6), axis=0)
    assert len(smooth.vertices) == len(places)
    assert np.allclose(smooth.normals, smooth.vertices, atol=0.03)


@pytest.mark.parametrize(("shape", "_"), SHAPES, ids=lambda s: type(s).__name__)
def test_edges_change_no_triangle(shape: Shape, _: float) -> None:
    surface = surface_of(shape)
    edged = with_edges(surface)
    assert volume(edged) == pytest.approx(volume(surface), rel=1e-6)
    assert len(edged.triangles) == len(surface.triangles)


def test_a_coarse_surface_keeps_to_its_number_and_its_place() -> None:
    ball = turned(_half_circle(120), 240)
    coarse = coarsened(ball, 2000)
    assert 500 < len(coarse.triangles) <= 2000
    assert np.allclose(np.linalg.norm(coarse.vertices, axis=1), 1.0, atol=0.03)
    assert coarsened(coarse, 2000) is coarse


def _half_circle(steps: int) -> Array:
    angle = np.linspace(-np.pi / 2, np.pi / 2, steps)
    return np.stack([np.abs(np.cos(angle)) * (np.cos(angle) > 1e-9), np.sin(angle)], 1)


def test_tubes_follow_their_points_and_rings_are_flat() -> None:
    points = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 1]], dtype=float)
    pipe = tube(points, 0.01)
    assert is_closed(pipe)
    assert volume(pipe) == pytest.approx(2 * np.pi * 1e-4, rel=0.12)
    flat = ring(0.3, 1.0)
    radius = np.linalg.norm(flat.vertices[:, :2], axis=1)
    assert (radius.min(), radius.max()) == pytest.approx((0.3, 1.0))
    assert np.ptp(flat.vertices[:, 2]) <= 1e-3


@pytest.mark.parametrize(
    ("geometry", "shape"),
    [
        (coal.Box(0.1, 0.2, 0.3), Box((0.1, 0.2, 0.3))),
        (coal.Sphere(0.1), Sphere(0.1)),
        (coal.Cylinder(0.1, 0.2), Cylinder(0.1, 0.2)),
        (coal.Capsule(0.1, 0.2), Capsule(0.1, 0.2)),
        (coal.Cone(0.1, 0.2), Cone(0.1, 0.2)),
    ],
    ids=lambda x: type(x).__name__,
)
def test_geometries_of_coal_look_like_the_shapes_they_are(
    geometry: coal.CollisionGeometry, shape: Shape
) -> None:
    assert appearance(geometry) == shape


def test_convex_geometries_look_like_their_hulls() -> None:
    (solid,) = solids_of_obstacle(
        Obstacle("prism", Revolve(read_only([[0, 0], [0.1, 0], [0, 0.2]])), np.eye(4))
    )
    found = appearance(solid.geometry)
    assert isinstance(found, TriangleMesh)
    surface = Surface(*found)
    assert is_closed(surface)
    assert volume(surface) == pytest.approx(solid.geometry.computeVolume(), rel=1e-6)


def test_meshes_are_read_and_scaled(tmp_path: Path) -> None:
    path = tmp_path / "tetrahedron.obj"
    path.write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    mesh = Mesh(path, (1.0, 2.0, 3.0))
    surface = Surface(*read_surface(mesh))
    assert volume(surface) == pytest.approx(1.0)
