"""One search for a path by one of OMPL's planners, bounded by counts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from mmplan.collision import planning_clock
from mmplan.planning.checking import PathChecker
from mmplan.planning.joints import MovingJoints
from mmplan.planning.metric import Metric
from mmplan.planning.planners import make_planner
from mmplan.planning.roadmap import search_roadmap
from mmplan.planning.state_space import ScaledStates, space_information
from mmplan.planning.turns import Turns
from mmplan.problem import RANGES, PlannerSettings
from mmplan.shapes import Array

# States nearer to each other than this are one, m.
SAME_STATE = 1e-9
# The clock is looked at every so many iterations.
_UNTIMED = 16


class Budget:
    """Tells a planner when to stop; every time that it asks is one iteration.

    Planners that could go on improving a path stop at the first: it is shortened
    anyway, and going on would be bounded by the clock sooner than by the counts.

    Where the settings leave the range open, it is another one in each iteration.
    Turns that pass are none.
    """

    def __init__(
        self,
        settings: PlannerSettings,
        problem: ob.ProblemDefinition,
        planner: ob.Planner,
        turns: Turns | None = None,
    ) -> None:
        """Allow the settings' iterations and, as a safety net, their time limit."""
        self._set_range: Callable[[float], None] | None = None
        if settings.range is None:
            self._set_range = getattr(planner, "setRange", None)
        self._allowed = settings.iterations
        self._deadline = planning_clock() + settings.time_limit
        self._problem = problem
        self._turns = turns
        self.iterations = 0
        self.out_of_time = False

    def release(self) -> None:
        """Let go of the planner: some keep their budget, and are never freed then."""
        self._set_range = None

    def __call__(self) -> bool:
        """Whether the planner must stop."""
        if self.iterations >= self._allowed or self._problem.hasExactSolution():
            return True
        if self.iterations % _UNTIMED == 0:
            self.out_of_time = planning_clock() > self._deadline
            if self.out_of_time:
                return True
        if self._turns is not None:
            self._turns.begin()
            if self._turns.passes:
                return False
        if self._set_range is not None:
            self._set_range(RANGES[self.iterations % len(RANGES)])
        self.iterations += 1
        return False


@dataclass(frozen=True, eq=False)
class Search:
    """What came of a search.

    `gap` (m, weighted by lever arms) is how far the states connected to the start stay
    from the nearest goal.
    `start_tree` and `goal_tree` are the numbers of states that the planner connected
    to either end, and `tries`, where known, those of its attempts to extend the two: an
    end that took most of them is hemmed in.
    """

    waypoints: Array | None  # (n, nq)
    iterations: int
    out_of_time: bool
    gap: float
    start_tree: int
    goal_tree: int
    tries: tuple[int, int] | None = None


def search(
    checker: PathChecker,
    q_start: Array,
    q_goals: Array,
    joints: MovingJoints,
    settings: PlannerSettings,
    seed: int,
) -> Search:
    """Search a path from q_start (nq,) to any of q_goals (g, nq), all of them free.

    Raises:
        InputError: if there is no planner of that name.
    """
    with own_randomness(seed):
        metric = Metric.of_joints(joints, checker.sweep.weights)
        states = ScaledStates(q_start, joints, metric)
        ends = np.vstack([q_start, q_goals])
        turns = Turns() if settings.name == "RRTConnect" else None
        si = space_information(states, ends, checker, turns)
        problem = _problem(si, states, ends)
        planner = make_planner(settings, si)
        planner.setProblemDefinition(problem)
        planner.setup()
        budget = Budget(settings, problem, planner, turns)
        if isinstance(planner, og.PRM):
            way = search_roadmap(planner, si, states, budget, len(q_goals))
        else:
            planner.solve(ob.PlannerTerminationCondition(budget))
            way = _solution(problem, states)
        budget.release()
        gap, start_tree, goal_tree = 0.0, 0, 0
        if way is None:
            gap, start_tree, goal_tree = _how_far(planner, si, states, ends)
        return Search(
            waypoints=way,
            iterations=budget.iterations,
            out_of_time=budget.out_of_time,
            gap=gap,
            start_tree=start_tree,
            goal_tree=goal_tree,
            tries=(turns.taken[0], turns.taken[1]) if turns is not None else None,
        )


@contextmanager
def own_randomness(seed: int) -> Iterator[None]:
    """Start OMPL's random numbers from a seed, and keep OMPL quiet meanwhile.

    OMPL complains about every seed but a process's first, although it obeys.
    """
    level = ou.getLogLevel()
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    try:
        ou.RNG.setSeed(seed)
        yield
    finally:
        ou.setLogLevel(level)


def _problem(
    si: ob.SpaceInformation, states: ScaledStates, ends: Array
) -> ob.ProblemDefinition:
    """The start (the first end) and the goals (the others) as OMPL wants them."""
    problem = ob.ProblemDefinition(si)
    goals = ob.GoalStates(si)
    for i, q in enumerate(ends):
        state = si.allocState()
        states.write(q, state)
        (problem.addStartState if i == 0 else goals.addState)(state)  # copies it
    problem.setGoal(goals)
    # Any cost is good enough for the planners that look at it.
    objective = ob.PathLengthOptimizationObjective(si)
    objective.setCostThreshold(ob.Cost(float("inf")))
    problem.setOptimizationObjective(objective)
    return problem


def _solution(problem: ob.ProblemDefinition, states: ScaledStates) -> Array | None:
    """The configurations (n, nq) of the path found, if one was."""
    if not problem.hasExactSolution():
        return None
    path = problem.getSolutionPath().getStates()
    return np.array([states.configuration(state) for state in path])


def _how_far(
    planner: ob.Planner, si: ob.SpaceInformation, states: ScaledStates, ends: Array
) -> tuple[float, int, int]:
    """The gap and the sizes of the trees of a `Search`; ends (1 + g, nq)."""
    data = ob.PlannerData(si)
    planner.getPlannerData(data)
    neighbours: dict[int, set[int]] = {i: set() for i in range(data.numVertices())}
    for i in neighbours:
        for j in data.getEdges(i):
            neighbours[i].add(j)
            neighbours[j].add(i)
    found = [states.configuration(data.getVertex(i).getState()) for i in neighbours]
    q = np.array(found).reshape(-1, ends.shape[1])
    # (1 + g, vertices); the planner itself also calls its nearest misses goals.
    distances = states.metric.distances(q[None], ends[:, None])
    start_tree = _connected(neighbours, np.flatnonzero(distances[0] < SAME_STATE))
    at_goals = np.flatnonzero(np.any(distances[1:] < SAME_STATE, axis=0))
    reached = np.vstack([ends[:1], q[sorted(start_tree)]])
    gap = states.metric.distances(reached[None], ends[1:, None]).min()
    return float(gap), len(start_tree), len(_connected(neighbours, at_goals))


def _connected(
    neighbours: dict[int, set[int]], roots: npt.NDArray[np.int64]
) -> set[int]:
    """The vertices of a graph that are connected to any of the roots."""
    seen = {int(root) for root in roots}
    todo = sorted(seen)
    while todo:
        new = neighbours[todo.pop()] - seen
        seen |= new
        todo.extend(new)
    return seen
