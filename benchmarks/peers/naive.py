"""OMPL and Pinocchio as any user would put them together.

One `pin.computeCollisions` a state, and OMPL's own discrete checks of edges.
"""

from __future__ import annotations

import time

import numpy as np
import pinocchio as pin
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from mmplan.benchmarking.paths.arena import Arena
from mmplan.benchmarking.paths.records import Answer, Prepared
from mmplan.shapes import Array


def prepare(arena: Arena, step: float, reach: float, time_limit: float) -> Prepared:
    """The planner for an arena; `step` between checks, `reach` of edges, both rad."""
    begin = time.process_time()
    naive = _Naive(arena, step, reach, time_limit)
    return Prepared(naive.plan, time.process_time() - begin)


class _Naive:
    def __init__(
        self, arena: Arena, step: float, reach: float, time_limit: float
    ) -> None:
        self._model, self._geometry = arena.world.model, arena.world.geometry
        self._data = self._model.createData()
        self._geometry_data = self._geometry.createData()
        self._arena, self._joints = arena, arena.joints.indices
        self._reach, self._time_limit = reach, time_limit
        self._q, self._states = arena.q_start.copy(), 0
        space = ob.RealVectorStateSpace(len(self._joints))
        bounds = ob.RealVectorBounds(len(self._joints))
        for i, low in enumerate(arena.joints.lower):
            bounds.setLow(i, float(low))
            bounds.setHigh(i, float(arena.joints.upper[i]))
        space.setBounds(bounds)
        space.setLongestValidSegmentFraction(step / space.getMaximumExtent())
        self._space = space

    def plan(self, seed: int) -> Answer:
        """A path by RRTConnect."""
        ou.setLogLevel(ou.LogLevel.LOG_NONE)
        ou.RNG.setSeed(seed + 1)
        self._states = 0
        begin = time.process_time()
        si = ob.SpaceInformation(self._space)
        si.setStateValidityChecker(self._is_valid)
        si.setup()
        problem = ob.ProblemDefinition(si)
        problem.setStartAndGoalStates(
            self._state(si, self._arena.q_start), self._state(si, self._arena.q_goal)
        )
        planner = og.RRTConnect(si)
        planner.setRange(self._reach)
        planner.setProblemDefinition(problem)
        planner.setup()
        planner.solve(self._time_limit)
        seconds = time.process_time() - begin
        if not problem.hasExactSolution():
            return Answer(
                first_seconds=seconds, states=self._states, message="no path in time"
            )
        states = problem.getSolutionPath().getStates()
        path = np.tile(self._arena.q_start, (len(states), 1))
        path[:, self._joints] = [s[0 : len(self._joints)] for s in states]
        return Answer(path, seconds, states=self._states)

    def _state(self, si: ob.SpaceInformation, q: Array) -> ob.State:
        state = si.allocState()
        for i, value in enumerate(q[self._joints]):
            state[i] = float(value)
        return state

    def _is_valid(self, state: ob.State) -> bool:
        self._states += 1
        self._q[self._joints] = state[0 : len(self._joints)]
        return not pin.computeCollisions(
            self._model, self._data, self._geometry, self._geometry_data, self._q, True
        )
