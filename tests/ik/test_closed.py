"""Laws of the closed forms, on arms of six joints out of the wheel."""

from __future__ import annotations

from itertools import product

import numpy as np
import pinocchio as pin
import pytest

from benchmarks._wheel_arms import ARMS, Arm, load_arm
from mmplan.assets import example_robots
from mmplan.exceptions import InputError
from mmplan.ik.any_arm import auto, subproblems
from mmplan.ik.closed import Closed
from mmplan.shapes import Array
from tests.ik.laws import (
    ACCURACY,
    assert_batch_is_single,
    assert_masks,
    assert_no_duplicates,
    assert_reached,
    source_found,
    turn_apart,
)

pytestmark = pytest.mark.skipif(
    example_robots() is None, reason="example-robot-data is not installed"
)
CLOSED = [name for name, arm in ARMS.items() if len(arm.joints) == 6]
REASONS = {
    "ur5": "axes 2, 3 and 4 parallel, 5 and 6 meet",
    "kinova": "(axes 4, 5 and 6 meet), axes 2 and 3 parallel",
    "z1": "axes 2, 3 and 4 parallel, 5 and 6 meet",
    "talos_left_arm": "(axes 4, 5 and 6 meet), axes 1 and 2 meet",
    "centauro": "(axes 1, 2 and 3 meet), axes 5 and 6 meet",
}


def solver_of(arm: Arm) -> Closed:
    solver = auto(arm.model, arm.joints, arm.frame, {})
    assert isinstance(solver, Closed)
    return solver


@pytest.fixture(params=CLOSED, scope="module")
def arm(request: pytest.FixtureRequest) -> Arm:
    return load_arm(request.param)


@pytest.mark.parametrize("name", REASONS)
def test_the_form_is_chosen_by_the_axes_and_said(name: str) -> None:
    solver = solver_of(load_arm(name))
    assert REASONS[name] in solver.explanation
    assert solver.complete


def test_every_branch_reaches_and_the_source_is_among_them(arm: Arm) -> None:
    q = arm.draw(1000, seed=1)
    T = arm.tool_poses(q)
    solver = solver_of(arm)
    solutions = solver.solve(T)
    assert_reached(arm, T, solutions)
    assert_no_duplicates(solutions)
    assert_masks(solutions, solver.chain.lower, solver.chain.upper)
    assert source_found(solutions, q).mean() > 0.998
    assert solutions.within.any(axis=1).all()


def test_quarter_turns_are_singular_and_solved(arm: Arm) -> None:
    lower, upper = arm.limits
    grid = np.array(list(product((-np.pi / 2, 0.0, np.pi / 2), repeat=6)))
    q = np.clip(grid[:: 729 // 240], lower, upper)
    T = arm.tool_poses(q)
    solutions = solver_of(arm).solve(T)
    assert_reached(arm, T, solutions)
    assert_no_duplicates(solutions)
    assert solutions.exists.any(axis=1).all()


@pytest.mark.parametrize("tilt", [0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-5])
def test_near_a_quarter_turn_of_one_joint(arm: Arm, tilt: float) -> None:
    lower, upper = arm.limits
    q = arm.draw(180, seed=2)
    for start, (joint, turn) in enumerate(
        product(range(6), (-np.pi / 2, 0, np.pi / 2))
    ):
        q[start::18, joint] = turn + tilt
    q = q[((q >= lower) & (q <= upper)).all(axis=1)]
    T = arm.tool_poses(q)
    solutions = solver_of(arm).solve(T)
    assert_reached(arm, T, solutions)
    assert_no_duplicates(solutions)
    assert solutions.exists.any(axis=1).all()


def test_batch_answers_equal_single_ones(arm: Arm) -> None:
    assert_batch_is_single(solver_of(arm), arm.tool_poses(arm.draw(60, seed=3)))


def test_poses_out_of_reach_or_no_numbers_have_no_solution(arm: Arm) -> None:
    T = arm.tool_poses(arm.draw(3, seed=4))
    T[0, :3, 3] += 5.0
    T[1] = np.nan
    solutions = solver_of(arm).solve(T)
    assert solutions.exists.any(axis=1).tolist() == [False, False, True]
    none = solver_of(arm).solve(np.empty((0, 4, 4)))
    assert none.q.shape == (0, 1, 6)


def test_eaik_finds_the_same_branches(arm: Arm) -> None:
    hp = pytest.importorskip("eaik.IK_HP", reason="eaik is not installed")
    solver = solver_of(arm)
    chain = solver.chain
    points = np.vstack([np.zeros(3), chain.points, chain.T_home[:3, 3]])
    oracle = hp.HPRobot(chain.axes.copy(), np.diff(points, axis=0))
    assert oracle.hasKnownDecomposition()
    T = arm.tool_poses(arm.draw(300, seed=5))
    solutions = solver.solve(T)
    same = 0
    for pose, q, exists in zip(T, solutions.q, solutions.exists, strict=True):
        asked = pose.copy()
        asked[:3, :3] = pose[:3, :3] @ chain.T_home[:3, :3].T
        found = oracle.IK(asked)
        # Its flag of least-squares answers cannot be trusted: what reaches counts.
        theirs = np.array(found.Q).reshape(-1, 6)
        reached = arm.tool_poses(theirs) - pose
        theirs = theirs[np.abs(reached).max(axis=(1, 2), initial=0.0) < 1e-6]
        same += _same_set(q[exists], theirs)
    assert same >= 297


def _same_set(ours: Array, theirs: Array) -> bool:
    apart = turn_apart(ours[:, None], theirs[None, :])
    covered = (apart < 1e-4).any(axis=0).all() and (apart < 1e-4).any(axis=1).all()
    return bool(covered)


@pytest.mark.parametrize("name", ["ur5", "kinova", "centauro"])
@pytest.mark.parametrize("digits", [4, 6, 8])
def test_a_rounded_urdf_is_solved_as_it_is(name: str, digits: int) -> None:
    exact = load_arm(name)
    model = exact.model.copy()
    for joint in range(1, model.njoints):
        placement = model.jointPlacements[joint]
        rpy = np.round(pin.rpy.matrixToRpy(placement.rotation), digits)
        offset = np.round(placement.translation, digits)
        # Rounding alone leaves right angles of many digits as they were.
        rpy += 10.0**-digits * np.array([0.3, -0.2, 0.4])
        model.jointPlacements[joint] = pin.SE3(pin.rpy.rpyToMatrix(rpy), offset)
    arm = Arm(model, exact.joints, exact.frame)
    solver = solver_of(arm)
    assert ("polished" in solver.explanation) or digits == 8
    q = arm.draw(500, seed=6)
    T = arm.tool_poses(q)
    solutions = solver.solve(T)
    assert_reached(arm, T, solutions)
    assert_no_duplicates(solutions)
    assert source_found(solutions, q).mean() > 0.99
    assert solutions.within.any(axis=1).mean() > 0.99


def test_a_continuous_joint_has_no_limits_and_stays_near_0() -> None:
    arm = load_arm("kinova")
    solver = solver_of(arm)
    assert np.isinf(solver.chain.upper).tolist() == [i in (0, 3, 5) for i in range(6)]
    solutions = solver.solve(arm.tool_poses(arm.draw(100, seed=7)))
    turns = solutions.q[solutions.exists][:, [0, 3, 5]]
    assert np.abs(turns).max() <= np.pi + ACCURACY


def test_the_chain_is_pinocchios(arm: Arm) -> None:
    chain = solver_of(arm).chain
    q = arm.draw(20, seed=8)
    T = arm.tool_poses(q)
    found, J = chain.jacobian(q.T)
    np.testing.assert_allclose(found.p.T, T[:, :3, 3], atol=1e-10)
    np.testing.assert_allclose(found.R.transpose(2, 1, 0), T[:, :3, :3], atol=1e-10)
    step = 1e-6
    for joint in range(6):
        moved = q.copy()
        moved[:, joint] += step
        ahead = arm.tool_poses(moved)
        linear = (ahead[:, :3, 3] - T[:, :3, 3]) / step
        turned = ahead[:, :3, :3] @ T[:, :3, :3].transpose(0, 2, 1)
        angular = np.array([pin.log3(R) for R in turned]) / step
        np.testing.assert_allclose(J[:3, joint].T, linear, atol=1e-5)
        np.testing.assert_allclose(J[3:, joint].T, angular, atol=1e-5)


def test_an_arm_without_a_closed_form_is_refused() -> None:
    arm = load_arm("baxter")
    with pytest.raises(InputError, match="no closed form for the axes of left_s0"):
        subproblems(arm.model, arm.joints, arm.frame, {})


def test_joints_that_are_not_the_arms_are_refused() -> None:
    arm = load_arm("ur5")
    with pytest.raises(InputError, match=r"moved by the joints.*wrist_3_joint"):
        auto(arm.model, arm.joints[:5], arm.frame, {})
