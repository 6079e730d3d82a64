"""Laws of the solver that holds spare joints at samples, on arms out of the wheel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks._wheel_arms import Arm, load_arm
from mmplan.assets import example_robots
from mmplan.ik.any_arm import auto
from mmplan.ik.redundant import Redundant
from mmplan.ik.settings import IkSettings
from tests.ik.laws import (
    assert_batch_is_single,
    assert_masks,
    assert_no_duplicates,
    assert_reached,
    source_found,
)

pytestmark = pytest.mark.skipif(
    example_robots() is None, reason="example-robot-data is not installed"
)
HELD = {
    "panda": "48 samples of panda_joint7:",
    "xarm7": "48 samples of joint7:",
    "pr2": "48 samples of r_shoulder_pan_joint:",
    "tiago": "48 samples of arm_1_joint:",
    "talos": "48 samples of arm_left_1_joint:",
    "tiago_torso": "144 samples of torso_lift_joint, arm_1_joint:",
}


def solver_of(arm: Arm, **settings: float) -> Redundant:
    solver = auto(arm.model, arm.joints, arm.frame, settings)
    assert isinstance(solver, Redundant)
    return solver


@pytest.fixture(params=HELD, scope="module")
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def arm(name: str) -> Arm:
    return load_arm(name)


def test_the_joints_held_are_said(name: str, arm: Arm) -> None:
    solver = solver_of(arm)
    assert HELD[name] in solver.explanation
    assert not solver.complete


def test_poses_are_solved_within_limits(arm: Arm) -> None:
    T = arm.tool_poses(arm.draw(600, seed=1))
    solver = solver_of(arm)
    solutions = solver.solve(T)
    assert_reached(arm, T, solutions)
    assert_no_duplicates(solutions)
    assert_masks(solutions, solver.chain.lower, solver.chain.upper)
    assert solutions.within.any(axis=1).mean() >= 0.99
    assert solutions.exists.sum(axis=1).max() <= IkSettings().solutions
    solved = solutions.within.any(axis=1)
    np.testing.assert_array_equal(solutions.within[solved], solutions.exists[solved])


def test_a_pose_beyond_the_limits_exists_but_not_within(arm: Arm) -> None:
    chain = solver_of(arm).chain
    narrow = replace(
        chain,
        lower=np.where(chain.prismatic, chain.lower, chain.ranges[0] * 0.05),
        upper=np.where(chain.prismatic, chain.upper, chain.ranges[1] * 0.05 + 0.01),
    )
    solver = replace(solver_of(arm), chain=narrow)
    solver = replace(solver, rescue=replace(solver.rescue, chain=narrow))
    T = arm.tool_poses(arm.draw(100, seed=8))
    solutions = solver.solve(T)
    assert_reached(arm, T, solutions)
    beyond = solutions.exists.any(axis=1) & ~solutions.within.any(axis=1)
    assert beyond.mean() > 0.6
    assert solutions.exists[beyond].sum(axis=1).max() == 1


def test_the_source_is_among_the_branches_if_it_is_at_a_sample(arm: Arm) -> None:
    solver = solver_of(arm, samples=12, lift_samples=2, solutions=1000)
    q = arm.draw(300, seed=2)
    k = len(arm.joints)
    held = [*range(solver.front), *range(solver.front + 6, k)]
    q[:, held] = solver.held[np.arange(len(q)) % len(solver.held)]
    solutions = solver.solve(arm.tool_poses(q))
    # What is polished drifts along the arm's own motion, near singularities most.
    assert source_found(solutions, q, near=1e-3).mean() > 0.98


def test_more_samples_give_more_solutions_and_few_are_kept(arm: Arm) -> None:
    T = arm.tool_poses(arm.draw(50, seed=3))
    few = solver_of(arm, samples=8, solutions=1000).solve(T).exists.sum(axis=1)
    many = solver_of(arm, samples=32, solutions=1000).solve(T).exists.sum(axis=1)
    assert many.mean() > 2 * few.mean()
    kept = solver_of(arm, samples=32, solutions=5).solve(T).exists.sum(axis=1)
    np.testing.assert_array_equal(kept, np.minimum(many, 5))


def test_batch_answers_equal_single_ones(arm: Arm) -> None:
    T = arm.tool_poses(arm.draw(12, seed=4))
    assert_batch_is_single(solver_of(arm), T)


def test_the_same_poses_give_the_same_solutions(arm: Arm) -> None:
    T = arm.tool_poses(arm.draw(100, seed=5))
    first, second = solver_of(arm).solve(T), solver_of(arm).solve(T)
    np.testing.assert_array_equal(first.q, second.q)


def test_poses_out_of_reach_or_no_numbers_have_no_solution(arm: Arm) -> None:
    T = arm.tool_poses(arm.draw(3, seed=6))
    T[0, :3, 3] += 5.0
    T[1] = np.nan
    solutions = solver_of(arm).solve(T)
    assert solutions.exists.any(axis=1).tolist() == [False, False, True]
    none = solver_of(arm).solve(np.empty((0, 4, 4)))
    assert none.q.shape == (0, 1, len(arm.joints))


def test_a_rescue_finds_what_lies_between_the_samples() -> None:
    arm = load_arm("tiago")
    solver = solver_of(arm, samples=3)
    T = arm.tool_poses(arm.draw(300, seed=7))
    solutions = solver.solve(T)
    assert_reached(arm, T, solutions)
    at_sample = np.isclose(solutions.q[..., :1], solver.held.ravel(), atol=1e-6)
    between = solutions.exists & ~at_sample.any(axis=-1)
    assert between.any(axis=1).mean() > 0.1
    assert solutions.within.any(axis=1).mean() > 0.95
