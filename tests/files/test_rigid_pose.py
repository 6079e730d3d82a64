"""Laws of plain poses, judged by Pinocchio."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
from hypothesis import given
from hypothesis import strategies as st

from mmplan.files.rigid_pose import RigidPose, about, along, from_quaternion, from_rpy

ANGLES = st.tuples(*[st.floats(-7.0, 7.0)] * 3)
QUARTERS = st.tuples(*[st.sampled_from([i * math.pi / 2 for i in range(-4, 5)])] * 3)
POINTS = st.tuples(*[st.floats(-5.0, 5.0)] * 3)
AXES = POINTS.filter(lambda axis: math.hypot(*axis) > 1e-3)


def placement(pose: RigidPose) -> pin.SE3:
    return pin.SE3(np.array(pose.R), np.array(pose.xyz))


@given(POINTS, ANGLES | QUARTERS)
def test_angles_are_those_of_pinocchio(xyz: tuple, rpy: tuple) -> None:
    expected = pin.SE3(pin.rpy.rpyToMatrix(*rpy), np.array(xyz))
    assert placement(from_rpy(xyz, rpy)).isApprox(expected, 1e-9)


@given(ANGLES | QUARTERS)
def test_angles_of_a_pose_give_the_pose_again(rpy: tuple) -> None:
    pose = from_rpy((0.0, 0.0, 0.0), rpy)
    again = from_rpy((0.0, 0.0, 0.0), pose.rpy)
    np.testing.assert_allclose(again.R, pose.R, atol=1e-9)


@given(POINTS, ANGLES, POINTS, ANGLES)
def test_products_are_those_of_pinocchio(
    xyz: tuple, rpy: tuple, other_xyz: tuple, other_rpy: tuple
) -> None:
    first, second = from_rpy(xyz, rpy), from_rpy(other_xyz, other_rpy)
    expected = placement(first) * placement(second)
    assert placement(first @ second).isApprox(expected, 1e-9)


@given(AXES, st.floats(-7.0, 7.0))
def test_turns_are_those_of_pinocchio(axis: tuple, angle: float) -> None:
    unit = np.array(axis) / math.hypot(*axis)
    np.testing.assert_allclose(about(axis, angle).R, pin.exp3(angle * unit), atol=1e-9)
    np.testing.assert_allclose(along(axis, angle).xyz, angle * unit, atol=1e-9)
    quaternion = pin.Quaternion(pin.exp3(angle * unit)).coeffs()
    pose = from_quaternion((1.0, 2.0, 3.0), tuple(quaternion))
    np.testing.assert_allclose(pose.R, pin.exp3(angle * unit), atol=1e-9)
    assert pose.xyz == (1.0, 2.0, 3.0)
