from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.collision import CollisionWorld
from mmplan.collision.separation import transform
from mmplan.shapes import Array, read_only
from mmplan.verification.bodies import Bodies
from mmplan.verification.gaps import box_gaps, sphere_gaps
from tests.honest import T_OBJECT_TOOL, bottle_problem

SEEDS = st.integers(0, 10_000)


@pytest.fixture(scope="module")
def bodies() -> Bodies:
    """The Puma carrying a bottle above a counter."""
    world = CollisionWorld.of_problem(bottle_problem())
    world = world.attach("bottle", read_only(np.linalg.inv(T_OBJECT_TOOL)))
    limits = np.maximum(-world.model.lowerPositionLimit, world.model.upperPositionLimit)
    return Bodies(world.forbid_touch("bottle"), limits)


def random_configurations(bodies: Bodies, seed: int, n: int) -> Array:
    model, rng = bodies.world.model, np.random.default_rng(seed)
    return rng.uniform(
        model.lowerPositionLimit, model.upperPositionLimit, (n, model.nq)
    )


def corners_in_world(bodies: Bodies, q: Array) -> Array:
    """Corners (bodies, 8, 3) of the boxes about the bodies, by Pinocchio."""
    world = bodies.world
    data, geometry_data = world.model.createData(), world.geometry.createData()
    pin.updateGeometryPlacements(world.model, data, world.geometry, geometry_data, q)
    signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    points = bodies.centres[:, None] + signs * bodies.halves[:, None]
    T = np.array([T.homogeneous for T in geometry_data.oMg])
    return np.einsum("bij,bkj->bki", T[:, :3, :3], points) + T[:, None, :3, 3]


@given(SEEDS)
def test_centres_are_where_pinocchio_puts_them(bodies: Bodies, seed: int) -> None:
    q = random_configurations(bodies, seed, 3)
    centres = bodies.centres_at(bodies.joint_poses(q))
    for k in range(3):
        expected = corners_in_world(bodies, q[k]).mean(axis=1)
        assert centres[k] == pytest.approx(expected, abs=1e-9)


@given(SEEDS)
def test_no_point_moves_farther_than_levers_allow(bodies: Bodies, seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = random_configurations(bodies, seed, 2)
    model = bodies.world.model
    q[1] = q[0] + rng.uniform(0, 1) * (q[1] - q[0]) * rng.integers(0, 2, model.nq)
    a, b = corners_in_world(bodies, q[0]), corners_in_world(bodies, q[1])
    moved = np.linalg.norm(b - a, axis=2).max(axis=1)
    assert np.all(moved <= bodies.levers @ np.abs(q[1] - q[0]) + 1e-9)


def test_levers_are_not_much_longer_than_they_need_be(bodies: Bodies) -> None:
    """The hand's farthest point from joint 6 turns on a circle that large."""
    j6 = bodies.world.model.joints[bodies.world.model.getJointId("joint6")].idx_q
    q = np.zeros((2, bodies.world.model.nq))
    q[1, j6] = 1e-4
    a, b = (corners_in_world(bodies, row) for row in q)
    moved = np.linalg.norm(b - a, axis=2).max(axis=1) / 1e-4
    hand = bodies.belong_to(["hand"])
    assert bodies.levers[hand, j6] == pytest.approx(moved[hand], rel=1e-3)


@given(SEEDS)
def test_distances_change_no_faster_than_relative_levers(
    bodies: Bodies, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    q = random_configurations(bodies, seed, 2)
    q[1] = q[0] + rng.uniform(0, 0.3) * (q[1] - q[0])
    pairs = bodies.world.pairs[rng.integers(0, len(bodies.world.pairs), 40)]
    d = np.array([distances(bodies, row, pairs) for row in q])
    reach = bodies.relative_levers(*pairs.T) @ np.abs(q[1] - q[0])
    assert np.all(np.abs(d[1] - d[0]) <= reach + 1e-5)


def test_joints_that_move_both_bodies_do_not_count(bodies: Bodies) -> None:
    owners = np.array(bodies.owners)
    first, second = (
        np.array([np.flatnonzero(owners == name)[0]])
        for name in ("hand", "finger_left")
    )
    levers = bodies.relative_levers(first, second)[0]
    names = np.array(bodies.world.model.names)[1:]
    assert list(names[levers > 0.0]) == ["finger_left"]


@given(SEEDS)
def test_gaps_never_exceed_distances(bodies: Bodies, seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = random_configurations(bodies, seed, 1)
    pairs = bodies.world.pairs[rng.integers(0, len(bodies.world.pairs), 60)]
    first, second = pairs.T
    T = bodies.joint_poses(q)
    centres, moment = bodies.centres_at(T)[0], np.zeros(len(first), dtype=np.int64)
    apart = centres[second] - centres[first]
    spheres = sphere_gaps(apart, bodies.radii[first] + bodies.radii[second])
    boxes = box_gaps(
        apart,
        bodies.rotations_at(T, moment, first),
        bodies.halves[first],
        bodies.rotations_at(T, moment, second),
        bodies.halves[second],
    )
    d = distances(bodies, q[0], pairs)
    assert np.all(spheres <= d + 1e-5)
    assert np.all(boxes <= d + 1e-5)


def test_gaps_of_boxes_face_to_face_are_exact() -> None:
    eye, half = np.eye(3)[None], np.array([[0.1, 0.2, 0.3]])
    apart = np.array([[0.0, 0.0, 1.0]])
    assert box_gaps(apart, eye, half, eye, half) == pytest.approx(np.array([0.4]))
    turned = np.array([[[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]])
    assert box_gaps(apart, eye, half, turned, half) == pytest.approx(np.array([0.6]))


def test_the_depth_of_boxes_is_bounded_from_below() -> None:
    eye, half = np.eye(3)[None], np.array([[0.1, 0.2, 0.3]])
    apart = np.array([[0.15, 0.0, 0.0]])
    assert box_gaps(apart, eye, half, eye, half) == pytest.approx(np.array([-0.05]))


def distances(bodies: Bodies, q: Array, pairs: Array) -> Array:
    """Signed distances (pairs,) at one configuration."""
    T, separation = bodies.joint_poses(q[None])[0], bodies.separation
    poses = [
        transform(T[joint] @ placement)
        for joint, placement in zip(bodies.joints, bodies.placements, strict=True)
    ]
    pairs = pairs.tolist()
    return np.array([separation.distance(i, poses[i], j, poses[j]) for i, j in pairs])
