"""Forward kinematics and Jacobians against Pinocchio and finite differences."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.kinematics import (
    ForwardKinematics,
    FrameJacobians,
    joint_placements,
    motion_axis,
)
from mmplan.shapes import Array
from tests.honest import puma

SEEDS = st.integers(0, 10_000)
STEP = 1e-6  # of finite differences, rad or m


def crooked_arm() -> pin.Model:
    """Six joints of every kind, about and along axes that point anywhere."""
    model, rng = pin.Model(), np.random.default_rng(3)
    parent = 0
    for number, kind in enumerate(
        [
            pin.JointModelRX(),
            pin.JointModelPY(),
            pin.JointModelRevoluteUnaligned(_axis(rng)),
            pin.JointModelRZ(),
            pin.JointModelPrismaticUnaligned(_axis(rng)),
            pin.JointModelRY(),
        ]
    ):
        # The fourth joint starts a second branch.
        parent = model.addJoint(
            2 if number == 3 else parent,
            kind,
            pin.exp6(rng.uniform(-1, 1, 6)),
            f"j{number}",
        )
        offset = pin.exp6(rng.uniform(-1, 1, 6))
        model.addFrame(pin.Frame(f"f{number}", parent, offset, pin.FrameType.OP_FRAME))
    return model


def _axis(rng: np.random.Generator) -> Array:
    axis = rng.normal(size=3)
    return axis / np.linalg.norm(axis)


MODELS = {"puma": puma().model, "crooked": crooked_arm()}


def draw(model: pin.Model, n: int, seed: int) -> Array:
    return np.random.default_rng(seed).uniform(-4.0, 4.0, (n, model.nq))


@pytest.mark.parametrize("name", MODELS)
@given(seed=SEEDS)
def test_placements_are_those_of_pinocchio(name: str, seed: int) -> None:
    model = MODELS[name]
    q, data = draw(model, 5, seed), model.createData()
    T_world_joint = ForwardKinematics(model)(q)
    assert T_world_joint.shape == (5, model.njoints, 4, 4)
    for row, T in zip(q, T_world_joint, strict=True):
        pin.forwardKinematics(model, data, row)
        expected = [placement.homogeneous for placement in data.oMi]
        np.testing.assert_allclose(T, expected, atol=1e-12)


@given(SEEDS)
def test_a_batch_is_the_same_as_its_rows(seed: int) -> None:
    model = MODELS["puma"]
    q = draw(model, 4, seed)
    rows = [joint_placements(model, row[None])[0] for row in q]
    np.testing.assert_allclose(ForwardKinematics(model)(q), rows, atol=1e-14)


def test_no_configurations_have_no_placements() -> None:
    model = MODELS["puma"]
    assert joint_placements(model, np.empty((0, model.nq))).shape[:2] == (
        0,
        model.njoints,
    )


@given(SEEDS)
def test_jacobians_are_what_finite_differences_say(seed: int) -> None:
    """Columns are velocities of the frame's origin in the world's axes."""
    robot = puma()
    columns = robot.arm.indices
    q = draw(robot.model, 2, seed)
    jacobians = FrameJacobians(robot.model, robot.tool_frame, columns)
    J = jacobians(joint_placements(robot.model, q))
    assert J.shape == (2, 6, len(columns))
    for k, column in enumerate(columns):
        step = np.zeros(robot.model.nq)
        step[column] = STEP
        for row in range(len(q)):
            R = robot.tool_pose(q[row])[:3, :3]
            before = pin.SE3(robot.tool_pose(q[row] - step))
            after = pin.SE3(robot.tool_pose(q[row] + step))
            twist = pin.log6(before.actInv(after)).vector / (2 * STEP)
            in_world = np.concatenate([R @ twist[:3], R @ twist[3:]])
            np.testing.assert_allclose(J[row, :, k], in_world, atol=1e-7)


@given(SEEDS, st.sampled_from(sorted(MODELS)), st.data())
def test_jacobians_are_pinocchios(seed: int, name: str, data: st.DataObject) -> None:
    model = MODELS[name]
    frame = data.draw(st.integers(1, model.nframes - 1), "frame")
    some = st.lists(st.integers(0, model.nv - 1), min_size=1, unique=True)
    columns = np.array(data.draw(some, "columns"))
    q = draw(model, 3, seed)
    J = FrameJacobians(model, frame, columns)(joint_placements(model, q))
    axes, workspace = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED, model.createData()
    for found, row in zip(J, q, strict=True):
        expected = pin.computeFrameJacobian(model, workspace, row, frame, axes)
        np.testing.assert_allclose(found, expected[:, columns], atol=1e-12)


def test_the_axes_of_joints_are_twists() -> None:
    model = MODELS["puma"]
    sideways = motion_axis(model, model.getJointId("base_y"))
    np.testing.assert_array_equal(sideways, [0, 1, 0, 0, 0, 0])
    turning = motion_axis(model, model.getJointId("joint4"))
    np.testing.assert_array_equal(turning, [0, 0, 0, 0, 0, 1])


def test_a_joint_with_several_freedoms_is_refused_by_name() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelPlanar(), pin.SE3.Identity(), "carriage")
    with pytest.raises(ValueError, match="joint carriage has more than one freedom"):
        ForwardKinematics(model)
