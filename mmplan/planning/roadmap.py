"""Searching with OMPL's roadmap planners without their second thread.

`PRM.solve` looks for the solution in a thread of its own, which waits for ever for the
Python interpreter that the first one holds, and when it finds one depends on the clock.
So the roadmap is grown by OMPL, in rounds, and searched here.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from mmplan.planning.state_space import ScaledStates
from mmplan.shapes import Array

# Iterations of the first round; every round is as long as all before it.
FIRST_ROUND = 50


def search_roadmap(
    planner: og.PRM,
    si: ob.SpaceInformation,
    states: ScaledStates,
    stop: Callable[[], bool],
    goals: int,
) -> Array | None:
    """Grow a roadmap until it joins start and goal or `stop` says so.

    Returns:
        The configurations (n, nq) along the shortest way through the roadmap.
    """
    for _ in range(goals):
        # Only adds the start and one more goal to the roadmap.
        planner.solve(ob.plannerAlwaysTerminatingCondition())
    round_length = FIRST_ROUND
    while True:
        way = _shortest_way(planner, si, states)
        if way is not None or stop():
            return way
        planner.growRoadmapPtc(_for_iterations(round_length, stop))
        round_length *= 2


def _for_iterations(
    iterations: int, stop: Callable[[], bool]
) -> ob.PlannerTerminationCondition:
    left = iter(range(iterations))
    return ob.PlannerTerminationCondition(lambda: next(left, None) is None or stop())


def _shortest_way(
    planner: og.PRM, si: ob.SpaceInformation, states: ScaledStates
) -> Array | None:
    """Dijkstra's search from all starts to the nearest goal, None if none is."""
    data = ob.PlannerData(si)
    planner.getPlannerData(data)
    vertices = range(data.numVertices())
    q = [states.configuration(data.getVertex(i).getState()) for i in vertices]
    goals = {data.getGoalIndex(i) for i in range(data.numGoalVertices())}
    queue = [(0.0, data.getStartIndex(i), -1) for i in range(data.numStartVertices())]
    came_from: dict[int, int] = {}
    while queue:
        length, here, before = heapq.heappop(queue)
        if here in came_from:
            continue
        came_from[here] = before
        if here in goals:
            return np.array([q[i] for i in reversed(_way_back(here, came_from))])
        for there in data.getEdges(here):
            step = float(states.metric.distances(q[there], q[here]))
            heapq.heappush(queue, (length + step, there, here))
    return None


def _way_back(vertex: int, came_from: dict[int, int]) -> list[int]:
    way = []
    while vertex >= 0:
        way.append(vertex)
        vertex = came_from[vertex]
    return way
