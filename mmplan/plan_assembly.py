"""From the motion of every task to a plan that stands for itself."""

from __future__ import annotations

import platform
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version

from mmplan.plan import Plan, Segment, TaskPlan
from mmplan.problem import Problem
from mmplan.replay import replay

# What a plan depends on besides the problem and the seed.
_LIBRARIES = ("mmplan", "numpy", "pin", "coal", "ompl", "toppra")


def assemble_plan(problem: Problem, tasks: Sequence[TaskPlan], seed: int) -> Plan:
    """The plan of these tasks, with the poses of all objects in every segment."""
    segments: dict[int, list[Segment]] = defaultdict(list)
    for stage in replay(problem, tasks):
        T_world_tool = problem.robot.tool_pose(stage.segment.positions[0])
        objects = stage.object_poses(T_world_tool)
        segments[stage.task_index].append(replace(stage.segment, objects=objects))
    robot = problem.robot
    return Plan(
        scene=problem.name,
        path=problem.path,
        fingerprint=problem.fingerprint,
        robot=robot.name,
        joints=tuple(robot.model.names)[1:],
        tool=robot.model.frames[robot.tool_frame].name,
        seed=seed,
        tasks=tuple(
            replace(task, segments=tuple(segments[index]))
            for index, task in enumerate(tasks)
        ),
        versions=_versions(),
    )


def _versions() -> dict[str, str]:
    libraries = {name: _version(name) for name in _LIBRARIES}
    return {"python": platform.python_version(), **libraries}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:  # mmplan in a checkout that is not installed
        return "unknown"
