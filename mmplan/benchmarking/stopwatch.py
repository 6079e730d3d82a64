"""Where a run's time goes, measured around the public parts of the score."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from mmplan.benchmarking.records import COLLISION, DISTANCE, IK, SCORING
from mmplan.collision import CollisionWorld, Scenery
from mmplan.ik import InverseKinematics, Solutions
from mmplan.pipeline import grasp_family
from mmplan.problem import Problem
from mmplan.scoring import End, ScoreFunction, Scores
from mmplan.scoring.term import Grasped
from mmplan.shapes import Array


class Stopwatch:
    """Adds up CPU and wall time by stage; a stage within another interrupts it."""

    def __init__(self) -> None:
        """Start with no stage."""
        self._running: list[str] = []
        self._spent: dict[str, tuple[float, float]] = {}
        self._last = _now()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time that passes in the block is the stage's."""
        self._charge()
        self._running.append(name)
        try:
            yield
        finally:
            self._charge()
            self._running.pop()

    @property
    def times(self) -> dict[str, dict[str, float]]:
        """CPU and wall time (s) of every stage so far."""
        return {k: {"cpu": c, "wall": w} for k, (c, w) in self._spent.items()}

    def _charge(self) -> None:
        now = _now()
        if self._running:
            name = self._running[-1]
            cpu, wall = self._spent.get(name, (0.0, 0.0))
            cpu, wall = cpu + now[0] - self._last[0], wall + now[1] - self._last[1]
            self._spent[name] = (cpu, wall)
        self._last = now


def _now() -> tuple[float, float]:
    return time.process_time(), time.perf_counter()


class TimedScore(ScoreFunction):
    """The score of a problem's first task with its stages timed; the same numbers.

    What is timed are the solver of inverse kinematics, the collision worlds, the
    distances of the clutter and each call as a whole; the problem is left as it is.
    """

    def __init__(self, problem: Problem, watch: Stopwatch) -> None:
        """Prepare for a problem."""
        task = problem.tasks[0]
        _, family = grasp_family(problem.object(task.object))
        solver = _TimedInverseKinematics(problem.robot.ik, watch)
        robot = replace(problem.robot, ik=solver)
        world = _TimedWorld(
            robot=robot,
            scenery=Scenery.of_problem(problem),
            standing={o.name: o.T_world_object for o in problem.objects},
            watch=watch,
        )
        super().__init__(replace(problem, robot=robot), task, world, family)
        self._watch = watch
        self._distances = self.clutter.distances
        self.clutter.distances = self._timed_distances  # type: ignore[method-assign]
        self._bound = self.clutter.bound
        self.clutter.bound = self._timed_bound  # type: ignore[method-assign]

    def __call__(self, end: End, q_base: Array, grasps: Array) -> Scores:
        """Score bases (n, b) with grasp genes (n, g), row by row, at one end."""
        with self._watch.stage(SCORING):
            return super().__call__(end, q_base, grasps)

    def _timed_distances(self, grasped: Grasped) -> Array:
        with self._watch.stage(DISTANCE):
            return self._distances(grasped)

    def _timed_bound(self, grasped: Grasped, T_world_joint: Array) -> Array:
        with self._watch.stage(DISTANCE):
            return self._bound(grasped, T_world_joint)


@dataclass(frozen=True, eq=False)
class _TimedInverseKinematics:
    solver: InverseKinematics
    watch: Stopwatch

    @property
    def complete(self) -> bool:
        return self.solver.complete

    @property
    def explanation(self) -> str:
        return self.solver.explanation

    def solve(self, T_base_tool: Array) -> Solutions:
        with self.watch.stage(IK):
            return self.solver.solve(T_base_tool)


@dataclass(frozen=True, eq=False)
class _TimedWorld(CollisionWorld):
    """A collision world, and every world made of it, whose checks are timed."""

    watch: Stopwatch = field(default_factory=Stopwatch)

    def in_collision(self, q: Array) -> npt.NDArray[np.bool_]:
        with self.watch.stage(COLLISION):
            return super().in_collision(q)

    def in_collision_at(self, T_world_joint: Array) -> npt.NDArray[np.bool_]:
        with self.watch.stage(COLLISION):
            return super().in_collision_at(T_world_joint)

    def any_collision(self, q: Array) -> bool:
        with self.watch.stage(COLLISION):
            return super().any_collision(q)
