"""How far bodies stand off surfaces, against shapes for which that is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mmplan.collision.mesh_files import read_mesh
from mmplan.collision.meshes import hull
from mmplan.collision.solids import Solid
from mmplan.collision.standoff import standoff
from mmplan.shapes import Array, Mesh
from tests.collision.meshes import ball, u_shape, write_obj


def surface(path: Path, vertices: Array, triangles: Array) -> Solid:
    mesh = read_mesh(Mesh(write_obj(path / "mesh.obj", vertices, triangles)))
    return Solid("link", mesh, np.eye(4))


def body(points: Array) -> Solid:
    return Solid("link", hull(points), np.eye(4))


def test_the_hull_of_a_convex_mesh_stands_off_nowhere(tmp_path: Path) -> None:
    vertices, triangles = ball(16)
    found = standoff([body(vertices)], [surface(tmp_path, vertices, triangles)])
    assert found == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_the_hull_of_a_u_stands_off_in_its_gap(tmp_path: Path) -> None:
    vertices, triangles = u_shape()
    found = standoff([body(vertices)], [surface(tmp_path, vertices, triangles)])
    assert found.uncovered == pytest.approx(0.0, abs=1e-6)
    assert 0.0 < found.mean < found.largest


def test_a_body_that_is_too_large_stands_off_by_what_it_is_larger(
    tmp_path: Path,
) -> None:
    vertices, triangles = ball(16)
    radius = np.linalg.norm(vertices, axis=1).max()
    mesh = surface(tmp_path, vertices, triangles)
    grown = standoff([body(1.1 * vertices)], [mesh])
    assert grown.largest == pytest.approx(0.1 * radius, rel=0.1)
    shrunk = standoff([body(0.9 * vertices)], [mesh])
    assert shrunk.uncovered == pytest.approx(0.1 * radius, rel=0.1)


def test_pieces_are_not_measured_where_they_meet(tmp_path: Path) -> None:
    vertices, triangles = ball(16)
    halves = [body(vertices[vertices[:, 0] * s >= -1e-9]) for s in (1.0, -1.0)]
    found = standoff(halves, [surface(tmp_path, vertices, triangles)])
    one = standoff(halves[:1], [surface(tmp_path, vertices, triangles)])
    assert one.largest > 5 * found.largest
