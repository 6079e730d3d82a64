"""A base that is held stays where it was, and everything else moves as before."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.assets import robots_folder
from mmplan.files.rigid_pose import from_rpy
from mmplan.fixed_base import hold_base, stand_at
from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.robot_file import RobotDescription, load_robot_description

PLACES = {"puma_mobile": (1.2, -0.7), "panda_mobile": (1.2, -0.7, 2.5)}
SEEDS = st.integers(0, 10_000)


@cache
def described(name: str) -> RobotDescription:
    return load_robot_description(robots_folder() / name / "robot.yaml")


@cache
def built(name: str, fixed: bool) -> Robot:
    robot = described(name)
    return build_robot(hold_base(robot, PLACES[name]) if fixed else robot)


@pytest.mark.parametrize("name", PLACES)
@given(seed=SEEDS)
def test_the_tool_is_where_it_was_with_the_base_held(name: str, seed: int) -> None:
    mobile, fixed = built(name, False), built(name, True)
    q = mobile.q_neutral.copy()
    arm = np.random.default_rng(seed).uniform(mobile.arm.lower, mobile.arm.upper)
    q[mobile.base.indices], q[mobile.arm.indices] = PLACES[name], arm
    q_fixed = fixed.q_neutral.copy()
    q_fixed[fixed.arm.indices] = arm
    np.testing.assert_allclose(
        fixed.tool_pose(q_fixed), mobile.tool_pose(q), atol=1e-12
    )


@pytest.mark.parametrize("name", PLACES)
def test_a_held_base_has_no_joints_and_keeps_its_bodies(name: str) -> None:
    mobile, fixed = built(name, False), built(name, True)
    assert (fixed.base_type, len(fixed.base), fixed.base_joint) == ("fixed", 0, 0)
    assert fixed.base_poses(np.empty((3, 0))).tolist() == [np.eye(4).tolist()] * 3
    kinds = [
        [r.kind_of(b) for b in r.geometry.geometryObjects] for r in (mobile, fixed)
    ]
    assert sorted(kinds[0]) == sorted(kinds[1])
    assert len(fixed.geometry.collisionPairs) == len(mobile.geometry.collisionPairs)


def test_a_robot_stands_where_it_is_told() -> None:
    robot = hold_base(described("puma_mobile"), (0.0, 0.0))
    pose = from_rpy((0.4, 0.5, 0.6), (0.0, 0.0, 1.1))
    moved = build_robot(stand_at(robot, pose))
    before = built("puma_mobile", True).tool_pose(np.zeros(8))
    before[:2, 3] -= PLACES["puma_mobile"]
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = pose.R, pose.xyz
    np.testing.assert_allclose(moved.tool_pose(np.zeros(8)), T @ before, atol=1e-12)
