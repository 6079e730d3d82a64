"""Laws of the solver by iteration, and of the settings of all solvers."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._wheel_arms import Arm, load_arm
from mmplan.assets import example_robots
from mmplan.exceptions import InputError
from mmplan.ik.any_arm import auto, numeric
from mmplan.ik.numeric import Numeric
from mmplan.ik.sampling import lattice
from mmplan.ik.settings import IkSettings, ik_settings
from tests.ik.laws import (
    assert_batch_is_single,
    assert_masks,
    assert_no_duplicates,
    assert_reached,
    turn_apart,
)

needs_wheel = pytest.mark.skipif(
    example_robots() is None, reason="example-robot-data is not installed"
)


def solver_of(arm: Arm, **settings: float) -> Numeric:
    solver = numeric(arm.model, arm.joints, arm.frame, settings)
    assert isinstance(solver, Numeric)
    return solver


@needs_wheel
@pytest.mark.parametrize("name", ["ur5", "z1", "baxter", "tiago_torso", "so101"])
def test_poses_are_solved_within_limits(name: str) -> None:
    arm = load_arm(name)
    T = arm.tool_poses(arm.draw(150, seed=1))
    solver = solver_of(arm)
    solutions = solver.solve(T)
    assert_reached(arm, T, solutions)
    assert_no_duplicates(solutions)
    assert_masks(solutions, solver.chain.lower, solver.chain.upper)
    assert solutions.within.any(axis=1).mean() > 0.97
    assert not solver.complete
    assert "cannot prove" in solver.explanation


@needs_wheel
@pytest.mark.parametrize("name", ["ur5", "kinova", "talos_left_arm"])
def test_its_solutions_are_branches_of_the_closed_form(name: str) -> None:
    arm = load_arm(name)
    T = arm.tool_poses(arm.draw(100, seed=2))
    found = solver_of(arm).solve(T)
    all_of_them = auto(arm.model, arm.joints, arm.frame, {}).solve(T)
    apart = turn_apart(found.q[:, :, None], all_of_them.q[:, None])
    apart = np.where(all_of_them.exists[:, None], apart, np.inf).min(axis=2)
    assert np.quantile(apart[found.exists], 0.99) < 1e-6
    assert found.exists.sum() > 0.7 * all_of_them.within.sum()


@needs_wheel
def test_an_arm_of_five_joints_reaches_its_poses_exactly_and_no_others() -> None:
    arm = load_arm("so101")
    T = arm.tool_poses(arm.draw(40, seed=3))
    T[::2, :3, 3] += (0.0, 0.0, 0.02)
    solutions = solver_of(arm).solve(T)
    assert_reached(arm, T, solutions)
    assert not solutions.exists[::2].any()
    assert solutions.exists[1::2].any(axis=1).all()


@needs_wheel
def test_batch_answers_equal_single_ones() -> None:
    arm = load_arm("z1")
    assert_batch_is_single(solver_of(arm), arm.tool_poses(arm.draw(20, seed=4)))


@needs_wheel
def test_poses_out_of_reach_or_no_numbers_have_no_solution() -> None:
    arm = load_arm("baxter")
    T = arm.tool_poses(arm.draw(3, seed=5))
    T[0, :3, 3] += 5.0
    T[1] = np.nan
    solutions = solver_of(arm).solve(T)
    assert solutions.exists.any(axis=1).tolist() == [False, False, True]
    assert solver_of(arm).solve(np.empty((0, 4, 4))).q.shape == (0, 1, 7)


def test_a_lattice_is_even() -> None:
    points = lattice(512, 3)
    octant = (points >= 0.5) @ np.array([1, 2, 4])
    # Chance alone would be off by 14 for one in eight.
    assert np.abs(np.bincount(octant, minlength=8) - 64).max() < 10


def test_settings_have_defaults_and_are_checked() -> None:
    assert ik_settings({}) == IkSettings()
    assert ik_settings({"samples": 64}).samples == 64
    with pytest.raises(InputError, match="unknown setting; did you mean 'samples'"):
        ik_settings({"sample": 64})
    with pytest.raises(InputError, match=r"0\.5 is not a whole number above 0"):
        ik_settings({"solutions": 0.5})
    with pytest.raises(InputError, match="cannot be more than table"):
        ik_settings({"seeds": 10, "table": 4})
