"""Plans spoiled on purpose: each is refused, for the right reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mmplan.collision import TOUCH_TOLERANCE
from mmplan.exceptions import VerificationError
from mmplan.plan import Plan, Segment, TaskPlan
from mmplan.problem import Obstacle, Task
from mmplan.shapes import Array, Box
from mmplan.verification import examine, verify
from mmplan.verification_report import VerificationReport
from tests.honest import MOVED, bottle_plan, bottle_problem, puma, shift

BASE_X, JOINT2, FINGER = 0, 3, 8


@pytest.fixture(scope="module")
def plan() -> Plan:
    return bottle_plan()


def with_task(plan: Plan, **changes: object) -> Plan:
    return replace(plan, tasks=(replace(plan.tasks[0], **changes),))


def with_segment(plan: Plan, name: str, change: Callable[[Segment], Segment]) -> Plan:
    segments = [change(s) if s.name == name else s for s in plan.tasks[0].segments]
    return with_task(plan, segments=tuple(segments))


def segment_of(plan: Plan, name: str) -> Segment:
    return next(s for s in plan.tasks[0].segments if s.name == name)


def pushed(segment: Segment, row: int, joint: int, amount: float) -> Segment:
    positions = segment.positions.copy()
    positions[row, joint] += amount
    return replace(segment, positions=positions)


def scaled(segment: Segment, factor: float) -> Segment:
    return replace(
        segment,
        times=segment.times * factor,
        velocities=segment.velocities / factor,
    )


def kinds(report: VerificationReport) -> set[str]:
    return {fault.kind for fault in report.faults}


def faults(plan: Plan, *obstacles: Obstacle) -> VerificationReport:
    problem = bottle_problem(*obstacles)
    report = examine(plan, problem)
    assert not report.ok
    with pytest.raises(VerificationError) as error:
        verify(plan, problem)
    assert error.value.faults == tuple(fault.message for fault in report.faults)
    return report


def test_the_honest_plan_is_proven(plan: Plan) -> None:
    report = verify(plan, bottle_problem())
    assert report.ok
    assert report.clearance is not None
    assert 0.0 < report.proven <= report.clearance.distance
    assert report.queries > 0
    assert report == examine(plan, bottle_problem())


def test_a_waypoint_in_the_counter(plan: Plan) -> None:
    spoiled = with_segment(plan, "lift", lambda s: pushed(s, 6, BASE_X, 0.4))
    report = faults(spoiled)
    assert "collision" in kinds(report)
    first = report.faults[0]
    assert first.message.startswith("task 1 (bottle), lift: ")
    assert "counter" in first.message
    assert report.proven == 0.0
    assert report.clearance is not None
    assert report.clearance.distance < 0.0


def test_a_thin_obstacle_between_two_samples(plan: Plan) -> None:
    transfer = segment_of(plan, "transfer")
    y = transfer.positions[4:6, 1].mean() + 0.3
    sheet = Obstacle("sheet", Box((0.2, 0.002, 0.3)), shift(-0.1, y, 0.15))
    report = faults(plan, sheet)
    assert kinds(report) == {"collision"}
    assert {"base and sheet" in f.message for f in report.faults} == {True}


def test_an_object_that_slips_in_the_hand(plan: Plan) -> None:
    def slip(segment: Segment) -> Segment:
        T = segment.attached["bottle"] @ shift(0.0, 0.0, 0.003)
        return replace(segment, attached={"bottle": T})

    report = faults(with_segment(plan, "transfer", slip))
    assert "slip" in kinds(report)
    assert any("bottle slips by 3 mm" in f.message for f in report.faults)


def test_an_object_grasped_where_it_does_not_stand(plan: Plan) -> None:
    problem = bottle_problem()
    moved = replace(problem.objects[0], T_world_object=shift(0.9, 0.0, 0.8503))
    report = examine(plan, replace(problem, objects=(moved,)))
    assert "slip" in kinds(report)


def test_a_joint_limit_passed_between_samples(plan: Plan) -> None:
    """Both samples are within the limit, the curve between them is not."""
    upper = puma().arm.upper[1]
    transit = segment_of(plan, "transit")
    q, v = transit.positions[[0, 0]].copy(), np.zeros((2, 10))
    q[:, JOINT2] = upper - 0.001
    v[:, JOINT2] = 0.1, -0.1
    times = np.array([0.0, 1.0])
    swing = Segment("transit", times, q, v, {}, transit.objects)
    report = faults(with_segment(plan, "transit", lambda _: swing))
    (fault,) = (f for f in report.faults if f.kind == "position")
    assert "joint2 reaches" in fault.message


def test_the_base_outside_its_bounds(plan: Plan) -> None:
    bounds = np.array([[-0.6, 3.0], [-3.0, 3.0]])
    report = examine(plan, replace(bottle_problem(), base_bounds=bounds))
    assert kinds(report) == {"base"}
    assert "base_x reaches -0.65" in report.faults[0].message


@pytest.mark.parametrize("name", ["transit", "lift", "transfer", "grasp"])
def test_time_stamps_squeezed(plan: Plan, name: str) -> None:
    report = faults(with_segment(plan, name, lambda s: scaled(s, 0.5)))
    assert kinds(report) & {"velocity", "acceleration"}
    assert kinds(report) <= {"velocity", "acceleration"}


def test_time_stamps_stretched_are_fine(plan: Plan) -> None:
    slow = with_segment(plan, "transfer", lambda s: scaled(s, 3.0))
    assert examine(slow, bottle_problem()).ok


def test_velocities_that_do_not_fit_the_samples(plan: Plan) -> None:
    """The samples are slow, the curve that the velocities make is not."""

    def shake(segment: Segment) -> Segment:
        velocities = segment.velocities.copy()
        velocities[5, JOINT2] += 1.0
        return replace(segment, velocities=velocities)

    assert "acceleration" in kinds(faults(with_segment(plan, "transfer", shake)))


@pytest.mark.parametrize("key", ["times", "positions", "velocities"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_numbers_that_are_none(plan: Plan, key: str, value: float) -> None:
    def spoil(segment: Segment) -> Segment:
        array = getattr(segment, key).copy()
        array.ravel()[-1] = value
        return replace(segment, **{key: array})

    report = faults(with_segment(plan, "lower", spoil))
    assert "number" in kinds(report)
    assert f"lower: {key}[11] is not finite" in report.faults[0].message


def test_samples_that_do_not_match(plan: Plan) -> None:
    def drop(segment: Segment) -> Segment:
        return replace(segment, velocities=segment.velocities[:, :9])

    assert kinds(faults(with_segment(plan, "lower", drop))) == {"samples"}


def test_time_that_goes_back(plan: Plan) -> None:
    def swap(segment: Segment) -> Segment:
        times = segment.times.copy()
        times[[3, 4]] = times[[4, 3]]
        return replace(segment, times=times)

    assert kinds(faults(with_segment(plan, "transit", swap))) == {"time"}


def test_a_jump_between_segments(plan: Plan) -> None:
    report = faults(with_segment(plan, "transfer", lambda s: shifted(s, 1e-6)))
    assert "jump" in kinds(report)
    assert any("after task 1 (bottle), lift" in f.message for f in report.faults)


def shifted(segment: Segment, amount: float) -> Segment:
    return replace(segment, positions=segment.positions + amount * np.eye(10)[JOINT2])


def test_a_start_elsewhere(plan: Plan) -> None:
    problem = bottle_problem()
    q_start = problem.q_start + 0.001
    assert kinds(examine(plan, replace(problem, q_start=q_start))) == {"start"}


def test_a_segment_that_does_not_end_at_rest(plan: Plan) -> None:
    def roll(segment: Segment) -> Segment:
        velocities = segment.velocities.copy()
        velocities[-1, BASE_X] = 0.01
        return replace(segment, velocities=velocities)

    report = faults(with_segment(plan, "transit", roll))
    assert "rest" in kinds(report)


def test_a_goal_missed(plan: Plan) -> None:
    problem = bottle_problem()
    goal = Task("bottle", shift(0.9, MOVED + 0.0005, 0.85))
    report = examine(plan, replace(problem, tasks=(goal,)))
    assert kinds(report) == {"goal"}
    assert "bottle is 0.5 mm and 0° off its goal" in report.faults[0].message


def test_fingers_that_move_while_they_hold(plan: Plan) -> None:
    spoiled = with_segment(plan, "transfer", lambda s: pushed(s, 6, FINGER, 0.005))
    assert "fingers" in kinds(faults(spoiled))


def test_a_hand_that_does_not_hold(plan: Plan) -> None:
    """Both fingers stay 5 mm off the object all the time."""
    robot = puma()

    def open_hand(segment: Segment) -> Segment:
        positions = segment.positions.copy()
        fingers = robot.hand.indices
        closed = plan.tasks[0].hand_closed
        open_ = plan.tasks[0].hand_open
        share = (positions[:, fingers] - closed) / (open_ - closed)
        positions[:, fingers] = closed + 0.005 + share * (open_ - closed - 0.005)
        velocities = segment.velocities.copy()
        velocities[:, fingers] *= 1.0 - 0.005 / (open_ - closed)
        return replace(segment, positions=positions, velocities=velocities)

    task = plan.tasks[0]
    spoiled = with_task(
        plan,
        segments=tuple(open_hand(s) for s in task.segments),
        hand_closed=task.hand_closed + 0.005,
    )
    report = faults(spoiled)
    assert kinds(report) == {"grasp"}
    assert "finger_left 5.00 mm, finger_right 5.00 mm" in report.faults[0].message


def test_fingers_that_sink_into_the_object(plan: Plan) -> None:
    depth = 2 * TOUCH_TOLERANCE

    def squeeze(segment: Segment) -> Segment:
        positions = segment.positions.copy()
        positions[:, puma().hand.indices] -= depth
        return replace(segment, positions=positions)

    task = plan.tasks[0]
    names = ("grasp", "lift", "transfer", "lower", "release")
    segments = [squeeze(s) if s.name in names else s for s in task.segments]
    spoiled = with_task(
        plan, segments=tuple(segments), hand_closed=task.hand_closed - depth
    )
    report = faults(spoiled)
    touches = [f for f in report.faults if f.kind == "touch"]
    assert len(touches) == 2 * len(names)
    assert "overlap by 2 mm or more" in touches[0].message
    assert "1 mm is let pass" in touches[0].message


def test_a_scene_that_has_changed(plan: Plan) -> None:
    problem = replace(bottle_problem(), fingerprint="4567")
    report = examine(plan, problem)
    assert kinds(report) == {"scene"}
    assert "0123" in report.faults[0].message
    assert "4567" in report.faults[0].message


@pytest.mark.parametrize(
    "change",
    [
        {"robot": "tiago"},
        {"joints": ("base_y", "base_x")},
        {"tool": "hand"},
        {"tasks": ()},
    ],
)
def test_a_plan_for_something_else(plan: Plan, change: dict[str, object]) -> None:
    report = examine(replace(plan, **change), bottle_problem())
    assert "scene" in kinds(report)


def test_segments_missing_doubled_and_out_of_order(plan: Plan) -> None:
    s = plan.tasks[0].segments
    for segments in (s[:2] + s[3:], (*s, s[0]), (s[1], s[0], *s[2:]), s[:-2] + s[-1:]):
        report = examine(with_task(plan, segments=segments), bottle_problem())
        assert kinds(report) == {"order"}
    renamed = (replace(s[0], name="dance"), *s[1:])
    report = examine(with_task(plan, segments=renamed), bottle_problem())
    assert "no segment is called 'dance'" in report.faults[0].message


def test_an_object_carried_where_it_must_stand(plan: Plan) -> None:
    held = segment_of(plan, "lift").attached

    def carry(segment: Segment) -> Segment:
        return replace(segment, attached=held)

    assert kinds(faults(with_segment(plan, "grasp", carry))) == {"attached"}
    empty = with_segment(plan, "transfer", lambda s: replace(s, attached={}))
    assert kinds(faults(empty)) == {"attached"}


def dragged(plan: Plan) -> Plan:
    """The plan without lifting: the bottle slides along the counter."""
    kept = ("transit", "approach", "grasp", "transfer", "release", "retreat")
    lift, transfer = segment_of(plan, "lift"), segment_of(plan, "transfer")
    arm = puma().arm.indices
    positions = transfer.positions.copy()
    positions[:, arm] = lift.positions[0, arm]
    low = replace(transfer, positions=positions, objects=lift.objects)
    segments = [low if s.name == "transfer" else s for s in plan.tasks[0].segments]
    return with_task(plan, segments=tuple(s for s in segments if s.name in kept))


def test_an_object_dragged_along_its_support(plan: Plan) -> None:
    report = faults(dragged(plan))
    assert kinds(report) <= {"collision", "unproven"}
    assert {
        "bottle" in f.message and "counter" in f.message for f in report.faults
    } == {True}


def test_objects_recorded_elsewhere(plan: Plan) -> None:
    def misplace(segment: Segment) -> Segment:
        return replace(segment, objects={"bottle": shift(0.0, 0.0, 0.0)})

    assert kinds(faults(with_segment(plan, "transit", misplace))) == {"objects"}
    unknown = with_segment(
        plan, "transit", lambda s: replace(s, objects={**s.objects, "cup": np.eye(4)})
    )
    assert kinds(faults(unknown)) == {"objects"}


@pytest.mark.parametrize(
    "change",
    [
        lambda t: {"start": replace(t.start, base=t.start.base + 0.1)},
        lambda t: {"goal": replace(t.goal, base=t.goal.base[:1])},
        lambda t: {"hand_closed": t.hand_closed + 0.001},
    ],
)
def test_claims_that_the_motion_does_not_bear_out(
    plan: Plan, change: Callable[[TaskPlan], dict[str, Array]]
) -> None:
    assert kinds(faults(with_task(plan, **change(plan.tasks[0])))) == {"claim"}
