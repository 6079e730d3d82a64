"""Meshes become closed convex pieces, or are refused by the name of their file."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from mmplan.collision import Scenery, mesh_files, meshes
from mmplan.collision.decomposition import Effort
from mmplan.collision.mesh_files import TriangleMesh
from mmplan.collision.solids import geometries
from mmplan.exceptions import InputError
from mmplan.problem import Object
from mmplan.shapes import Array, Mesh
from tests.collision.meshes import (
    TETRAHEDRON,
    TETRAHEDRON_FACES,
    ball,
    in_u_shape,
    u_shape,
    write_obj,
    write_stl,
)
from tests.collision.worlds import point_distance

NO_COACD = "coacd, which cuts concave meshes, is the extra 'meshes'"
HALVES = [TETRAHEDRON, TETRAHEDRON + 1.0]  # pieces of nothing in particular


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the cache, which is the test's own and does not exist yet."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "mmplan" / "meshes"


@pytest.fixture
def u_mesh(tmp_path: Path) -> Mesh:
    return Mesh(write_obj(tmp_path / "u.obj", *u_shape()))


@pytest.fixture
def cutter(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Replaces CoACD by something quick; lists the meshes that it has cut."""
    cut: list[Path] = []

    def halves(path: Path, surface: TriangleMesh, _: Effort) -> list[Array]:
        assert surface.vertices.shape[1] == surface.triangles.shape[1] == 3
        cut.append(path)
        return HALVES

    monkeypatch.setattr(meshes, "cut", halves)
    return cut


def assert_refused(path: Path, message: str) -> None:
    with pytest.raises(InputError) as error:
        meshes.convex_pieces(Mesh(path))
    assert str(error.value) == f"{path}: this mesh {message}"


# Convex meshes


@pytest.mark.parametrize("write", [write_obj, write_stl])
def test_a_convex_mesh_is_one_piece(tmp_path: Path, write: type) -> None:
    path = write(tmp_path / f"t.{write.__name__[-3:]}", TETRAHEDRON, TETRAHEDRON_FACES)
    (piece,) = meshes.convex_pieces(Mesh(path))
    assert {tuple(np.round(p, 6)) for p in piece} == {tuple(p) for p in TETRAHEDRON}


def test_facets_that_face_inwards_make_the_same_solid(tmp_path: Path) -> None:
    inwards = [face[::-1] for face in TETRAHEDRON_FACES]
    path = write_obj(tmp_path / "t.obj", TETRAHEDRON, inwards)
    assert len(meshes.convex_pieces(Mesh(path))) == 1


def test_squares_are_cut_into_triangles(tmp_path: Path) -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4)]
    path = write_obj(
        tmp_path / "cube.obj", corners.astype(float), [*faces, (1, 5, 7, 3)]
    )
    (solid,) = geometries(Mesh(path, (0.1, 0.2, 0.3)))
    assert solid.computeVolume() == pytest.approx(0.006, rel=1e-6)


def test_a_scale_goes_along_the_axes_of_the_mesh(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "t.obj", TETRAHEDRON, TETRAHEDRON_FACES)
    (piece,) = meshes.convex_pieces(Mesh(path, (2.0, 3.0, 4.0)))
    np.testing.assert_allclose(np.ptp(piece, axis=0), [0.2, 0.3, 0.4], rtol=1e-6)


def test_what_lies_wholly_inside_a_convex_mesh_is_in_it(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "ball.obj", *ball(24))
    solids = geometries(Mesh(path))
    assert len(solids) == 1
    assert point_distance(solids, np.zeros(3)) < -0.09  # deep, if not to the digit


# Refusals


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "dae", "gltf"])
def test_a_mesh_that_is_not_there(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"nothing.{suffix}"
    with pytest.raises(InputError) as error:
        meshes.convex_pieces(Mesh(path))
    assert str(error.value) == f"{path}: cannot be read: No such file or directory"


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "dae", "gltf", "glb"])
@pytest.mark.parametrize("content", ["", "no mesh at all\n" * 9, "\0\1\2" * 99])
def test_a_file_that_is_no_mesh(tmp_path: Path, suffix: str, content: str) -> None:
    path = tmp_path / f"junk.{suffix}"
    path.write_text(content)
    with pytest.raises(InputError, match="this mesh cannot be read: ") as error:
        meshes.convex_pieces(Mesh(path))
    assert str(error.value).startswith(f"{path}: ")
    assert "\n" not in str(error.value)
    assert "mesh_loader" not in str(error.value)


def test_a_mesh_without_triangles(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "points.obj", TETRAHEDRON, [])
    with pytest.raises(InputError, match="this mesh cannot be read: "):
        meshes.convex_pieces(Mesh(path))


def test_a_flat_mesh(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "flat.obj", TETRAHEDRON, [(0, 1, 2), (0, 2, 1)])
    assert_refused(path, "is flat; a closed solid is needed")


def test_a_mesh_of_too_many_triangles_is_refused_unread(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file is as long as its head says, but has nothing in it."""
    monkeypatch.setattr(mesh_files, "_MOST_TRIANGLES", 10_000)
    path, count = tmp_path / "many.stl", 20_000
    with path.open("wb") as file:
        file.write(bytes(80) + count.to_bytes(4, "little"))
        file.truncate(84 + 50 * count)
    assert_refused(
        path, "has 20,000 triangles, and at most 10,000 are taken; simplify it first"
    )


def test_a_mesh_that_is_not_finite(tmp_path: Path) -> None:
    vertices = TETRAHEDRON.copy()
    vertices[1, 2] = np.nan
    path = write_obj(tmp_path / "nan.obj", vertices, TETRAHEDRON_FACES)
    assert_refused(path, "has a vertex that is not finite")


@pytest.mark.parametrize(
    "faces",
    [TETRAHEDRON_FACES[1:], [(0, 1, 2), *TETRAHEDRON_FACES[1:]]],
    ids=["a facet missing", "a facet turned over"],
)
def test_a_mesh_that_is_not_closed(
    tmp_path: Path, faces: list[tuple[int, ...]]
) -> None:
    path = write_obj(tmp_path / "open.obj", TETRAHEDRON, faces)
    assert_refused(
        path,
        "is not closed: some edge has a triangle on one side only, or two that do not "
        "face the same way",
    )


def test_a_concave_mesh_without_the_extra(
    u_mesh: Mesh, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "coacd", None)
    assert_refused(
        u_mesh.path,
        "is not convex; to cut it into convex pieces install the extra: "
        "pip install 'mmplan[meshes]'",
    )
    assert not cache.exists()


# The cache


def test_a_concave_mesh_is_cut_once(
    u_mesh: Mesh, cutter: list[Path], cache: Path
) -> None:
    for _ in range(3):
        pieces = meshes.convex_pieces(u_mesh)
        np.testing.assert_array_equal(pieces, HALVES)
    assert cutter == [u_mesh.path]
    (file,) = cache.iterdir()  # and nothing half-written beside it
    assert file.suffix == ".npz"


def test_many_pieces_keep_their_order(
    u_mesh: Mesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    many = [TETRAHEDRON + i for i in range(12)]
    monkeypatch.setattr(meshes, "cut", lambda *_: many)
    for _ in range(2):
        np.testing.assert_array_equal(meshes.convex_pieces(u_mesh), many)


def test_another_scale_is_another_mesh(u_mesh: Mesh, cutter: list[Path]) -> None:
    twice = Mesh(u_mesh.path, (2.0, 2.0, 2.0))
    meshes.convex_pieces(u_mesh)
    meshes.convex_pieces(twice)
    assert cutter == [u_mesh.path, twice.path]


@pytest.mark.parametrize("keep", [0, 1, 100, -30])
def test_a_corrupt_entry_is_made_anew(
    u_mesh: Mesh, cutter: list[Path], cache: Path, keep: int
) -> None:
    meshes.convex_pieces(u_mesh)
    (file,) = cache.iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole[:keep])
    np.testing.assert_array_equal(meshes.convex_pieces(u_mesh), HALVES)
    assert len(cutter) == 2
    np.testing.assert_array_equal(meshes.convex_pieces(u_mesh), HALVES)
    assert len(cutter) == 2


def test_an_entry_whose_bytes_have_changed_is_made_anew(
    u_mesh: Mesh, cutter: list[Path], cache: Path
) -> None:
    meshes.convex_pieces(u_mesh)
    (file,) = cache.iterdir()
    content = bytearray(file.read_bytes())
    content[200] ^= 0xFF
    file.write_bytes(content)
    np.testing.assert_array_equal(meshes.convex_pieces(u_mesh), HALVES)
    assert len(cutter) == 2


def test_a_cache_that_cannot_be_written_is_done_without(
    u_mesh: Mesh, cutter: list[Path], cache: Path
) -> None:
    cache.parent.parent.write_text("a file where the folder should be")
    for _ in range(2):
        np.testing.assert_array_equal(meshes.convex_pieces(u_mesh), HALVES)
    assert len(cutter) == 2


def test_a_write_that_fails_leaves_nothing(
    u_mesh: Mesh, cutter: list[Path], cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    np.testing.assert_array_equal(meshes.convex_pieces(u_mesh), HALVES)
    assert list(cache.iterdir()) == []
    assert cutter == [u_mesh.path]


def test_writers_at_the_same_time_do_no_harm(
    u_mesh: Mesh, cutter: list[Path], cache: Path
) -> None:
    def cut(_: int) -> list[Array]:
        return meshes.convex_pieces(u_mesh)

    with ThreadPoolExecutor(8) as pool:
        for pieces in pool.map(cut, range(32)):
            np.testing.assert_array_equal(pieces, HALVES)
    assert 1 <= len(cutter) <= 32
    assert len(list(cache.iterdir())) == 1


# CoACD itself


def test_a_concave_mesh_is_filled_and_its_hollow_stays_open(u_mesh: Mesh) -> None:
    pytest.importorskip("coacd", reason=NO_COACD)
    solids = geometries(u_mesh)
    points = np.random.default_rng(0).uniform(-0.05, 0.35, (400, 3)) * [1, 1, 0.5]
    for point, depth in zip(points, in_u_shape(points), strict=True):
        if abs(depth) > 5e-4:
            assert (point_distance(solids, point) <= 0.0) == (depth > 0.0)


def test_cutting_twice_gives_the_same_pieces(u_mesh: Mesh, cache: Path) -> None:
    pytest.importorskip("coacd", reason=NO_COACD)
    first = meshes.convex_pieces(u_mesh)
    for file in cache.iterdir():
        file.unlink()
    for a, b in zip(first, meshes.convex_pieces(u_mesh), strict=True):
        np.testing.assert_array_equal(a, b)


def test_parts_that_do_not_hang_together_are_taken_one_by_one(
    tmp_path: Path, cutter: list[Mesh]
) -> None:
    vertices, faces = u_shape()
    both = np.concatenate([vertices, TETRAHEDRON + 1.0])
    more = [tuple(i + len(vertices) for i in face) for face in TETRAHEDRON_FACES]
    path = write_obj(tmp_path / "both.obj", both, [*faces, *more])
    pieces = meshes.convex_pieces(Mesh(path))
    assert len(cutter) == 1
    np.testing.assert_allclose(np.sort(pieces[-1], axis=0), np.sort(TETRAHEDRON + 1, 0))


def test_a_cavity_stays_with_what_it_is_in(tmp_path: Path, cutter: list[Mesh]) -> None:
    inside = 0.01 + 0.6 * TETRAHEDRON
    faces = [tuple(i + 4 for i in face[::-1]) for face in TETRAHEDRON_FACES]
    path = write_obj(
        tmp_path / "hollow.obj",
        np.concatenate([TETRAHEDRON, inside]),
        [*TETRAHEDRON_FACES, *faces],
    )
    meshes.convex_pieces(Mesh(path))
    assert len(cutter) == 1


def test_a_file_without_triangles(tmp_path: Path) -> None:
    path = tmp_path / "points.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n")
    with pytest.raises(InputError, match="cannot be read: it has no triangles"):
        meshes.convex_pieces(Mesh(path))


def test_triangles_without_area_do_no_harm(tmp_path: Path) -> None:
    """One edge is cut by a point that the triangle on its other side does not have."""
    middle = 0.5 * (TETRAHEDRON[0] + TETRAHEDRON[1])
    vertices = np.concatenate([TETRAHEDRON, [middle]])
    faces = [(0, 2, 4), (4, 2, 1), (0, 4, 1), *TETRAHEDRON_FACES[1:]]
    path = write_obj(tmp_path / "sliver.obj", vertices, faces)
    (piece,) = meshes.convex_pieces(Mesh(path))
    assert meshes.hull(piece).computeVolume() == pytest.approx(0.001 / 6)


def test_a_mesh_of_too_many_triangles_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh_files, "_MOST_TRIANGLES", 1000)
    assert_refused(
        write_obj(tmp_path / "fine.obj", *ball(24)),
        "has 2,208 triangles, and at most 1,000 are taken; simplify it first",
    )


def test_a_mesh_in_millimetres_is_told_by_its_size(tmp_path: Path) -> None:
    vertices, faces = ball(6)
    path = write_obj(tmp_path / "mug.obj", 500.0 * vertices, faces)
    with pytest.raises(InputError) as caught:
        Scenery.solids_of_object(Object("mug", Mesh(path), np.eye(4)))
    assert str(caught.value) == (
        f"{path}: this mesh is 100 x 100 x 100 m large, and what is carried is at "
        "most 3 m; if it is in millimetres, give it 'scale: 0.001'"
    )
    small = Mesh(path, (0.001, 0.001, 0.001))
    assert len(Scenery.solids_of_object(Object("mug", small, np.eye(4)))) == 1
