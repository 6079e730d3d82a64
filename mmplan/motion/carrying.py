"""Worlds in which the object in the hand stays upright, where its task wants that."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from mmplan.planning import PlanningWorld, UprightRule, UprightWorld
from mmplan.problem import Problem, Task
from mmplan.shapes import Array

W = TypeVar("W", bound=PlanningWorld)


def kept_upright(
    world: W,
    problem: Problem,
    task: Task,
    attached: Mapping[str, Array],
    *ends: Array,
) -> W | UprightWorld:
    """The world in which the object `attached` to the tool must not tilt too far.

    `ends` (nq,) are configurations of the motion wanted that keep the rule. The world
    as it is where there is no such rule, or nothing is in the hand.
    """
    upright = task.carry.upright
    if upright is None or task.object not in attached:
        return world
    rule = UprightRule(
        problem.robot,
        task.object,
        upright,
        attached[task.object],
        problem.planner.resolution,
        ends,
    )
    return UprightWorld(world, rule)
