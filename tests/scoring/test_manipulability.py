"""M = min(eigs(J Jᵀ)), by laws."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mmplan.robot import Robot
from mmplan.scoring.manipulability import manipulability
from mmplan.shapes import Array
from tests.honest import puma

ROBOT = puma()
UNIT = arrays(np.float64, ROBOT.model.nq, elements=st.floats(0.0, 1.0))


def within_limits(unit: Array) -> Array:
    """A configuration (nq,) from numbers in [0, 1]."""
    low, high = ROBOT.model.lowerPositionLimit, ROBOT.model.upperPositionLimit
    return low + unit * (high - low)


def jacobian_by_differences(robot: Robot, q: Array, step: float = 1e-6) -> Array:
    """The arm's Jacobian (6, arm joints) at the tool, from poses alone."""
    columns = []
    for index in robot.arm.indices:
        move = np.zeros(robot.model.nq)
        move[index] = step
        T_before, T_after = (pin.SE3(robot.tool_pose(q + s * move)) for s in (-1, 1))
        columns.append(pin.log6(T_before.actInv(T_after)).vector / (2 * step))
    return np.stack(columns, axis=1)


def smallest_eigenvalue(J: Array) -> float:
    return float(np.linalg.eigvals(J @ J.T).real.min())


@given(UNIT)
def test_m_is_the_smallest_eigenvalue_of_pinocchios_jacobian(unit: Array) -> None:
    q = within_limits(unit)
    data = ROBOT.model.createData()
    axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    J = pin.computeFrameJacobian(ROBOT.model, data, q, ROBOT.tool_frame, axes)
    expected = smallest_eigenvalue(J[:, ROBOT.arm.indices])
    assert manipulability(ROBOT, q[None])[0] == pytest.approx(expected, abs=1e-12)


@given(UNIT)
def test_m_agrees_with_finite_differences(unit: Array) -> None:
    q = within_limits(unit)
    expected = smallest_eigenvalue(jacobian_by_differences(ROBOT, q))
    assert manipulability(ROBOT, q[None])[0] == pytest.approx(expected, abs=1e-8)


@given(UNIT, st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(-2.0, 2.0))
def test_m_does_not_depend_on_where_the_robot_stands_or_faces(
    unit: Array, x: float, y: float, turn: float
) -> None:
    q = within_limits(unit)
    elsewhere = q.copy()
    elsewhere[ROBOT.base.indices] = x, y
    elsewhere[ROBOT.arm.indices[0]] += turn
    elsewhere[ROBOT.hand.indices] = ROBOT.hand_closed
    here, there = manipulability(ROBOT, np.stack([q, elsewhere]))
    assert there == pytest.approx(here, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "arm"),
    [
        ("wrist", [0.3, 1.5, -2.6, 0.4, 0.0, 0.2]),
        ("elbow", [0.3, 1.0, -np.arctan2(0.4318, 0.0203), 0.4, 0.7, 0.2]),
    ],
)
def test_m_is_zero_at_a_singularity_and_not_beside_it(
    name: str, arm: list[float]
) -> None:
    joint = {"wrist": 4, "elbow": 2}[name]
    q = np.tile(ROBOT.q_neutral, (2, 1))
    q[:, ROBOT.arm.indices] = arm
    q[1, ROBOT.arm.indices[joint]] += 0.3
    at, beside = manipulability(ROBOT, q)
    assert 0.0 <= at < 1e-12
    assert beside > 1e-4
