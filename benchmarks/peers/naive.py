"""OMPL and Pinocchio as any user would put them together.

One `pin.computeCollisions` a state, and OMPL's own discrete checks of edges.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou


class NaivePath(NamedTuple):
    """A path, None if none was found, and the CPU time (s) that it took."""

    path: np.ndarray | None  # (n, nq)
    seconds: float
    states: int


class Naive:
    """The planner for one world: its robot, its geometry, the joints that move."""

    def __init__(self, model, geometry, joints, lower, upper, step, reach) -> None:
        """Prepare; `step` is the resolution and `reach` the longest edge, rad."""
        self._model, self._data = model, model.createData()
        self._geometry, self._geometry_data = geometry, geometry.createData()
        self._joints = joints
        self._states = 0
        space = ob.RealVectorStateSpace(len(joints))
        bounds = ob.RealVectorBounds(len(joints))
        for i, (low, high) in enumerate(zip(lower, upper, strict=True)):
            bounds.setLow(i, float(low))
            bounds.setHigh(i, float(high))
        space.setBounds(bounds)
        space.setLongestValidSegmentFraction(step / space.getMaximumExtent())
        self._space, self._reach = space, reach

    def plan(self, q_start, q_goal, time_limit: float, seed: int) -> NaivePath:
        """Plan by RRTConnect from q_start (nq,) to q_goal (nq,)."""
        ou.setLogLevel(ou.LogLevel.LOG_NONE)
        ou.RNG.setSeed(seed)
        self._q, self._states = q_start.copy(), 0
        begin = time.process_time()
        si = ob.SpaceInformation(self._space)
        si.setStateValidityChecker(self._is_valid)
        si.setup()
        problem = ob.ProblemDefinition(si)
        start, goal = si.allocState(), si.allocState()
        for state, q in ((start, q_start), (goal, q_goal)):
            for i, value in enumerate(q[self._joints]):
                state[i] = float(value)
        problem.setStartAndGoalStates(start, goal)
        planner = og.RRTConnect(si)
        planner.setRange(self._reach)
        planner.setProblemDefinition(problem)
        planner.setup()
        planner.solve(time_limit)
        seconds = time.process_time() - begin
        if not problem.hasExactSolution():
            return NaivePath(None, seconds, self._states)
        states = problem.getSolutionPath().getStates()
        path = np.tile(q_start, (len(states), 1))
        path[:, self._joints] = [s[0 : len(self._joints)] for s in states]
        return NaivePath(path, seconds, self._states)

    def _is_valid(self, state) -> bool:
        self._states += 1
        self._q[self._joints] = state[0 : len(self._joints)]
        return not pin.computeCollisions(
            self._model, self._data, self._geometry, self._geometry_data, self._q, True
        )
