"""Every robot that is shipped: it loads, and it is what its description says."""

from __future__ import annotations

from functools import cache

import coal
import numpy as np
import pinocchio as pin
import pytest

from mmplan.assets import robot_names, robots_folder
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.robot_file import RobotDescription, load_robot_description
from mmplan.robot_measures import base_radius, reach
from mmplan.robot_setup.score_scales import score_scales
from mmplan.shapes import Array

ROBOTS = robot_names()


@cache
def described(name: str) -> RobotDescription:
    return load_robot_description(robots_folder() / name / "robot.yaml")


@cache
def loaded(name: str) -> Robot:
    return build_robot(described(name))


def draw(robot: Robot, n: int, seed: int) -> Array:
    """Random configurations (n, nq) within limits, the base near the origin."""
    lower, upper = np.empty((2, robot.model.nq))
    for group in (robot.base, robot.arm, robot.hand):
        lower[group.indices] = np.where(group.wraps, -np.pi, group.lower)
        upper[group.indices] = np.where(group.wraps, np.pi, group.upper)
    lower[robot.base.indices] = np.maximum(lower[robot.base.indices], -3.0)
    upper[robot.base.indices] = np.minimum(upper[robot.base.indices], 3.0)
    rng = np.random.default_rng(seed)
    return robot.with_followers(rng.uniform(lower, upper, (n, robot.model.nq)))


def test_the_papers_robot_is_shipped() -> None:
    assert "puma_mobile" in ROBOTS


@pytest.mark.parametrize("name", ROBOTS)
def test_groups_cover_all_joints(name: str) -> None:
    robot = loaded(name)
    groups = (robot.base, robot.arm, robot.hand)
    indices = np.concatenate([group.indices for group in groups])
    np.testing.assert_array_equal(np.sort(indices), np.arange(robot.model.nq))
    assert robot.model.nq == robot.model.nv
    for group in groups:
        names = [robot.model.names[int(i) + 1] for i in group.indices]
        assert names == list(group.names)
        assert np.all(np.isfinite(group.lower) != group.wraps)
        assert np.all(group.lower < group.upper)
        assert np.all(group.velocity > 0)
        assert np.all(group.acceleration > 0)


@pytest.mark.parametrize("name", ROBOTS)
def test_named_configurations_are_within_limits_and_free(name: str) -> None:
    robot = loaded(name)
    assert {"home", "tucked"} <= set(robot.configurations)
    data, geometry = robot.model.createData(), robot.geometry.createData()
    for q_arm in robot.configurations.values():
        for hand in (robot.hand_open, robot.hand_closed):
            q = robot.q_neutral.copy()
            q[robot.arm.indices], q[robot.hand.indices] = q_arm, hand
            assert np.all(q >= robot.model.lowerPositionLimit)
            assert np.all(q <= robot.model.upperPositionLimit)
            assert not pin.computeCollisions(
                robot.model, data, robot.geometry, geometry, q, True
            )


@pytest.mark.parametrize("name", ROBOTS)
def test_pairs_said_never_to_meet_never_meet(name: str) -> None:
    robot = loaded(name)
    never = {
        frozenset(pair[:2])
        for pair in described(name).disabled_pairs
        if pair[2].startswith("never")
    }
    assert never
    geometry = robot.geometry.copy()
    geometry.removeAllCollisionPairs()
    bodies = list(enumerate(geometry.geometryObjects))
    for i, first in bodies:
        for j, second in bodies[i + 1 :]:
            if {robot.link_of(first), robot.link_of(second)} in never:
                geometry.addCollisionPair(pin.CollisionPair(i, j))
    assert len(geometry.collisionPairs) >= len(never)
    data, geometry_data = robot.model.createData(), geometry.createData()
    for q in draw(robot, 2000, seed=1):
        assert not pin.computeCollisions(
            robot.model, data, geometry, geometry_data, q, True
        )


@pytest.mark.parametrize("name", ROBOTS)
def test_every_other_pair_that_moves_is_checked(name: str) -> None:
    robot = loaded(name)
    disabled = {frozenset(pair[:2]) for pair in described(name).disabled_pairs}
    checked = {
        frozenset((pair.first, pair.second)) for pair in robot.geometry.collisionPairs
    }
    bodies = list(enumerate(robot.geometry.geometryObjects))
    for i, first in bodies:
        for j, second in bodies[i + 1 :]:
            links = frozenset((robot.link_of(first), robot.link_of(second)))
            moves = first.parentJoint != second.parentJoint
            assert ({i, j} in checked) == (moves and links not in disabled)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_self_collision_is_seen(name: str) -> None:
    robot = loaded(name)
    data, geometry = robot.model.createData(), robot.geometry.createData()
    hits = [
        pin.computeCollisions(robot.model, data, robot.geometry, geometry, q, True)
        for q in draw(robot, 2000, seed=2)
    ]
    assert 0 < sum(hits) < len(hits)


def test_bodies_of_the_papers_robot_enclose_its_joints() -> None:
    """The axis of each arm joint passes through a body on either side of it."""
    robot = loaded("puma_mobile")
    q = robot.q_neutral.copy()
    q[robot.arm.indices] = robot.configurations["home"]
    data = robot.model.createData()
    bodies = placed_bodies(robot, q)
    pin.forwardKinematics(robot.model, data, q)
    line = coal.Capsule(1e-4, 4.0)
    for joint in (robot.model.getJointId(n) for n in robot.arm.names):
        for side in (joint, robot.model.parents[joint]):
            gaps = [
                gap(line, data.oMi[joint], body.geometry, T)[0]
                for body, T in bodies
                if body.parentJoint == side
            ]
            assert min(gaps) < 0, robot.model.names[joint]


def placed_bodies(robot: Robot, q: Array) -> list[tuple[pin.GeometryObject, pin.SE3]]:
    """The collision bodies with their poses in the world at a configuration."""
    data, geometry = robot.model.createData(), robot.geometry.createData()
    pin.updateGeometryPlacements(robot.model, data, robot.geometry, geometry, q)
    return list(zip(robot.geometry.geometryObjects, geometry.oMg, strict=True))


def gap(
    first: coal.CollisionGeometry,
    T_world_first: pin.SE3,
    second: coal.CollisionGeometry,
    T_world_second: pin.SE3,
) -> tuple[float, Array]:
    """The distance of two bodies and the point of the second nearest to the first."""
    result = coal.DistanceResult()
    poses = [
        coal.Transform3s(T.rotation, T.translation)
        for T in (T_world_first, T_world_second)
    ]
    request = coal.DistanceRequest()
    distance = coal.distance(first, poses[0], second, poses[1], request, result)
    return float(distance), np.array(result.getNearestPoint2())


@pytest.mark.parametrize("name", ROBOTS)
def test_the_fingers_meet_at_the_tool_frame_along_y(name: str) -> None:
    """They are on either side of it, close along y, and meet at its origin."""
    robot = loaded(name)
    gaps, points = _nearest_finger_bodies(robot, share_closed=0.0)
    assert gaps.min() > 0.02
    mirrored = points[1] * (1, -1, 1)
    np.testing.assert_allclose(points[0], mirrored, atol=2e-3)
    assert abs(points[0, 1]) > 0.02
    gaps, points = _nearest_finger_bodies(robot, share_closed=0.9)
    np.testing.assert_allclose(points[:, [0, 2]], 0, atol=3e-3)
    assert points[0, 1] * points[1, 1] < 0
    assert gaps.max() < 0.01
    gaps, _ = _nearest_finger_bodies(robot, share_closed=1.0)
    assert gaps.max() < 1e-3


def _nearest_finger_bodies(robot: Robot, share_closed: float) -> tuple[Array, Array]:
    """Of the two nearest: gaps to the tool's origin, nearest points in its frame."""
    q = robot.q_neutral.copy()
    stroke = robot.hand_closed - robot.hand_open
    q[robot.hand.indices] = robot.hand_open + share_closed * stroke
    T_world_tool = pin.SE3(robot.tool_pose(q))
    found = [
        gap(coal.Sphere(1e-6), T_world_tool, body.geometry, T)
        for body, T in placed_bodies(robot, q)
        if robot.kind_of(body) == "finger"
    ]
    nearest = sorted(found, key=lambda item: item[0])[:2]
    points = [T_world_tool.actInv(point) for _, point in nearest]
    return np.array([distance for distance, _ in nearest]), np.array(points)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_hand_is_behind_the_tool_frame(name: str) -> None:
    """z of the tool frame points out of the hand."""
    robot = loaded(name)
    q = robot.q_neutral
    T_world_tool = pin.SE3(robot.tool_pose(q))
    behind = [
        T_world_tool.actInv(T.act(np.ravel(body.geometry.computeCOM())))[2]
        for body, T in placed_bodies(robot, q)
        if robot.kind_of(body) == "finger" or body.parentJoint == robot.tool_joint
    ]
    assert max(behind) < 1e-3
    assert min(behind) < -0.05


@pytest.mark.parametrize("name", ROBOTS)
def test_reach_is_that_of_the_stretched_arm(name: str) -> None:
    robot = loaded(name)
    q = draw(robot, 20_000, seed=3)
    poses = joint_placements(robot.model, q)
    T_world_tool = poses[:, robot.tool_joint] @ robot.T_joint_tool
    offset = T_world_tool[:, :2, 3] - poses[:, robot.base_joint, :2, 3]
    farthest = np.hypot(*offset.T).max()
    assert 0.85 * robot.reach < farthest <= robot.reach + 1e-3
    computed = reach(robot.model, robot.arm, robot.base_joint, robot.tool_frame)
    assert computed == pytest.approx(robot.reach, abs=2e-3)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_bases_radius_encloses_it(name: str) -> None:
    robot = loaded(name)
    assert base_radius(robot.geometry, robot.base_joint) <= robot.base_radius + 1e-2


@pytest.mark.parametrize("name", ROBOTS)
def test_score_scales_are_those_of_the_robot(name: str) -> None:
    robot = loaded(name)
    found = robot.score_scales
    computed = score_scales(robot, robot.configurations["home"])
    assert found.manipulability == pytest.approx(computed.manipulability, rel=0.01)
    assert found.clutter == pytest.approx(computed.clutter, rel=0.01)


def denavit_hartenberg(theta: Array) -> Array:
    """T_mount_flange of the Puma 560 after the published table, flange at 0.0558 m."""
    T = np.eye(4)
    for angle, alpha, a, d in zip(
        theta,
        np.radians([90, 0, -90, 90, -90, 0]),
        [0, 0.4318, 0.0203, 0, 0, 0],
        [0.67183, 0, 0.15005, 0.4318, 0, 0.0558],
        strict=True,
    ):
        c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
        T = T @ np.array(
            [
                [c, -s * ca, s * sa, a * c],
                [s, c * ca, -c * sa, a * s],
                [0, sa, ca, d],
                [0, 0, 0, 1],
            ]
        )
    return T


def test_puma_mobile_follows_the_published_table() -> None:
    robot = loaded("puma_mobile")
    T_flange_tool = np.eye(4)
    T_flange_tool[2, 3] = 0.13
    for q in draw(robot, 1000, seed=4):
        T_world_mount = np.eye(4)
        T_world_mount[:3, 3] = [*q[:2], 0.33]
        expected = T_world_mount @ denavit_hartenberg(q[2:8]) @ T_flange_tool
        np.testing.assert_allclose(robot.tool_pose(q), expected, rtol=0, atol=1e-12)


def test_puma_mobile_has_the_published_limits() -> None:
    arm = loaded("puma_mobile").arm
    lower, upper = [-160, -45, -225, -110, -100, -266], [160, 225, 45, 170, 100, 266]
    np.testing.assert_allclose(np.degrees(arm.lower), lower, atol=1e-9)
    np.testing.assert_allclose(np.degrees(arm.upper), upper, atol=1e-9)
    speeds = [82, 74, 122, 228, 241, 228]
    np.testing.assert_allclose(np.degrees(arm.velocity), speeds, atol=0.1)


def test_puma_mobile_tucks_its_arm_in() -> None:
    robot = loaded("puma_mobile")
    q = robot.q_neutral.copy()
    q[robot.arm.indices] = robot.configurations["tucked"]
    data, geometry = robot.model.createData(), robot.geometry.createData()
    pin.updateGeometryPlacements(robot.model, data, robot.geometry, geometry, q)
    for body, T in zip(robot.geometry.geometryObjects, geometry.oMg, strict=True):
        body.geometry.computeLocalAABB()
        box = body.geometry.aabb_local
        corner = np.array([box.min_, box.max_]).T
        points = np.array(np.meshgrid(*corner)).reshape(3, -1).T
        outermost = np.linalg.norm(
            (points @ T.rotation.T + T.translation)[:, :2], axis=1
        )
        assert outermost.max() < robot.base_radius + 0.15
