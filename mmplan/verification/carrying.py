"""Whether objects stay in the hand and end where they ought to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from mmplan.collision import TOUCH_TOLERANCE
from mmplan.collision.separation import transform
from mmplan.problem import Problem
from mmplan.replay import Stage
from mmplan.shapes import Array
from mmplan.verification.bodies import Bodies
from mmplan.verification_report import Fault

# An object is where it ought to be within these, m and rad.
POSITION_TOLERANCE = 1e-4
ROTATION_TOLERANCE = 1e-3
# Values that say the same thing twice may differ by this (m or rad).
_SAME = 1e-9


def deviation(T: Array, T_wanted: Array) -> tuple[float, float]:
    """How far a pose is from another: distance (m) and angle (rad)."""
    distance = float(np.linalg.norm(T[:3, 3] - T_wanted[:3, 3]))
    R = T_wanted[:3, :3].T @ T[:3, :3]
    twice_sine = np.linalg.norm(
        [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    )
    return distance, float(np.arctan2(twice_sine, np.trace(R) - 1.0))


def carrying_faults(stages: Sequence[Stage], problem: Problem) -> Iterator[Fault]:
    """What is wrong with how objects are carried, segment by segment."""
    standing = {item.name: item.T_world_object for item in problem.objects}
    for stage in stages:
        first, last = (
            stage.object_poses(problem.robot.tool_pose(q))
            for q in (stage.segment.positions[0], stage.segment.positions[-1])
        )
        yield from _moved_faults(stage, first, standing)
        yield from _record_faults(stage, first)
        yield from _grip_faults(stage, problem)
        if stage.segment.name == "release":
            yield from _goal_faults(stage, last)
        standing = last


def grasp_faults(stage: Stage, bodies: Bodies) -> Iterator[Fault]:
    """Whether the hand holds the object that a segment begins to carry."""
    distances = _finger_distances(stage, bodies)
    touching = [d for d in distances.values() if d <= TOUCH_TOLERANCE]
    if len(touching) < min(2, len(distances)):
        found = ", ".join(f"{name} {d * 1e3:.2f} mm" for name, d in distances.items())
        yield Fault(
            "grasp",
            f"{stage.place}: the hand does not hold {stage.task.object}; fingers are "
            f"off by {found}, where {TOUCH_TOLERANCE * 1e3:g} mm is let pass",
        )


def _finger_distances(stage: Stage, bodies: Bodies) -> dict[str, float]:
    """The distance (m) of each finger to the object at the segment's start."""
    T = bodies.joint_poses(stage.segment.positions[:1])[0]
    poses = [
        transform(T[joint] @ placement)
        for joint, placement in zip(bodies.joints, bodies.placements, strict=True)
    ]
    held = [i for i, owner in enumerate(bodies.owners) if owner == stage.task.object]
    fingers = [i for i, kind in enumerate(bodies.kinds) if kind == "finger"]
    distances: dict[str, float] = {}
    for i in fingers:
        apart = [bodies.separation.distance(i, poses[i], j, poses[j]) for j in held]
        name = bodies.owners[i]
        distances[name] = min([*apart, distances.get(name, np.inf)])
    return distances


def _moved_faults(
    stage: Stage, now: dict[str, Array], before: dict[str, Array]
) -> Iterator[Fault]:
    """Objects that are elsewhere at a segment's start than where they were left."""
    for name, T_world_object in now.items():
        distance, angle = deviation(T_world_object, before[name])
        if distance > POSITION_TOLERANCE or angle > ROTATION_TOLERANCE:
            yield Fault(
                "slip",
                f"{stage.place}: {name} slips by {_amount(distance, angle)}",
            )


def _record_faults(stage: Stage, now: dict[str, Array]) -> Iterator[Fault]:
    """Poses that the plan records and that its motion does not give."""
    recorded = stage.segment.objects
    for name in sorted(recorded.keys() ^ now.keys()):
        what = "no pose is" if name in now else "a pose of an unknown object is"
        yield Fault("objects", f"{stage.place}: {what} recorded: {name}")
    for name in recorded.keys() & now.keys():
        distance, angle = deviation(recorded[name], now[name])
        if distance > POSITION_TOLERANCE or angle > ROTATION_TOLERANCE:
            amount = _amount(distance, angle)
            yield Fault("objects", f"{stage.place}: {name} is {amount} from its record")


def _grip_faults(stage: Stage, problem: Problem) -> Iterator[Fault]:
    """A hand that moves or differs from the grasp that the task states."""
    task, segment, robot = stage.task, stage.segment, problem.robot
    if task.object not in stage.attached:
        return
    fingers = segment.positions[:, robot.hand.indices]
    moving = np.any(segment.velocities[:, robot.hand.indices] != 0.0)
    if moving or np.ptp(fingers, axis=0).max() > _SAME:
        yield Fault(
            "fingers", f"{stage.place}: fingers move while they hold the object"
        )
    if not _same(fingers[0], task.hand_closed):
        yield Fault("claim", f"{stage.place}: fingers are not where the grasp says")
    T_object_tool = np.asarray(np.linalg.inv(stage.attached[task.object]), np.float64)
    if not _same(T_object_tool, task.T_object_tool):
        amount = _amount(*deviation(T_object_tool, task.T_object_tool))
        message = f"{task.object} slips by {amount} from the grasp's pose in the tool"
        yield Fault("slip", f"{stage.place}: {message}")
    base = segment.positions[:, robot.base.indices]
    if segment.name == "transfer":
        for end, q_base in ((task.start, base[0]), (task.goal, base[-1])):
            turns = _whole_turns(end.base, q_base) * robot.base.wraps
            if not _same(end.base + turns, q_base):
                message = f"the base stands at {q_base}, the plan says {end.base}"
                yield Fault("claim", f"{stage.place}: {message}")


def _goal_faults(stage: Stage, now: dict[str, Array]) -> Iterator[Fault]:
    distance, angle = deviation(now[stage.task.object], stage.T_world_goal)
    if distance > POSITION_TOLERANCE or angle > ROTATION_TOLERANCE:
        amount = _amount(distance, angle)
        yield Fault(
            "goal", f"{stage.place}: {stage.task.object} is {amount} off its goal"
        )


def _whole_turns(q: Array, q_near: Array) -> Array:
    """The whole turns to add to angles to come nearest to others; 0 if they differ."""
    if q.shape != q_near.shape:
        return np.zeros(len(q))
    turns: Array = 2.0 * np.pi * np.rint((q_near - q) / (2.0 * np.pi))
    return turns


def _same(a: Array, b: Array) -> bool:
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=0.0, atol=_SAME))


def _amount(distance: float, angle: float) -> str:
    return f"{distance * 1e3:.3g} mm and {round(np.degrees(angle), 3):g}°"
