"""Spoiled motions of a base: each is found, by kind, and honest ones are not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from mmplan.hermite import HermiteCurve
from mmplan.pipeline import solve
from mmplan.plan import Plan, Segment
from mmplan.problem import Problem
from mmplan.replay import replay
from mmplan.robot import Follower
from mmplan.scene_file import load_problem
from mmplan.shapes import Array
from mmplan.verification import examine
from mmplan.verification.base import SLIP_TOLERANCE, side_slip
from tests.honest import bottle_plan, bottle_problem
from tests.wheels import cup_scene, puma_on


@cache
def driven(base_type: str) -> tuple[Problem, Plan]:
    with TemporaryDirectory() as folder:
        robot = puma_on(base_type, Path(folder))
        lines = f"  model: {robot}\n  start: {{base: [-0.6, -0.6, 3.0], arm: tucked}}"
        problem = load_problem(cup_scene(lines, Path(folder)))
        return problem, solve(problem, seed=1)


def spoiled(plan: Plan, change: Callable[[Segment], Segment]) -> Plan:
    """The plan with its first segment changed."""
    (task,) = plan.tasks
    first, *rest = task.segments
    return replace(plan, tasks=(replace(task, segments=(change(first), *rest)),))


def kinds(plan: Plan, problem: Problem) -> set[str]:
    return {fault.kind for fault in examine(plan, problem).faults}


def add(index: int, bump: float) -> Callable[[Segment], Segment]:
    """Half a wave of that height added to a joint's motion, at rest at both ends."""

    def change(segment: Segment) -> Segment:
        phase = np.pi * segment.times / segment.times[-1]
        positions, velocities = segment.positions.copy(), segment.velocities.copy()
        rate = np.pi / segment.times[-1]
        positions[:, index] += bump * np.sin(phase) ** 2
        velocities[:, index] += bump * rate * np.sin(2.0 * phase)
        velocities[[0, -1]] = 0.0
        return replace(segment, positions=positions, velocities=velocities)

    return change


@pytest.mark.parametrize("base_type", ["diff_drive", "reeds_shepp"])
@pytest.mark.parametrize("joint", range(3))
def test_a_base_that_slips_is_found(base_type: str, joint: int) -> None:
    problem, plan = driven(base_type)
    index = int(problem.robot.base.indices[joint])
    faults = examine(spoiled(plan, add(index, 0.02)), problem).faults
    (slip,) = [f.message for f in faults if f.kind == "side_slip"]
    assert "transit: the base slips sideways at" in slip
    assert "m/s near t =" in slip


def test_a_base_that_moves_freely_may_slip() -> None:
    problem, plan = driven("planar")
    index = int(problem.robot.base.indices[1])
    assert "side_slip" not in kinds(spoiled(plan, add(index, 0.02)), problem)


def test_a_sample_between_two_that_are_right_is_found_too() -> None:
    """The velocities of one sample alone are turned aside: positions stay."""
    problem, plan = driven("diff_drive")
    x, y, heading = problem.robot.base.indices

    def change(segment: Segment) -> Segment:
        v = segment.velocities.copy()
        row = int(np.linalg.norm(v[:, [x, y]], axis=1).argmax())
        aside = segment.positions[row, heading] + np.pi / 2
        v[row, [x, y]] += 0.01 * np.array([np.cos(aside), np.sin(aside)])
        return replace(segment, velocities=v)

    assert "side_slip" in kinds(spoiled(plan, change), problem)


def test_a_car_that_turns_too_tightly_is_found() -> None:
    problem, plan = driven("reeds_shepp")
    larger = replace(problem.robot, turning_radius=0.6)
    faults = examine(plan, replace(problem, robot=larger)).faults
    assert {fault.kind for fault in faults} == {"tight_turn"}
    assert "tighter than its turning radius of 0.6 m" in faults[0].message


def test_a_plan_of_a_differential_drive_is_none_of_a_car() -> None:
    problem, plan = driven("diff_drive")
    car = replace(problem.robot, base_type="reeds_shepp", turning_radius=0.3)
    assert kinds(plan, replace(problem, robot=car)) == {"tight_turn"}


@pytest.mark.parametrize("base_type", ["planar", "diff_drive", "reeds_shepp"])
def test_the_bound_on_the_slip_is_one_and_not_far_off(base_type: str) -> None:
    problem, plan = driven(base_type)
    for stage in replay(problem, plan.tasks):
        bound = side_slip(stage, problem)
        slip = measured_slip(stage.segment, problem)
        assert slip <= bound + 1e-9
        assert bound <= 1.02 * slip + 0.5 * SLIP_TOLERANCE


def measured_slip(segment: Segment, problem: Problem) -> float:
    """By differences of positions at 10 kHz."""
    curve = HermiteCurve(segment.times, segment.positions, segment.velocities)
    t = np.arange(0.0, segment.times[-1], 1e-4)
    q: Array = curve.positions(t)[:, problem.robot.base.indices]
    way, heading = np.diff(q[:, :2], axis=0), (q[1:, 2] + q[:-1, 2]) / 2.0
    aside = way[:, 1] * np.cos(heading) - way[:, 0] * np.sin(heading)
    return float(np.abs(aside).max(initial=0.0)) / 1e-4


def test_a_finger_that_does_not_follow_is_found() -> None:
    problem, plan = bottle_problem(), bottle_plan()
    hand = problem.robot.hand
    left, right = (int(i) for i in hand.indices)

    def following(multiplier: float) -> Problem:
        mimic = (Follower(right, left, multiplier, 0.0),)
        robot = replace(problem.robot, hand=replace(hand, followers=mimic))
        return replace(problem, robot=robot)

    assert kinds(plan, following(1.0)) == set()
    faults = examine(plan, following(0.5)).faults
    assert {fault.kind for fault in faults} == {"mimic"}
    assert "finger_right does not follow finger_left" in faults[0].message


def test_a_claim_of_where_the_base_stands_counts_whole_turns_out() -> None:
    problem, plan = driven("planar")
    (task,) = plan.tasks

    def claimed(turn: float) -> Plan:
        start = replace(task.start, base=np.add(task.start.base, [0.0, 0.0, turn]))
        return replace(plan, tasks=(replace(task, start=start),))

    assert kinds(claimed(-4 * np.pi), problem) == set()
    assert kinds(claimed(0.1), problem) == {"claim"}
