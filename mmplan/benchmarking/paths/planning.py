"""mmplan's own planners as contestants."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from mmplan.benchmarking.paths.arena import Arena
from mmplan.benchmarking.paths.records import Answer, Prepared
from mmplan.collision import compile_motions
from mmplan.planning import PathChecker, PathResult, plan_path
from mmplan.problem import PlannerSettings
from mmplan.shapes import Array

# Planning is bounded by time alone, as that of all others is.
_ANY_NUMBER = 10**9


@dataclass(frozen=True)
class OwnPlanner:
    """One of OMPL's planners as `plan_path` uses it."""

    settings: PlannerSettings

    def __call__(self, arena: Arena) -> Prepared:
        """Prepare the collision checks of an arena."""
        begin = time.process_time()
        compile_motions()
        PathChecker(arena.world, self.settings.resolution)
        still = np.zeros_like(arena.q_start)
        arena.world.steps_collide(arena.q_start, still, 1)
        arena.world.motion_collides(arena.q_start, still)
        arena.world.any_collision(arena.q_start[None])  # compiled by now
        seconds = time.process_time() - begin
        return Prepared(lambda seed: _answer(arena, self.settings, seed), seconds)


def own_planner(name: str, settings: PlannerSettings) -> OwnPlanner:
    """A planner of a name with the other settings."""
    return OwnPlanner(replace(settings, name=name, iterations=_ANY_NUMBER))


def _answer(arena: Arena, settings: PlannerSettings, seed: int) -> Answer:
    rng = np.random.default_rng(seed)
    begin = time.process_time()
    result = plan_path(
        arena.world, arena.q_start, arena.q_goal, arena.joints, settings, rng
    )
    seconds = time.process_time() - begin
    first = result.path if result.first is None else result.first
    return Answer(
        first=first,
        first_seconds=seconds - result.shortening,
        path=result.path,
        seconds=seconds,
        states=result.states,
        edges=result.edges,
        step=None if first is None else _step(arena, settings, first),
        message=_message(result),
    )


def _message(result: PathResult) -> str:
    return "" if result.found else result.message


def _step(arena: Arena, settings: PlannerSettings, path: Array) -> float:
    """The longest step (rad) between two checks of a path (n, nq)."""
    dq = np.diff(path, axis=0)
    steps = PathChecker(arena.world, settings.resolution).steps(dq)
    return float((np.linalg.norm(dq, axis=1) / steps).max())
