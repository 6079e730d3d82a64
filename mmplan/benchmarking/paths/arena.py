"""A robot among the obstacles of one path problem, ready to plan in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mmplan.benchmarking.paths.problems import PathProblem
from mmplan.collision import CollisionWorld, Scenery
from mmplan.collision.solids import solids_of_obstacle
from mmplan.exceptions import InputError
from mmplan.planning import MovingJoints
from mmplan.robot import JointGroup, Robot
from mmplan.robot_build import load_robot
from mmplan.shapes import Array, read_only

# The robot of MotionBenchMaker's problems.
PANDA = "panda"
_PANDA_FILE = Path(__file__).with_name("panda.yaml")

# How far (m) a base may go beyond its start and its goal.
BASE_MARGIN = 1.5


@dataclass(frozen=True, eq=False)
class Contestant:
    """A robot that problems are for; the joints of its hand stand still at `hand`."""

    robot: Robot
    hand: tuple[float, ...]

    @property
    def joints(self) -> int:
        """How many joints move: those of base and arm."""
        return len(self.robot.base) + len(self.robot.arm)


@dataclass(frozen=True, eq=False)
class Arena:
    """What a planner is given: the world, what moves in it, and both ends."""

    world: CollisionWorld
    joints: MovingJoints
    q_start: Array  # (nq,)
    q_goal: Array
    problem: PathProblem


def contestant(
    name: str | Path = PANDA, hand: Sequence[float] | None = None
) -> Contestant:
    """The robot of a name or robot.yaml; `panda` stands where the world begins.

    `hand` are positions of the hand's leading joints; without any, the hand is open.

    Raises:
        InputError: There is no such robot, or the hand has more or fewer joints.
    """
    robot = load_robot(_PANDA_FILE if str(name) == PANDA else name)
    leads = robot.hand.leads
    if hand is None:
        hand = robot.hand_open[leads].tolist()
    if len(hand) != int(leads.sum()):
        raise InputError(
            f"the hand of {robot.name} has {int(leads.sum())} joints; got {len(hand)} "
            "positions"
        )
    return Contestant(robot, tuple(hand))


def make_arena(contestant: Contestant, problem: PathProblem) -> Arena:
    """The world of a problem, with nothing prepared that a planner could prepare.

    Joints that turn without end are kept within a turn of 0, a base near its ends.

    Raises:
        InputError: The problem is for another number of joints.
    """
    robot = contestant.robot
    if len(problem.q_start) != contestant.joints:
        raise InputError(
            f"{problem.family} {problem.number}: has {len(problem.q_start)} joints; "
            f"{robot.name} has {contestant.joints} in base and arm"
        )
    solids = tuple(s for o in problem.obstacles for s in solids_of_obstacle(o))
    world = CollisionWorld(robot, Scenery(solids, frozenset(), {}), {})
    q = np.zeros(robot.model.nq)
    q[robot.hand.indices[robot.hand.leads]] = contestant.hand
    ends = np.stack([q, q])
    moving = np.concatenate([robot.base.indices, robot.arm.indices])
    ends[:, moving] = problem.q_start, problem.q_goal
    ends = robot.with_followers(ends)
    groups = [_near(robot.base, ends), robot.arm] if len(robot.base) else [robot.arm]
    joints = MovingJoints.of_groups([_within_a_turn(group) for group in groups])
    return Arena(world, joints, read_only(ends[0]), read_only(ends[1]), problem)


def _near(base: JointGroup, ends: Array) -> JointGroup:
    """The base kept near both ends (2, nq) of a path; how it turns is left free."""
    low, high = ends[:, base.indices].min(axis=0), ends[:, base.indices].max(axis=0)
    lower = np.maximum(base.lower, low - BASE_MARGIN)
    upper = np.minimum(base.upper, high + BASE_MARGIN)
    return replace(
        base,
        lower=read_only(np.where(base.wraps, base.lower, lower)),
        upper=read_only(np.where(base.wraps, base.upper, upper)),
    )


def _within_a_turn(group: JointGroup) -> JointGroup:
    """The group without joints that turn without end, which few planners can do."""
    return replace(
        group,
        lower=read_only(np.where(group.wraps, -np.pi, group.lower)),
        upper=read_only(np.where(group.wraps, np.pi, group.upper)),
        wraps=np.zeros(len(group), dtype=np.bool_),
    )
