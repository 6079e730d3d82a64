"""Laws of the Puma's inverse kinematics, judged by Pinocchio's forward kinematics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.assets import robots_folder
from mmplan.exceptions import InputError
from mmplan.ik.puma import Puma, puma
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.robot_file import load_robot_description
from mmplan.shapes import Array

DESCRIPTION = load_robot_description(robots_folder() / "puma_mobile" / "robot.yaml")
ROBOT: Robot = build_robot(DESCRIPTION)
LOWER, UPPER = ROBOT.arm.lower, ROBOT.arm.upper
# Joint 3 at which the forearm is in line with the upper arm.
Q3_STRAIGHT = -np.arctan2(0.4318, 0.0203)
ACCURACY = 1e-9


def tool_poses(q_arm: Array) -> Array:
    """T_base_tool (n, 4, 4) at arm configurations (n, 6), the base off the origin."""
    q = np.tile(pin.neutral(ROBOT.model), (len(q_arm), 1))
    q[:, ROBOT.base.indices] = (0.7, -0.4)
    q[:, ROBOT.arm.indices] = q_arm
    data = ROBOT.model.createData()
    base = ROBOT.model.getJointId(ROBOT.base.names[-1])
    T = np.empty((len(q), 4, 4))
    for i, row in enumerate(q):
        pin.framesForwardKinematics(ROBOT.model, data, row)
        T[i] = (data.oMi[base].inverse() * data.oMf[ROBOT.tool_frame]).homogeneous
    return T


def draw(n: int, seed: int) -> Array:
    return np.random.default_rng(seed).uniform(LOWER, UPPER, (n, 6))


def turn_apart(q: Array, other: Array) -> Array:
    """The largest joint difference up to whole turns, over the last axis."""
    return np.abs((q - other + np.pi) % (2 * np.pi) - np.pi).max(axis=-1)


def wrist_offset(q_arm: Array) -> Array:
    """How far ahead of joint 1's axis the wrist's centre is, in the arm's plane, (n,).

    It vanishes where the shoulder's two branches meet.
    """
    q23 = q_arm[:, 1] + q_arm[:, 2]
    along: Array = 0.4318 * np.cos(q_arm[:, 1]) + 0.0203 * np.cos(q23)
    return along - 0.4318 * np.sin(q23)


def assert_reached(T_base_tool: Array) -> None:
    """Each pose has solutions, and all of them put the tool where it was asked for."""
    solutions = ROBOT.ik.solve(T_base_tool)
    row, branch = np.nonzero(solutions.exists)
    found = tool_poses(solutions.q[row, branch])
    np.testing.assert_allclose(found, T_base_tool[row], rtol=0, atol=ACCURACY)
    assert solutions.exists.any(axis=1).all()


def test_every_branch_places_the_tool() -> None:
    assert_reached(tool_poses(draw(4000, seed=1)))


def test_the_source_is_among_the_branches() -> None:
    q = draw(5000, seed=2)
    regular = (
        (np.abs(np.sin(q[:, 4])) > 1e-3)
        & (np.abs(q[:, 2] - Q3_STRAIGHT) > 1e-3)
        & (np.abs(wrist_offset(q)) > 1e-3)
    )
    q = q[regular]
    assert len(q) > 4900
    solutions = ROBOT.ik.solve(tool_poses(q))
    distance = np.where(solutions.exists, turn_apart(solutions.q, q[:, None]), np.inf)
    nearest = distance.argmin(axis=1)
    rows = np.arange(len(q))
    assert distance[rows, nearest].max() < ACCURACY
    assert solutions.within[rows, nearest].all()


def test_a_regular_pose_has_eight_or_four_branches() -> None:
    counts = ROBOT.ik.solve(tool_poses(draw(3000, seed=3))).exists.sum(axis=1)
    assert set(counts) <= {4, 8}
    assert (counts == 8).mean() > 0.8


def test_within_is_exactly_within_the_joint_limits() -> None:
    solutions = ROBOT.ik.solve(tool_poses(draw(3000, seed=4)))
    assert np.isnan(solutions.q[~solutions.exists]).all()
    assert np.isfinite(solutions.q[solutions.exists]).all()
    inside = ((solutions.q >= LOWER) & (solutions.q <= UPPER)).all(axis=2)
    np.testing.assert_array_equal(solutions.within, inside)
    assert (solutions.within < solutions.exists).any()


@pytest.mark.parametrize("seed", range(3))
def test_a_joint_within_reach_of_its_limits_is_not_left_outside(seed: int) -> None:
    solutions = ROBOT.ik.solve(tool_poses(draw(500, seed)))
    q = solutions.q[solutions.exists]
    middle = 0.5 * (LOWER + UPPER)
    for turns in (-1, 1):
        other = q + 2 * np.pi * turns
        assert np.all(np.abs(q - middle) <= np.abs(other - middle) + 1e-12)


@pytest.mark.parametrize("tilt", [0.0, 1e-12, 1e-10, 1e-9, 1e-7, 1e-5])
def test_aligned_wrist(tilt: float) -> None:
    q = draw(500, seed=5)
    q[:, 4] = tilt
    T = tool_poses(q)
    assert_reached(T)
    assert ROBOT.ik.solve(T).within.any(axis=1).all()


def test_aligned_wrist_has_no_duplicates() -> None:
    q = draw(500, seed=6)
    q[:, 4] = 0.0
    assert_no_duplicates(tool_poses(q))


@pytest.mark.parametrize("bend", [0.0, 1e-12, 1e-8, 1e-6, 1e-4])
def test_straight_elbow(bend: float) -> None:
    q = draw(300, seed=7)
    q[:, 2] = Q3_STRAIGHT + bend
    T = tool_poses(q)
    assert_reached(T)
    assert_no_duplicates(T)


@pytest.mark.parametrize("offset", [0.0, 1e-12, 1e-8, 1e-5])
def test_wrist_above_the_shoulder(offset: float) -> None:
    q = draw(300, seed=8)
    q[:, 1] += _turn_to_offset(q, offset)
    np.testing.assert_allclose(wrist_offset(q), offset, rtol=0, atol=1e-14)
    T = tool_poses(q)
    assert_reached(T)
    assert_no_duplicates(T)


def _turn_to_offset(q: Array, offset: float) -> Array:
    """The turn of joint 2 that brings the wrist's centre to `offset`, (n,)."""
    a, b = wrist_offset(q), wrist_offset(q + np.array([0, np.pi / 2, 0, 0, 0, 0]))
    return np.arctan2(b, a) + np.arccos(offset / np.hypot(a, b))


def assert_no_duplicates(T_base_tool: Array) -> None:
    solutions = ROBOT.ik.solve(T_base_tool)
    for q in (row[e] for row, e in zip(solutions.q, solutions.exists, strict=True)):
        apart = turn_apart(q[:, None], q[None, :]) + 10 * np.eye(len(q))
        assert apart.min() > 1e-7


@given(xyz=st.tuples(*[st.floats(-3, 3)] * 3), seed=st.integers(0, 2**32 - 1))
def test_poses_out_of_reach_have_no_solution(
    xyz: tuple[float, float, float], seed: int
) -> None:
    T = tool_poses(draw(1, seed))
    T[0, :3, 3] = xyz
    solutions = ROBOT.ik.solve(T)
    T_base_wrist = T[0] @ np.linalg.inv(ROBOT.T_joint_tool)
    wrist = T_base_wrist[:3, 3] - [0, 0, 0.33 + 0.67183]
    reach = np.hypot(0.4318 + np.hypot(0.0203, 0.4318), 0.15005)
    if np.linalg.norm(wrist) > reach + 1e-9 or np.hypot(*wrist[:2]) < 0.15005 - 1e-9:
        assert not solutions.exists.any()
        assert np.isnan(solutions.q).all()
    else:
        np.testing.assert_allclose(
            tool_poses(solutions.q[0, solutions.exists[0]]),
            np.repeat(T, solutions.exists.sum(), axis=0),
            rtol=0,
            atol=ACCURACY,
        )


def test_poses_that_are_not_numbers_have_no_solution() -> None:
    T = tool_poses(draw(2, seed=9))
    T[0] = np.nan
    solutions = ROBOT.ik.solve(T)
    assert not solutions.exists[0].any()
    assert solutions.exists[1].any()


def test_batch_answers_equal_single_ones() -> None:
    T = tool_poses(draw(700, seed=10))
    batch = ROBOT.ik.solve(T)
    for i in range(len(T)):
        single = ROBOT.ik.solve(T[i : i + 1])
        np.testing.assert_array_equal(single.exists[0], batch.exists[i])
        np.testing.assert_array_equal(single.within[0], batch.within[i])
        np.testing.assert_allclose(single.q[0], batch.q[i], rtol=0, atol=1e-12)


def test_no_poses_are_no_solutions() -> None:
    assert ROBOT.ik.solve(np.empty((0, 4, 4))).q.shape == (0, 8, 6)


def test_solutions_agree_with_the_batched_kinematics() -> None:
    T = tool_poses(draw(200, seed=11))
    solutions = ROBOT.ik.solve(T)
    row, branch = np.nonzero(solutions.exists)
    q = np.tile(ROBOT.q_neutral, (len(row), 1))
    q[:, ROBOT.arm.indices] = solutions.q[row, branch]
    found = joint_placements(ROBOT.model, q)[:, ROBOT.tool_joint] @ ROBOT.T_joint_tool
    np.testing.assert_allclose(found, T[row], rtol=0, atol=ACCURACY)


def test_a_length_that_is_not_the_models_is_refused() -> None:
    settings = {**DESCRIPTION.ik_settings, "d3": 0.1254}
    with pytest.raises(InputError, match=r"'joint4'.*d = 0\.1254 m"):
        build_robot(replace(DESCRIPTION, ik_settings=settings))


def test_a_missing_length_is_named() -> None:
    settings = {k: v for k, v in DESCRIPTION.ik_settings.items() if k != "a3"}
    with pytest.raises(InputError, match="missing: a3"):
        build_robot(replace(DESCRIPTION, ik_settings=settings))


def test_the_tool_must_be_on_the_last_joint() -> None:
    with pytest.raises(InputError, match="'forearm' is not moved by"):
        build_robot(replace(DESCRIPTION, tool="forearm"))


def test_an_arm_of_another_kind_is_refused() -> None:
    joints = (*ROBOT.arm.names[:5], "finger_left")
    with pytest.raises(InputError, match="'finger_left' does not turn about its z"):
        puma(ROBOT.model, joints, ROBOT.tool_frame, DESCRIPTION.ik_settings)
    with pytest.raises(InputError, match="for 6 joints, not 5"):
        puma(ROBOT.model, joints[:5], ROBOT.tool_frame, DESCRIPTION.ik_settings)


def test_the_shipped_solver_is_the_pumas() -> None:
    assert isinstance(ROBOT.ik, Puma)
