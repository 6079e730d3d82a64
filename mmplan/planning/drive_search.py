"""Finding a way for a base that rolls, by OMPL in the plane of its poses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import numpy.typing as npt
from ompl import base as ob

from mmplan.collision import coarse_to_fine
from mmplan.planning.checking import PathChecker
from mmplan.planning.drive import Drive, at_poses, make_drive
from mmplan.planning.planners import make_planner
from mmplan.planning.rolling import Steering, joints_of, wrapped
from mmplan.planning.search import Budget, own_randomness
from mmplan.planning.world import PlanningWorld, contact_names
from mmplan.problem import PlannerSettings
from mmplan.shapes import Array

# Where there is no room to turn, going straight ahead or back so far (m) may give it.
_STRAIGHT_OFF = (0.0, -0.25, 0.25, -0.5, 0.5, -1.0, 1.0)
# Finds ways in the plane; the planner of the scene is for paths of all joints.
_PLANNER = "RRTConnect"


@dataclass(frozen=True, eq=False)
class DriveResult:
    """A drive, or why there is none."""

    drive: Drive | None
    message: str  # one line for people


@dataclass(frozen=True, eq=False)
class Floor:
    """Where a base may roll with the rest of the robot in one posture."""

    checker: PathChecker
    q: Array  # (nq,), the posture
    base: npt.NDArray[np.int_]  # (3,), places of x, y and heading in q
    bounds: Array  # (3, 2), m and rad
    steering: Steering

    def pose_free(self, pose: Array) -> bool:
        """Whether the robot can stand at a pose (3,)."""
        return self._all_free(pose[None])

    def way_free(self, start: Array, end: Array) -> bool:
        """Whether the way steered from pose to pose is free, its start not checked."""
        poses = [np.empty((0, 3))]
        pieces = self.steering.pieces(start, end)
        starts = joints_of(pieces, start)
        for pose, piece in zip(starts, pieces, strict=False):
            dq = np.zeros(len(self.q))
            dq[self.base] = piece.length, piece.length, piece.turn
            steps = int(self.checker.steps(dq))
            fractions = coarse_to_fine(steps)[:, 0] / steps
            poses.append(piece.poses(pose, fractions))
        return self._all_free(np.concatenate(poses))

    def ways_out(self, pose: Array) -> list[Array]:
        """The pose and those straight ahead of it and behind it that it can reach."""
        ahead = np.array([np.cos(pose[2]), np.sin(pose[2]), 0.0])
        found = [pose + way * ahead for way in _STRAIGHT_OFF]
        return [p for p in found if p is found[0] or self.way_free(pose, p)]

    def _all_free(self, poses: Array) -> bool:
        low, high = self.bounds[:2].T
        if np.any((poses[:, :2] < low) | (poses[:, :2] > high)):
            return False
        return self.checker.states_free(at_poses(self.q, self.base, poses))


def plan_drive(
    world: PlanningWorld,
    q: Array,
    pose_goal: Array,
    base: npt.NDArray[np.int_],
    bounds: Array,
    steering: Steering,
    settings: PlannerSettings,
    rng: np.random.Generator,
) -> DriveResult:
    """Drive from q (nq,) to a pose (3,), heading modulo whole turns.

    `base` are the places of x, y and heading in q, `bounds` (3, 2) say where they may
    go. The same generator state gives the same drive.
    """
    floor = Floor(PathChecker(world, settings.resolution), q, base, bounds, steering)
    start = q[base]
    seed = int(rng.integers(1, 2**31))
    for pose, what in ((start, "start"), (pose_goal, "goal")):
        if not floor.pose_free(pose):
            touched = contact_names(world, at_poses(q, base, pose[None])[0])
            return DriveResult(
                None, f"the posture to drive in, at the {what}: {touched}"
            )
    starts, goals = floor.ways_out(start), floor.ways_out(pose_goal)
    found = _simple_way(floor, starts, goals) or _search(
        floor, starts, goals, settings, seed
    )
    if found is None:
        return DriveResult(None, "found no way for the base in the posture to drive in")
    waypoints = [start, *found, pose_goal]
    drive = make_drive(q, base, _needed(waypoints, floor), steering)
    low, high = drive.poses[:, 2].min(), drive.poses[:, 2].max()
    if low < bounds[2, 0] or high > bounds[2, 1]:
        return DriveResult(None, "the base would turn beyond the limits of its heading")
    return DriveResult(drive, f"a drive in {len(drive.pieces)} pieces")


def _simple_way(
    floor: Floor, starts: list[Array], goals: list[Array]
) -> list[Array] | None:
    """The first free way that needs no search, straight out at both ends."""
    for start, goal in product(starts, goals):
        if floor.way_free(start, goal):
            return [start, goal]
    return None


def _needed(waypoints: list[Array], floor: Floor) -> list[Array]:
    """The waypoints less those that are not needed, greedily."""
    kept, here = [waypoints[0]], 0
    while here < len(waypoints) - 1:
        ahead = range(len(waypoints) - 1, here + 1, -1)
        reach = (i for i in ahead if floor.way_free(waypoints[here], waypoints[i]))
        here = next(reach, here + 1)
        kept.append(waypoints[here])
    return kept


class _PoseValidity(ob.StateValidityChecker):
    """Whether the robot can stand at one pose."""

    def __init__(self, si: ob.SpaceInformation, floor: Floor) -> None:
        super().__init__(si)
        self._floor = floor

    def isValid(self, state: ob.State) -> bool:
        return self._floor.pose_free(_pose(state))


class _SteeredMotions(ob.MotionValidator):
    """Whether the way steered between two poses is free."""

    def __init__(self, si: ob.SpaceInformation, floor: Floor) -> None:
        super().__init__(si)
        self._floor = floor

    def checkMotion(self, start: ob.State, end: ob.State) -> bool:
        return self._floor.way_free(_pose(start), _pose(end))


def _search(
    floor: Floor,
    starts: list[Array],
    goals: list[Array],
    settings: PlannerSettings,
    seed: int,
) -> list[Array] | None:
    """Poses from one of the starts to one of the goals, with free ways between them."""
    with own_randomness(seed):
        space = ob.ReedsSheppStateSpace(floor.steering.radius)
        space.setBounds(_real_bounds(floor.bounds))
        si = ob.SpaceInformation(space)
        si.setStateValidityChecker(_PoseValidity(si, floor))
        si.setMotionValidator(_SteeredMotions(si, floor))
        si.setup()
        problem = ob.ProblemDefinition(si)
        ends = ob.GoalStates(si)
        for pose in starts:
            problem.addStartState(_written(si.allocState(), pose))
        for pose in goals:
            ends.addState(_written(si.allocState(), pose))
        problem.setGoal(ends)
        planner = make_planner(replace(settings, name=_PLANNER), si)
        planner.setProblemDefinition(problem)
        planner.setup()
        budget = Budget(settings, problem, planner)
        planner.solve(ob.PlannerTerminationCondition(budget))
        budget.release()
        if not problem.hasExactSolution():
            return None
        return [_pose(state) for state in problem.getSolutionPath().getStates()]


def _real_bounds(bounds: Array) -> ob.RealVectorBounds:
    real = ob.RealVectorBounds(2)
    for i in range(2):
        real.setLow(i, float(bounds[i, 0]))
        real.setHigh(i, float(bounds[i, 1]))
    return real


def _pose(state: ob.State) -> Array:
    return np.array([state.getX(), state.getY(), state.getYaw()])


def _written(state: ob.State, pose: Array) -> ob.State:
    state.setXY(float(pose[0]), float(pose[1]))
    state.setYaw(wrapped(float(pose[2])))
    return state
