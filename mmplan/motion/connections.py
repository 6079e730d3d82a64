"""Ways that connect the robot to the short motions it is to go on with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mmplan.collision import CollisionWorld
from mmplan.ik.windings import windings
from mmplan.motion.carrying import kept_upright
from mmplan.motion.parts import Part
from mmplan.motion.ways import WayFinder, steering_of
from mmplan.motion.zoned_world import with_zones
from mmplan.planning import PathChecker, PlanningWorld, transit_joints
from mmplan.planning.metric import Metric
from mmplan.problem import Problem, Task
from mmplan.shapes import Array


class Connection(NamedTuple):
    """A way yet to be found: its world, its goals (m, nq), and the parts after it.

    Goals are where the parts begin, by whole `turns` (m, nq) of joints.
    """

    world: PlanningWorld
    q_goals: Array
    turns: Array
    parts: list[Part]


@dataclass(frozen=True, eq=False)
class Connector:
    """Finds ways from where the robot is to where parts of its motion begin."""

    problem: Problem
    task: Task

    def connection(
        self, world: CollisionWorld, q_start: Array, parts: list[Part]
    ) -> Connection:
        """What is to be found between q_start (nq,) and where parts begin.

        It keeps the clearance wanted from all that its ends keep it from, and the
        fingers still where an object is carried.
        """
        turns = self._turns(parts)
        q_goals = parts[0].path[0] + turns
        keeping = world.keeping(self.problem.planner.clearance, q_start, *q_goals)
        zoned = with_zones(keeping, self.problem, q_start, q_goals[0])
        ruled = kept_upright(
            zoned, self.problem, self.task, world.attached, q_start, *q_goals
        )
        return Connection(ruled, q_goals, turns, parts)

    def connect(
        self,
        name: str,
        world: CollisionWorld,
        q_start: Array,
        ways: Mapping[int, Connection],
        rng: np.random.Generator,
    ) -> tuple[int, Part, list[Part]]:
        """The number of the way that was found, it, and what follows as it meets it.

        Raises:
            BlockedError: None was found.
        """
        ruled = next(iter(ways.values())).world
        number = np.repeat(list(ways), [len(way.turns) for way in ways.values()])
        q_goals = np.vstack([way.q_goals for way in ways.values()])
        turns = np.vstack([way.turns for way in ways.values()])
        finder = WayFinder(self.problem, name, ruled, hand=not world.attached)
        found = finder.find(q_start, q_goals, rng)
        turn = turns[found.goal] + found.turns
        part = Part(name, ruled, found.legs, dict(world.attached))
        reached = int(number[found.goal])
        return reached, part, [x.turned(turn) for x in ways[reached].parts]

    def likely_turn(self, way: Connection, q_start: Array) -> Array:
        """The whole turns (nq,) with which a way from q_start (nq,) is likely to end.

        Those of the nearest goal, or of the nearest that can be reached in a straight
        line where there are several and the base need not be steered.
        """
        checker = PathChecker(way.world, self.problem.planner.resolution)
        joints = transit_joints(self.problem)
        metric = Metric.of_joints(joints, checker.sweep.weights)
        turns: Array = way.turns + metric.turns(way.q_goals, q_start)
        q_goals = way.parts[0].path[0] + turns
        order = np.argsort(metric.distances(q_goals, q_start), kind="stable").tolist()
        if len(order) > 1 and steering_of(self.problem) is None:
            straight = (i for i in order if checker.edge_free(q_start, q_goals[i]))
            return np.array(turns[next(straight, order[0])])
        return np.array(turns[order[0]])

    def _turns(self, parts: list[Part]) -> Array:
        """Whole turns of the arm's joints (m, nq) that keep all parts within limits."""
        arm = self.problem.robot.arm
        q = np.concatenate([part.path for part in parts])[:, arm.indices]
        others = windings(q[0], arm.lower, arm.upper) - q[0]
        inside = [
            bool(np.all((q + t >= arm.lower) & (q + t <= arm.upper))) for t in others
        ]
        turns = np.zeros((sum(inside), self.problem.robot.model.nq))
        turns[:, arm.indices] = others[inside]
        return turns
