"""A motion as a film: where everything that moves is at many moments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mmplan.hermite import HermiteCurve
from mmplan.kinematics import ForwardKinematics
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.replay import Stage, replay
from mmplan.shapes import Array
from mmplan.visualization.part import object_carrier
from mmplan.visualization.robot_parts import joint_poses


class Mark(NamedTuple):
    """One segment on the film's time line."""

    name: str
    object: str
    start: float  # s
    end: float  # s


@dataclass(frozen=True, eq=False)
class Film:
    """The poses T_world_carrier (n, 4, 4) of all that moves, at n moments."""

    times: Array  # (n,), s, rising
    q: Array  # (n, nq)
    poses: dict[str, Array]  # carrier -> (n, 4, 4)
    marks: tuple[Mark, ...]
    tool_path: Array  # (n, 3), m
    base_path: Array  # (n, 3), m

    @property
    def duration(self) -> float:
        """The time of the last moment, s."""
        return float(self.times[-1])

    def frame_at(self, time: float) -> int:
        """The moment nearest to a time (s)."""
        return int(np.argmin(np.abs(self.times - time)))

    def mark_at(self, time: float) -> Mark | None:
        """The segment that a time (s) falls into; the later one on a border."""
        started = [m for m in self.marks if m.start <= time + 1e-9]
        return started[-1] if started else None


def film_of_plan(problem: Problem, plan: Plan, rate: float) -> Film:
    """The film of a plan with about `rate` moments a second, all equally far apart."""
    moments = max(2, round(plan.duration * rate) + 1)
    return film_at(problem, plan, np.linspace(0.0, plan.duration, moments))


def film_at(problem: Problem, plan: Plan, times: Array) -> Film:
    """The film of a plan at rising times (n,), s."""
    stages = list(replay(problem, plan.tasks))
    marks = _marks(stages)
    starts = np.array([mark.start for mark in marks])
    which = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, None)
    q = np.empty((len(times), problem.robot.model.nq))
    for number, stage in enumerate(stages):
        rows = np.flatnonzero(which == number)
        s = stage.segment
        curve = HermiteCurve(s.times, s.positions, s.velocities)
        local = np.clip(times[rows] - starts[number], 0.0, s.duration)
        q[rows] = curve.positions(local)
    return _film(problem, times, q, [stages[i] for i in which], marks)


def film_of_scene(problem: Problem) -> Film:
    """The film of a scene: one moment, the robot at its start."""
    q = problem.q_start[None]
    poses, tool = _robot_poses(problem, q)
    for item in problem.objects:
        poses[object_carrier(item.name)] = item.T_world_object[None]
    base = _base_positions(problem, q)
    return Film(np.zeros(1), q, poses, (), tool[:, :3, 3], base)


def _film(
    problem: Problem,
    times: Array,
    q: Array,
    stages: Sequence[Stage],
    marks: tuple[Mark, ...],
) -> Film:
    """The film of configurations (n, nq), each with its stage of the plan."""
    poses, tool = _robot_poses(problem, q)
    objects = [stage.object_poses(T) for stage, T in zip(stages, tool, strict=True)]
    for item in problem.objects:
        carried = np.array([placed[item.name] for placed in objects])
        poses[object_carrier(item.name)] = carried
    base = _base_positions(problem, q)
    return Film(times, q, poses, marks, tool[:, :3, 3], base)


def _robot_poses(problem: Problem, q: Array) -> tuple[dict[str, Array], Array]:
    """The poses of the robot's joints and T_world_tool (n, 4, 4)."""
    robot = problem.robot
    T_world_joint = ForwardKinematics(robot.model)(q)
    tool = T_world_joint[:, robot.tool_joint] @ robot.T_joint_tool
    return joint_poses(robot, T_world_joint), tool


def _base_positions(problem: Problem, q: Array) -> Array:
    robot = problem.robot
    positions: Array = robot.base_poses(q[:, robot.base.indices])[:, :3, 3]
    return positions


def _marks(stages: Sequence[Stage]) -> tuple[Mark, ...]:
    ends = np.cumsum([stage.segment.duration for stage in stages]).tolist()
    return tuple(
        Mark(stage.segment.name, stage.task.object, start, end)
        for stage, start, end in zip(stages, [0.0, *ends[:-1]], ends, strict=True)
    )
