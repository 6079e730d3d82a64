"""Every shape becomes a closed solid of its own size, placed where it is."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import coal
import numpy as np
import pytest

from mmplan.collision import meshes, solids_of_obstacle
from mmplan.collision.solids import geometries
from mmplan.exceptions import InputError
from mmplan.problem import Object, Obstacle
from mmplan.shapes import (
    Array,
    Box,
    Capsule,
    Cone,
    Cylinder,
    Fixture,
    Mesh,
    Revolve,
    Shape,
    Sphere,
)
from tests.collision.meshes import (
    TETRAHEDRON,
    TETRAHEDRON_FACES,
    ball,
    u_shape,
    write_obj,
)
from tests.collision.worlds import among, held_at, point_distance, q_tucked
from tests.honest import shift


def radial(points: Array) -> Array:
    return np.hypot(points[:, 0], points[:, 1])


# Shape, its volume (m^3), and how deep points (n, 3) lie in it, roughly.
SHAPES: dict[str, tuple[Shape, float, Callable[[Array], Array]]] = {
    "box": (
        Box((0.2, 0.4, 0.6)),
        0.048,
        lambda p: np.min([0.1, 0.2, 0.3] - np.abs(p), axis=1),
    ),
    "sphere": (
        Sphere(0.3),
        4 / 3 * np.pi * 0.027,
        lambda p: 0.3 - np.linalg.norm(p, axis=1),
    ),
    "cylinder": (
        Cylinder(0.1, 0.6),
        np.pi * 0.006,
        lambda p: np.minimum(0.1 - radial(p), 0.3 - np.abs(p[:, 2])),
    ),
    "capsule": (
        Capsule(0.1, 0.4),
        np.pi * 0.004 + 4 / 3 * np.pi * 0.001,
        lambda p: 0.1 - np.hypot(radial(p), np.maximum(np.abs(p[:, 2]) - 0.2, 0.0)),
    ),
    "cone": (
        Cone(0.2, 0.6),
        np.pi * 0.04 * 0.6 / 3,
        lambda p: np.minimum(0.3 + p[:, 2], (0.3 - p[:, 2]) / 3 - radial(p)),
    ),
}


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_has_the_volume_of_its_formula(name: str) -> None:
    shape, volume, _ = SHAPES[name]
    (solid,) = geometries(shape)
    assert solid.computeVolume() == pytest.approx(volume)


@pytest.mark.parametrize("name", SHAPES)
def test_points_are_inside_a_shape_where_its_formula_says_so(name: str) -> None:
    shape, _, depth = SHAPES[name]
    points = np.random.default_rng(0).uniform(-1, 1, (400, 3)) * [0.25, 0.25, 0.4]
    depths = depth(points)
    assert (depths > 0).sum() > 10
    for point, expected in zip(points, depths, strict=True):
        if abs(expected) > 1e-5:
            assert (point_distance(geometries(shape), point) < 0.0) == (expected > 0.0)


def test_a_cone_points_up() -> None:
    (cone,) = geometries(Cone(0.2, 0.6))
    assert point_distance([cone], np.array([0.15, 0.0, -0.28])) < 0.0
    assert point_distance([cone], np.array([0.15, 0.0, 0.28])) > 0.0


def test_something_that_is_no_shape() -> None:
    with pytest.raises(TypeError, match="no solid for a shape of type str"):
        geometries("box")


# An object wholly inside another is in collision, never lost inside a shell.

PROFILE = np.array([[0, 0], [0.2, 0], [0.2, 0.2], [0.1, 0.2], [0.1, 0.1], [0, 0.1]])


def hosts(folder: Path) -> dict[str, tuple[Shape, Array]]:
    """Shapes, and a place well inside each."""
    return {
        "box": (Box((0.2, 0.4, 0.6)), np.zeros(3)),
        "sphere": (Sphere(0.3), np.zeros(3)),
        "cylinder": (Cylinder(0.1, 0.6), np.zeros(3)),
        "cone": (Cone(0.2, 0.6), np.array([0.0, 0.0, -0.2])),
        "floor of a bowl": (Revolve(PROFILE), np.array([0.0, 0.0, 0.05])),
        "wall of a bowl": (Revolve(PROFILE), np.array([0.0, 0.15, 0.15])),
        "convex mesh": (Mesh(write_obj(folder / "b.obj", *ball(12))), np.zeros(3)),
        "concave mesh": (
            Mesh(write_obj(folder / "u.obj", *u_shape())),
            np.array([0.05, 0.2, 0.05]),
        ),
    }


# A thing wholly inside another is in collision, never lost inside a shell.

BOWL = np.array([[0, 0], [0.2, 0], [0.2, 0.2], [0.1, 0.2], [0.1, 0.1], [0, 0.1]])


def mesh_in(folder: Path, name: str) -> Mesh:
    vertices, faces = ball(12) if name == "ball" else u_shape()
    return Mesh(write_obj(folder / f"{name}.obj", vertices, faces))


HOSTS: dict[str, tuple[Shape | str, tuple[float, float, float]]] = {
    "box": (Box((0.2, 0.4, 0.6)), (0.0, 0.0, 0.0)),
    "sphere": (Sphere(0.3), (0.0, 0.0, 0.0)),
    "cylinder": (Cylinder(0.1, 0.6), (0.0, 0.0, 0.1)),
    "cone": (Cone(0.2, 0.6), (0.0, 0.0, -0.2)),
    "floor of a bowl": (Revolve(BOWL), (0.0, 0.0, 0.05)),
    "wall of a bowl": (Revolve(BOWL), (0.0, 0.15, 0.15)),
    "convex mesh": ("ball", (0.0, 0.0, 0.0)),
    "concave mesh": ("u", (0.05, 0.2, 0.05)),
}


@pytest.mark.parametrize("name", HOSTS)
def test_a_ball_wholly_inside_is_in_collision(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    shape, place = HOSTS[name]
    if shape == "u":
        pytest.importorskip("coacd", reason="coacd cuts concave meshes")
    if isinstance(shape, str):
        shape = mesh_in(tmp_path, shape)
    turned = shift(3.0, 0.0, 1.0) @ TURNED
    world = among(Obstacle("host", shape, turned), Object("pea", Sphere(0.004), turned))
    rng, q = np.random.default_rng(0), q_tucked()
    for _ in range(20):
        offset = np.array(place) + rng.uniform(-0.02, 0.02, 3)
        held = held_at(world, "pea", q, turned @ shift(*offset))
        (contact,) = held.contacts(q)
        assert contact[:2] == ("host", "pea")
        assert contact.depth > 0.004
        beside = held_at(world, "pea", q, turned @ shift(0.0, 0.0, 0.7))
        assert not beside.any_collision(q[None])


TURNED = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])


# Fixtures

CUPBOARD = """<robot name="cupboard">
  <link name="body"><collision>
    <origin xyz="0 0 0.5"/><geometry><box size="0.4 0.6 1.0"/></geometry>
  </collision></link>
  <link name="drawer"><collision>
    <geometry><box size="0.2 0.2 0.2"/></geometry>
  </collision></link>
  <link name="wheel"><collision>
    <origin xyz="0.3 0 0"/><geometry><sphere radius="0.05"/></geometry>
  </collision></link>
  <link name="knob"><collision>
    <geometry><mesh filename="knob.obj" scale="2 2 2"/></geometry>
  </collision></link>
  <joint name="slide" type="prismatic">
    <parent link="body"/><child link="drawer"/><axis xyz="1 0 0"/>
    <limit lower="0.1" upper="0.5" effort="1" velocity="1"/>
  </joint>
  <joint name="turn" type="continuous">
    <parent link="body"/><child link="wheel"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="screw" type="fixed">
    <parent link="drawer"/><child link="knob"/><origin xyz="0.1 0 0"/>
  </joint>
</robot>"""


@pytest.fixture
def cupboard(tmp_path: Path) -> Path:
    write_obj(tmp_path / "knob.obj", TETRAHEDRON, TETRAHEDRON_FACES)
    path = tmp_path / "cupboard.urdf"
    path.write_text(CUPBOARD)
    return path


def centres(fixture: Fixture, T: Array) -> dict[str, Array]:
    """Where the links of a fixture stand in the world."""
    solids = solids_of_obstacle(Obstacle("cupboard", fixture, T))
    return {solid.owner: solid.placement for solid in solids}


def test_links_of_a_fixture_stand_where_its_joints_put_them(cupboard: Path) -> None:
    fixture = Fixture(cupboard, (("slide", 0.4), ("turn", 2.0)))
    T = shift(1.0, 2.0, 3.0) @ TURNED
    placed = centres(fixture, T)
    around = shift(0.3 * np.cos(2.0), 0.3 * np.sin(2.0), 0.0)[:3, 3]
    expected = {"body": (0, 0, 0.5), "drawer": (0.4, 0, 0), "knob": (0.5, 0, 0)}
    for link, place in {**expected, "wheel": around}.items():
        position = T @ [*place, 1.0]
        np.testing.assert_allclose(placed[f"cupboard/{link}"][:3, 3], position[:3])


def test_joints_that_are_not_named_are_at_0_or_as_near_as_they_get(
    cupboard: Path,
) -> None:
    placed = centres(Fixture(cupboard), np.eye(4))
    np.testing.assert_allclose(placed["cupboard/drawer"][:3, 3], [0.1, 0, 0])
    np.testing.assert_allclose(placed["cupboard/wheel"][:3, 3], [0.3, 0, 0])


def test_meshes_of_a_fixture_are_solid_and_scaled(cupboard: Path) -> None:
    solids = solids_of_obstacle(Obstacle("cupboard", Fixture(cupboard), np.eye(4)))
    (knob,) = (s for s in solids if s.owner == "cupboard/knob")
    assert knob.geometry.computeVolume() == pytest.approx(0.008 / 6, rel=1e-5)


def test_triangles_of_a_fixture_that_was_loaded_before_are_not_read(
    cupboard: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    obstacle = Obstacle("cupboard", Fixture(cupboard), np.eye(4))
    before = solids_of_obstacle(obstacle)
    monkeypatch.setattr(meshes, "read_surface", None)
    monkeypatch.setattr(coal.MeshLoader, "load", None)
    for ours, theirs in zip(solids_of_obstacle(obstacle), before, strict=True):
        assert (ours.owner, ours.geometry) == (theirs.owner, theirs.geometry)
        np.testing.assert_array_equal(ours.placement, theirs.placement)


def test_a_joint_that_a_fixture_does_not_have(cupboard: Path) -> None:
    with pytest.raises(InputError) as error:
        centres(Fixture(cupboard, (("door", 1.0),)), np.eye(4))
    assert str(error.value) == (
        f"{cupboard}: no joint 'door'; joints of this fixture: slide, turn"
    )


def test_a_fixture_that_cannot_be_read(tmp_path: Path) -> None:
    path = tmp_path / "broken.urdf"
    path.write_text("<robot name='a'><link/></robot>")
    with pytest.raises(InputError, match="this URDF cannot be read") as error:
        centres(Fixture(path), np.eye(4))
    assert str(error.value).startswith(f"{path}: ")


def test_a_fixture_with_an_open_mesh_names_the_mesh(cupboard: Path) -> None:
    knob = write_obj(cupboard.parent / "knob.obj", TETRAHEDRON, TETRAHEDRON_FACES[1:])
    with pytest.raises(InputError) as error:
        centres(Fixture(cupboard), np.eye(4))
    assert str(error.value).startswith(f"{knob}: this mesh is not closed")


def test_a_fixture_is_ground_with_all_its_links(cupboard: Path) -> None:
    fixture = Obstacle("cupboard", Fixture(cupboard), np.eye(4), ground=True)
    world = among(fixture)
    kinds = {b.kind for b in world.bodies if b.owner.startswith("cupboard/")}
    assert kinds == {"ground"}
