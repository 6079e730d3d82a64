"""Whether a plan is one for this problem at all, and whole enough to be replayed."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from mmplan.plan import Plan, Segment, TaskPlan
from mmplan.problem import Problem
from mmplan.replay import place_of
from mmplan.shapes import Array
from mmplan.verification_report import Fault

# The segments of a task in their order, and those that may not be left out.
SEGMENTS = (
    "transit",
    "approach",
    "grasp",
    "lift",
    "transfer",
    "lower",
    "release",
    "retreat",
)
_NEEDED = ("grasp", "transfer", "release")
# Segments in which the tool carries the object of the task.
CARRYING = ("lift", "transfer", "lower")
# Rotations may deviate from orthogonality by this much.
_RIGID = 1e-9


def structure_faults(plan: Plan, problem: Problem) -> Iterator[Fault]:
    """What keeps the plan from being replayed in the world of the problem."""
    yield from _identity_faults(plan, problem)
    for index, task in enumerate(plan.tasks):
        names = [segment.name for segment in task.segments]
        yield from _order_faults(f"task {index + 1} ({task.object})", names)
        for segment in task.segments:
            place = place_of(index, task, segment)
            yield from _sample_faults(place, segment, len(plan.joints))
            yield from _attachment_faults(place, task, segment)


def _identity_faults(plan: Plan, problem: Problem) -> Iterator[Fault]:
    robot = problem.robot
    if plan.fingerprint != problem.fingerprint:
        yield Fault(
            "scene",
            f"the plan was made for another state of scene '{plan.scene}': "
            f"fingerprint {plan.fingerprint or '(none)'}, "
            f"that of '{problem.name}' is {problem.fingerprint or '(none)'}",
        )
    joints = tuple(robot.model.names)[1:]
    tool = robot.model.frames[robot.tool_frame].name
    for what, planned, actual in (
        ("the robot", plan.robot, robot.name),
        ("the joints", ", ".join(plan.joints), ", ".join(joints)),
        ("the tool frame", plan.tool, tool),
        (
            "the objects of the tasks",
            ", ".join(task.object for task in plan.tasks),
            ", ".join(task.object for task in problem.tasks),
        ),
    ):
        if planned != actual:
            message = f"{what} of the plan: {planned}; of the problem: {actual}"
            yield Fault("scene", message)


def _order_faults(place: str, names: list[str]) -> Iterator[Fault]:
    unknown = [name for name in names if name not in SEGMENTS]
    if unknown:
        known = ", ".join(SEGMENTS)
        yield Fault("order", f"{place}: no segment is called {unknown[0]!r}: {known}")
        return
    places = [SEGMENTS.index(name) for name in names]
    if any(a >= b for a, b in pairwise(places)):
        yield Fault("order", f"{place}: segments out of order: {', '.join(names)}")
    for name in _NEEDED:
        if name not in names:
            yield Fault("order", f"{place}: segment '{name}' is missing")


def _sample_faults(place: str, segment: Segment, joints: int) -> Iterator[Fault]:
    times = segment.times
    shape = (len(times) if times.ndim == 1 else 0, joints)
    arrays = {"positions": segment.positions, "velocities": segment.velocities}
    wrong = [name for name, array in arrays.items() if array.shape != shape]
    if shape[0] < 2 or wrong:
        what = f"{wrong[0]} of shape {arrays[wrong[0]].shape}" if wrong else "too few"
        yield Fault("samples", f"{place}: {what}, for times of shape {times.shape}")
        return
    for name, array in {"times": times, **arrays}.items():
        if not np.all(np.isfinite(array)):
            row = int(np.argwhere(~np.isfinite(array))[0][0])
            yield Fault("number", f"{place}: {name}[{row}] is not finite")
    if times[0] != 0.0 or not np.all(np.diff(times) > 0.0):
        yield Fault("time", f"{place}: times do not increase strictly from 0")


def _attachment_faults(place: str, task: TaskPlan, segment: Segment) -> Iterator[Fault]:
    expected = [task.object] if segment.name in CARRYING else []
    if list(segment.attached) != expected:
        found = ", ".join(segment.attached) or "nothing"
        message = f"{place}: carries {found} instead of {', '.join(expected) or found}"
        if not expected:
            message = f"{place}: carries {found}, where nothing is to be carried"
        yield Fault("attached", message)
    for name, T in segment.attached.items():
        if not is_pose(T):
            yield Fault("number", f"{place}: the pose of {name} in the tool is no pose")


def is_pose(T: Array) -> bool:
    """Whether an array is a rigid transform (4, 4)."""
    if T.shape != (4, 4) or not np.all(np.isfinite(T)):
        return False
    R = T[:3, :3]
    turned = np.allclose(R @ R.T, np.eye(3), rtol=0.0, atol=_RIGID)
    return bool(turned and np.linalg.det(R) > 0 and np.array_equal(T[3], [0, 0, 0, 1]))
