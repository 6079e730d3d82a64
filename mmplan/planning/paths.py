"""Planning of one path: the ends checked, a search, and the path made short."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from mmplan.planning.checking import PathChecker
from mmplan.planning.joints import MovingJoints
from mmplan.planning.metric import Metric
from mmplan.planning.path_finder import PathFinder
from mmplan.planning.planners import require_planner
from mmplan.planning.search import Search
from mmplan.planning.shortening import path_length, shorten
from mmplan.planning.upright import UprightWorld
from mmplan.planning.upright_search import thinned
from mmplan.planning.world import PlanningWorld, contact_names
from mmplan.problem import PlannerSettings
from mmplan.shapes import Array, read_only


class PathOutcome(Enum):
    """How the planning of a path ended."""

    FOUND = "found"
    INVALID_START = "invalid start"
    INVALID_GOAL = "invalid goal"
    ITERATIONS = "iterations exhausted"
    TIME_LIMIT = "time limit reached"
    GAVE_UP = "planner gave up"


@dataclass(frozen=True, eq=False)
class PathResult:
    """A path, or why there is none and how far the search got.

    Joints that wrap may arrive whole turns from where the goal has them: the path ends
    at that goal plus `turns`.

    Lengths and gaps are weighted by the joints' lever arms: a bound on how far points
    of the robot move.
    """

    outcome: PathOutcome
    message: str  # one line for people
    path: Array | None = None  # (n, nq) waypoints, straight lines between them
    goal: int | None = None  # which of the goals it reaches
    turns: Array | None = None  # (nq,)
    length: float = 0.0  # m
    gap: float = 0.0  # m, from where a failed search ended to the nearest goal
    start_tree: int = 0  # states that a failed search connected to the start
    goal_tree: int = 0  # and to the goals
    iterations: int = 0
    states: int = 0  # checked
    edges: int = 0  # checked
    first: Array | None = None  # (m, nq) the path before it was made short
    shortening: float = 0.0  # CPU s that this took

    @property
    def found(self) -> bool:
        """Whether there is a path."""
        return self.path is not None


def plan_path(
    world: PlanningWorld,
    q_start: Array,
    q_goals: Array,
    joints: MovingJoints,
    settings: PlannerSettings,
    rng: np.random.Generator,
) -> PathResult:
    """Plan a path from q_start (nq,) to any of q_goals (g, nq).

    Goals in collision or out of limits are left out. Where a goal can be reached in a
    straight line, that is the path. The same generator state gives the same path.

    Where motions are to be checked continuously, the planner first looks at coarse
    steps. For edges of the path found that then collide between these it looks for ways
    around with every edge checked continuously; where there is none, for the whole way.

    Raises:
        InputError: if there is no planner of that name, or it cannot plan for joints
            that wrap.
        ValueError: if there are no goals or they differ from the start in a joint that
            does not move.
    """
    require_planner(settings.name, circles=bool(joints.wraps.any()))
    q_goals = np.atleast_2d(q_goals)
    _require_still(world, q_start, q_goals, joints)
    continuous = settings.motion_check == "continuous"
    checker = PathChecker(world, settings.resolution, continuous=continuous)
    fault = _fault(world, q_start, joints)
    if fault:
        return _failure(checker, PathOutcome.INVALID_START, f"the start: {fault}")
    faults = [_fault(world, q, joints) for q in q_goals]
    usable = np.array([i for i, f in enumerate(faults) if f is None], dtype=np.int64)
    if not len(usable):
        return _failure(checker, PathOutcome.INVALID_GOAL, f"the goal: {faults[0]}")
    metric = Metric.of_joints(joints, checker.sweep.weights)
    straight = _straight_path(checker, metric, q_start, q_goals[usable])
    seed = int(rng.integers(1, 2**31))
    if straight is not None:
        return _success(checker, metric, straight, q_goals)
    finder = PathFinder(joints, settings, seed)
    found, waypoints = finder.find(checker, q_start, q_goals[usable])
    if waypoints is None:
        return _exhausted(checker, found, settings)
    begin = time.process_time()
    if isinstance(world, UprightWorld):
        waypoints = thinned(waypoints, checker)
    path = shorten(
        waypoints, checker, joints, settings.shortcuts, rng, settings.shorten
    )
    shortening = time.process_time() - begin
    result = _success(checker, metric, path, q_goals, found.iterations)
    return replace(result, first=read_only(waypoints), shortening=shortening)


def _require_still(
    world: PlanningWorld, q_start: Array, q_goals: Array, joints: MovingJoints
) -> None:
    if not len(q_goals):
        raise ValueError("a path needs at least one goal")
    stands = np.ones(len(q_start), dtype=np.bool_)
    stands[joints.indices] = False
    stands[[f.follower for f in joints.followers]] = False
    still = np.flatnonzero(stands)
    moved = still[np.any(q_goals[:, still] != q_start[still], axis=0)]
    if len(moved):
        names = [world.model.names[j] for j in range(1, world.model.njoints)]
        by_index = {world.model.joints[j + 1].idx_q: n for j, n in enumerate(names)}
        culprits = ", ".join(by_index[int(i)] for i in moved)
        raise ValueError(f"joints that do not move differ at the goal: {culprits}")


def _fault(world: PlanningWorld, q: Array, joints: MovingJoints) -> str | None:
    """What is wrong with an end of the path, None if nothing is."""
    outside = joints.outside(q)
    if outside:
        return outside
    return contact_names(world, q) if world.any_collision(q[None]) else None


def _straight_path(
    checker: PathChecker, metric: Metric, q_start: Array, q_goals: Array
) -> Array | None:
    """The straight path to the nearest goal that has one."""
    q_goals = q_goals + metric.turns(q_goals, q_start)
    distances = metric.distances(q_goals, q_start)
    for q_goal in q_goals[np.argsort(distances, kind="stable")]:
        if checker.edge_free(q_start, q_goal):
            return np.vstack([q_start, q_goal])
    return None


def _success(
    checker: PathChecker,
    metric: Metric,
    path: Array,
    q_goals: Array,
    iterations: int = 0,
) -> PathResult:
    turns = metric.turns(q_goals, path[-1])
    goal = int(np.argmin(np.abs(q_goals + turns - path[-1]).max(axis=1)))
    path = np.vstack([path[:-1], q_goals[goal] + turns[goal]])
    length = path_length(path, checker.sweep.weights)
    return PathResult(
        outcome=PathOutcome.FOUND,
        message=f"a path of {len(path)} waypoints after {iterations} iterations",
        path=read_only(path),
        goal=goal,
        turns=read_only(turns[goal]),
        length=length,
        iterations=iterations,
        states=checker.states,
        edges=checker.edges,
    )


def _failure(checker: PathChecker, outcome: PathOutcome, message: str) -> PathResult:
    return PathResult(outcome, message, states=checker.states, edges=checker.edges)


def _exhausted(
    checker: PathChecker, found: Search, settings: PlannerSettings
) -> PathResult:
    outcome = PathOutcome.GAVE_UP
    if found.out_of_time:
        outcome = PathOutcome.TIME_LIMIT
    elif found.iterations >= settings.iterations:
        outcome = PathOutcome.ITERATIONS
    tries = [f" in {n} tries" for n in found.tries] if found.tries else ["", ""]
    message = (
        f"{outcome.value} after {found.iterations} iterations and {checker.edges} "
        f"edges: {found.start_tree} states connected to the start{tries[0]}, "
        f"{found.goal_tree} to the goal{tries[1]}, {found.gap:.2f} m left to go"
    )
    return PathResult(
        outcome=outcome,
        message=message,
        gap=found.gap,
        start_tree=found.start_tree,
        goal_tree=found.goal_tree,
        iterations=found.iterations,
        states=checker.states,
        edges=checker.edges,
    )
