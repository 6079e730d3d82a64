"""Bases of every type, from the scene to the proof of the plan that is delivered."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from mmplan.hermite import HermiteCurve
from mmplan.pipeline import solve
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.shapes import Array
from mmplan.terminal import plan_tables, show
from mmplan.verification import verify
from tests.wheels import TURNING_RADIUS, cup_scene, puma_on

TURNING = ("planar", "diff_drive", "reeds_shepp")
ROLLING = ("diff_drive", "reeds_shepp")
START = "start: {base: [-0.6, -0.6, 3.0], arm: tucked}"
LINES = {
    **dict.fromkeys(TURNING, f"  model: {{robot}}\n  {START}"),
    "fixed": "  model: {robot}\n  at: {xyz: [0.75, 0.1, 0], rpy: [0, 0, 0.5]}\n"
    "  start: {arm: tucked}",
    "held": "  model: puma_mobile\n  base: fixed\n"
    "  start: {base: [0.75, 0.1], arm: tucked}",
    "held planar": "  model: {robot}\n  base: fixed\n"
    "  start: {base: [0.75, 0.1, 0.5], arm: tucked}",
}


@cache
def solved(kind: str) -> tuple[Problem, Plan]:
    with TemporaryDirectory() as name:
        folder = Path(name)
        base = kind.split()[-1]
        robot = puma_on(base, folder) if base != "held" else ""
        scene = cup_scene(LINES[kind].replace("{robot}", str(robot)), folder)
        problem = load_problem(scene)
        return problem, solve(problem, seed=1)


def curves(kind: str) -> list[HermiteCurve]:
    _, plan = solved(kind)
    segments = [s for task in plan.tasks for s in task.segments]
    return [HermiteCurve(s.times, s.positions, s.velocities) for s in segments]


def sampled(kind: str) -> tuple[Array, Array]:
    """Positions and velocities of the base all along a plan, at 2 kHz."""
    problem, _ = solved(kind)
    base = problem.robot.base.indices
    times = [np.arange(0.0, c.times[-1], 5e-4) for c in curves(kind)]
    pairs = list(zip(curves(kind), times, strict=True))
    q = np.concatenate([c.positions(t)[:, base] for c, t in pairs])
    v = np.concatenate([c.velocities(t)[:, base] for c, t in pairs])
    return q, v


@pytest.mark.parametrize("kind", LINES)
def test_a_scene_is_solved_and_proven(kind: str) -> None:
    problem, plan = solved(kind)
    assert verify(plan, problem).ok
    assert problem.base_stands == (kind not in TURNING)


@pytest.mark.parametrize("kind", TURNING)
def test_a_base_that_turns_stands_as_the_search_chose(kind: str) -> None:
    problem, plan = solved(kind)
    base = problem.robot.base.indices
    (task,) = plan.tasks
    transfer = next(s for s in task.segments if s.name == "transfer")
    for end, row in ((task.start, 0), (task.goal, -1)):
        off = transfer.positions[row, base] - end.base
        np.testing.assert_allclose(off[:2], 0.0, atol=1e-9)
        np.testing.assert_allclose(np.sin(off[2] / 2.0), 0.0, atol=1e-9)
    assert np.ptp(sampled(kind)[0][:, 2]) > 0.1, "it turns on its way"


@pytest.mark.parametrize("kind", TURNING)
def test_the_motion_is_continuous_beyond_half_a_turn(kind: str) -> None:
    _, plan = solved(kind)
    q = np.concatenate([s.positions for s in plan.tasks[0].segments])
    assert np.abs(np.diff(q[:, 2])).max() < 0.5


@pytest.mark.parametrize("kind", ROLLING)
def test_a_base_that_rolls_does_not_slip_sideways(kind: str) -> None:
    q, v = sampled(kind)
    heading = q[:, 2]
    slip = v[:, 1] * np.cos(heading) - v[:, 0] * np.sin(heading)
    assert np.abs(slip).max() < 1e-4
    assert np.linalg.norm(v[:, :2], axis=1).max() > 0.2, "it does drive"


def test_a_base_that_moves_freely_does_slip() -> None:
    """So that the measure of the test above means something."""
    q, v = sampled("planar")
    slip = v[:, 1] * np.cos(q[:, 2]) - v[:, 0] * np.sin(q[:, 2])
    assert np.abs(slip).max() > 0.05


def test_a_car_turns_no_tighter_than_it_can() -> None:
    _, v = sampled("reeds_shepp")
    speed, turning = np.linalg.norm(v[:, :2], axis=1), np.abs(v[:, 2])
    assert np.all(TURNING_RADIUS * turning <= speed + 1e-4)
    assert turning.max() > 0.1


def test_a_differential_drive_turns_in_place_or_goes_straight() -> None:
    _, v = sampled("diff_drive")
    speed, turning = np.linalg.norm(v[:, :2], axis=1), np.abs(v[:, 2])
    assert np.minimum(speed, turning).max() < 1e-9


@pytest.mark.parametrize("kind", ROLLING)
def test_the_arm_is_held_while_the_base_rolls(kind: str) -> None:
    problem, _ = solved(kind)
    arm, base = problem.robot.arm.indices, problem.robot.base.indices
    for curve in curves(kind):
        v = np.abs(curve.velocities(np.arange(0.0, curve.times[-1], 1e-3)))
        both = np.minimum(v[:, base].max(axis=1), v[:, arm].max(axis=1))
        assert both.max() < 1e-9


@pytest.mark.parametrize("kind", ["fixed", "held", "held planar"])
def test_a_base_that_stands_has_no_joints_in_the_plan(kind: str) -> None:
    problem, plan = solved(kind)
    assert not set(plan.joints) & {"base_x", "base_y", "base_yaw"}
    assert problem.robot.base_type == "fixed"
    (task,) = plan.tasks
    assert task.start.base.shape == task.goal.base.shape == (0,)


def test_the_same_seed_gives_the_same_drive() -> None:
    problem, plan = solved("reeds_shepp")
    again = solve(problem, seed=1)
    for one, other in zip(plan.tasks[0].segments, again.tasks[0].segments, strict=True):
        assert np.array_equal(one.positions, other.positions)


@pytest.mark.parametrize(
    ("kind", "column"), [("planar", "base x, y, heading  grasp"), ("fixed", "  grasp")]
)
def test_a_plan_is_shown_with_the_joints_that_its_base_has(
    kind: str, column: str, capsys: pytest.CaptureFixture[str]
) -> None:
    show(*plan_tables(solved(kind)[1], None))
    header = capsys.readouterr().out.splitlines()[1]
    assert column in header
    assert ("base" in header) == (kind == "planar")
