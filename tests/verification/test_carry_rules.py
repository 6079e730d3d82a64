"""Rules of carrying: plans that keep them are proven, others are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mmplan.carry import Carry, Region, Upright
from mmplan.hermite import HermiteCurve
from mmplan.kinematics import joint_placements
from mmplan.plan import Plan, Segment
from mmplan.problem import Problem
from mmplan.replay import replay
from mmplan.shapes import Array
from mmplan.terminal import verification_table
from mmplan.verification import examine
from mmplan.verification.carry_rules import SHARPNESS, carrying_peaks
from mmplan.verification_report import Fault, Peak
from tests.honest import bottle_plan, bottle_problem, puma, shift

UP = np.array([0.0, 0.0, 1.0])
JOINT5, JOINT6 = 6, 7
CARRIED = ("lift", "transfer", "lower")


@pytest.fixture(scope="module")
def plan() -> Plan:
    return bottle_plan()


def carried(carry: Carry) -> Problem:
    problem = bottle_problem()
    return replace(problem, tasks=(replace(problem.tasks[0], carry=carry),))


def rocked(plan: Plan, joint: int, amount: float, name: str = "transfer") -> Plan:
    """The plan with a joint going there and back between two rests of a segment."""

    def rock(segment: Segment) -> Segment:
        if segment.name != name:
            return segment
        times = segment.times * 3.0  # slow enough for the joint
        phase = 2.0 * np.pi * times / times[-1]
        positions, velocities = segment.positions.copy(), segment.velocities / 3.0
        positions[:, joint] += amount * (1.0 - np.cos(phase)) / 2.0
        velocities[:, joint] += amount * np.sin(phase) * np.pi / times[-1]
        return replace(segment, times=times, positions=positions, velocities=velocities)

    task = plan.tasks[0]
    segments = tuple(rock(segment) for segment in task.segments)
    return replace(plan, tasks=(replace(task, segments=segments),))


def judged(plan: Plan, carry: Carry) -> tuple[dict[str, Peak], list[Fault]]:
    """The peaks and faults of the rules alone, nothing else being looked at."""
    problem = carried(carry)
    stages = list(replay(problem, plan.tasks))
    travel = np.max([np.abs(s.segment.positions).max(axis=0) for s in stages], axis=0)
    found, wrong = carrying_peaks(stages, problem, travel + 0.1)
    return {peak.rule: peak for peak in found}, wrong


def kinds(plan: Plan, carry: Carry) -> set[str]:
    return {fault.kind for fault in judged(plan, carry)[1]}


def sampled(plan: Plan, upright: Upright) -> tuple[Array, Array]:
    """Tilts of the bottle and speeds of the tool, finely, by kinematics alone."""
    robot, tilts, speeds = puma(), [], []
    for segment in plan.tasks[0].segments:
        if segment.name not in CARRIED:
            continue
        curve = HermiteCurve(segment.times, segment.positions, segment.velocities)
        t = np.linspace(0.0, segment.times[-1], 4000)
        T = joint_placements(robot.model, curve.positions(t))[:, robot.tool_joint]
        T = T @ robot.T_joint_tool
        held = T @ segment.attached["bottle"]
        tilts.append(upright.tilts(held[:, :3, :3]))
        way = np.linalg.norm(np.diff(T[:, :3, 3], axis=0), axis=1)
        speeds.append(way / np.diff(t))
    return np.concatenate(tilts), np.concatenate(speeds)


@pytest.mark.parametrize("amount", [0.05, 0.3, -0.4])
def test_the_largest_tilt_and_speed_are_found(plan: Plan, amount: float) -> None:
    upright = Upright(1.0, UP)
    rocking = rocked(plan, JOINT5, amount)
    found, wrong = judged(rocking, Carry(upright, max_speed=5.0))
    assert not wrong
    for peak, values in zip(
        (found["tilt"], found["tool_speed"]), sampled(rocking, upright), strict=True
    ):
        assert peak.proven is not None
        assert values.max() <= peak.proven + 1e-6
        assert peak.largest <= peak.proven <= peak.largest + SHARPNESS
        assert values.max() - 1e-3 <= peak.largest <= values.max() + 1e-3
        assert peak.segment in CARRIED


def test_a_bottle_that_is_tilted_too_far(plan: Plan) -> None:
    rocking = rocked(plan, JOINT5, 0.3)
    assert not kinds(rocking, Carry(Upright(0.31, UP)))
    report = examine(rocking, carried(Carry(Upright(0.29, UP))))
    assert {fault.kind for fault in report.faults} == {"tilt"}
    (fault,) = report.faults
    assert fault.message.startswith("task 1 (bottle), transfer: bottle tilts by 0.29")
    assert report.peaks[0].proven is None


def test_a_tilt_between_two_samples(plan: Plan) -> None:
    """Both samples are upright, the curve between them is not."""
    transfer = next(s for s in plan.tasks[0].segments if s.name == "transfer")
    velocities = transfer.velocities.copy()
    velocities[5, JOINT5], velocities[6, JOINT5] = 3.0, -3.0
    spoiled = replace(transfer, velocities=velocities)
    task = plan.tasks[0]
    segments = tuple(spoiled if s is transfer else s for s in task.segments)
    bad = replace(plan, tasks=(replace(task, segments=segments),))
    step = transfer.times[1]
    tilt = 3.0 * step / 4.0  # of the cubic that leaves at 3 rad/s and comes back
    kinds = {
        f.kind for f in examine(bad, carried(Carry(Upright(0.9 * tilt, UP)))).faults
    }
    assert "tilt" in kinds
    kinds = {
        f.kind for f in examine(bad, carried(Carry(Upright(1.1 * tilt, UP)))).faults
    }
    assert "tilt" not in kinds


def test_another_axis_may_be_the_one_that_points_up(plan: Plan) -> None:
    on_its_side = Carry(Upright(0.1, np.array([1.0, 0.0, 0.0])))
    assert kinds(plan, on_its_side) == {"tilt"}
    rolled = rocked(plan, JOINT6, 0.3)  # about the approach, across the bottle
    assert not kinds(rolled, Carry(Upright(0.31, UP)))
    assert kinds(rolled, Carry(Upright(0.29, UP))) == {"tilt"}


def test_where_the_rule_does_not_hold_the_bottle_may_tilt(plan: Plan) -> None:
    """It tilts most in the middle of its way of 0.4 m along y."""
    rocking = rocked(plan, JOINT5, 0.3)
    for length, ok in ((0.39, True), (0.1, False)):
        box = Region("exempt", (0.5, length, 1.0), shift(0.9, 0.2, 1.0))
        assert (not kinds(rocking, Carry(Upright(0.15, UP, (box,))))) == ok
    wide = Region("exempt", (9.0, 9.0, 9.0), np.eye(4))
    peak = judged(rocking, Carry(Upright(0.15, UP, (wide,))))[0]["tilt"]
    assert peak.largest == peak.proven == 0.0


def test_a_tool_that_is_too_fast(plan: Plan) -> None:
    fastest = sampled(plan, Upright(1.0, UP))[1].max()
    assert not kinds(plan, Carry(max_speed=fastest + 0.001))
    _, (fault, *_) = judged(plan, Carry(max_speed=fastest - 0.001))
    assert fault.kind == "tool_speed"
    assert "the tool moves at" in fault.message


def test_a_region_that_the_object_enters_and_the_robot_may(plan: Plan) -> None:
    at_bottle = Region("forbidden region 1", (0.02, 0.02, 0.02), shift(0.9, 0.2, 0.9))
    report = examine(plan, carried(Carry(forbidden=(at_bottle,))))
    assert {fault.kind for fault in report.faults} == {"region"}
    assert "forbidden region 1 and bottle overlap" in report.faults[0].message
    at_arm = Region("forbidden region 1", (0.1, 0.1, 0.1), shift(0.3, 0.2, 0.9))
    assert examine(plan, carried(Carry(forbidden=(at_arm,)))).ok


def test_people_are_told_the_largest_tilt(plan: Plan) -> None:
    report = examine(plan, carried(Carry(Upright(0.17, UP))))
    line = verification_table(plan, report).splitlines()[-1]
    assert line.startswith("largest tilt while bottle is carried: ")
    assert "at most 0.17 allowed" in line
    assert report.to_json()["peaks"][0]["rule"] == "tilt"
