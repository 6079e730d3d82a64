"""Every robot that is shipped: it loads, and it is what its description says."""

from __future__ import annotations

from functools import cache

import coal
import numpy as np
import pinocchio as pin
import pytest

from benchmarks.score_scales import score_scales
from mmplan.assets import robot_names, robots_folder
from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.robot_file import RobotDescription, load_robot_description
from mmplan.shapes import Array

ROBOTS = robot_names()


@cache
def described(name: str) -> RobotDescription:
    return load_robot_description(robots_folder() / name / "robot.yaml")


@cache
def loaded(name: str) -> Robot:
    return build_robot(described(name))


def draw(robot: Robot, n: int, seed: int) -> Array:
    """Random configurations (n, nq) within limits."""
    lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    return np.random.default_rng(seed).uniform(lower, upper, (n, robot.model.nq))


def test_the_papers_robot_is_shipped() -> None:
    assert "puma_mobile" in ROBOTS


@pytest.mark.parametrize("name", ROBOTS)
def test_groups_cover_all_joints_in_order(name: str) -> None:
    robot = loaded(name)
    groups = (robot.base, robot.arm, robot.hand)
    indices = np.concatenate([group.indices for group in groups])
    np.testing.assert_array_equal(indices, np.arange(robot.model.nq))
    assert [n for g in groups for n in g.names] == list(robot.model.names)[1:]
    for group in groups:
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


@pytest.mark.parametrize("name", ROBOTS)
def test_collision_bodies_enclose_the_joints(name: str) -> None:
    """The axis of each arm joint passes through a body on either side of it."""
    robot = loaded(name)
    data = robot.model.createData()
    q = robot.q_neutral.copy()
    q[robot.arm.indices] = robot.configurations["home"]
    geometry_data = robot.geometry.createData()
    pin.updateGeometryPlacements(robot.model, data, robot.geometry, geometry_data, q)
    line = coal.Capsule(1e-4, 4.0)
    for joint in (robot.model.getJointId(n) for n in robot.arm.names):
        T_world_joint = data.oMi[joint]
        for side in (joint, robot.model.parents[joint]):
            gaps = [
                coal.distance(
                    line,
                    _transform(T_world_joint),
                    body.geometry,
                    _transform(T_world_body),
                    coal.DistanceRequest(),
                    coal.DistanceResult(),
                )
                for body, T_world_body in zip(
                    robot.geometry.geometryObjects, geometry_data.oMg, strict=True
                )
                if body.parentJoint == side
            ]
            assert min(gaps) < 0, robot.model.names[joint]


def _transform(T: pin.SE3) -> coal.Transform3s:
    return coal.Transform3s(T.rotation, T.translation)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_tool_frame_follows_the_convention(name: str) -> None:
    """z points out of the hand, y is the line on which the fingers close."""
    robot = loaded(name)
    q = robot.q_neutral.copy()
    in_tool = {}
    for state, hand in (("open", robot.hand_open), ("closed", robot.hand_closed)):
        q[robot.hand.indices] = hand
        data, geometry = robot.model.createData(), robot.geometry.createData()
        pin.updateGeometryPlacements(robot.model, data, robot.geometry, geometry, q)
        pin.updateFramePlacements(robot.model, data)
        T_tool_world = data.oMf[robot.tool_frame].inverse()
        in_tool[state] = np.array(
            [(T_tool_world * T).translation for T in geometry.oMg]
        )
    kinds = [robot.kind_of(body) for body in robot.geometry.geometryObjects]
    fingers = np.array([kind == "finger" for kind in kinds])
    hand_joint = np.array(
        [b.parentJoint == robot.tool_joint for b in robot.geometry.geometryObjects]
    )
    closing = (in_tool["closed"] - in_tool["open"])[fingers]
    np.testing.assert_allclose(closing[:, [0, 2]], 0, atol=1e-12)
    assert np.all(closing[:, 1] * in_tool["open"][fingers, 1] < 0)
    np.testing.assert_allclose(in_tool["open"][fingers].mean(axis=0)[:2], 0, atol=1e-12)
    assert np.all(in_tool["open"][hand_joint & ~fingers, 2] < -0.03)


@pytest.mark.parametrize("name", ROBOTS)
def test_reach_is_that_of_the_stretched_arm(name: str) -> None:
    robot = loaded(name)
    base = robot.model.getJointId(robot.base.names[-1])
    data = robot.model.createData()
    farthest = 0.0
    for q in draw(robot, 20_000, seed=3):
        pin.framesForwardKinematics(robot.model, data, q)
        T_base_tool = data.oMi[base].inverse() * data.oMf[robot.tool_frame]
        farthest = max(farthest, np.hypot(*T_base_tool.translation[:2]))
    assert 0.9 * robot.reach < farthest <= robot.reach + 1e-3


@pytest.mark.parametrize("name", ROBOTS)
def test_score_scales_are_those_of_the_robot(name: str) -> None:
    found, computed = loaded(name).score_scales, score_scales(loaded(name))
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
