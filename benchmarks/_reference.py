"""Score(q_base, grasp) the straightforward way, as the measure of speed and of truth.

One candidate after the other, one configuration after the other: Pinocchio's
`computeCollisions` over all pairs with the hand closed and opened, its Jacobian, and
its `computeDistances` over all pairs of links and obstacles. Nothing is remembered,
bounded or left out. The hand's openings come from mmplan, which computes them once for
each grasp in both cases.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pinocchio as pin

from mmplan.collision import CollisionWorld, make_exact
from mmplan.scoring import End, ScoreFunction
from mmplan.shapes import Array


class ReferenceScore:
    """The score of one task, one evaluation at a time."""

    def __init__(self, score: ScoreFunction) -> None:
        """Take the problem, task and worlds of a score function."""
        self._score = score
        self._robot = score.problem.robot
        name = score.task.object
        self._data = self._robot.model.createData()
        self._open = {e: _Pairs(w) for e, w in score.worlds.items()}
        self._closed = {
            e: _Pairs(w.permit_touch(name, fingers=True))
            for e, w in score.worlds.items()
        }
        self._clutter = {e: _Clutter(w.without(name)) for e, w in score.worlds.items()}

    def __call__(self, end: End, q_base: Array, grasp: Array) -> float:
        """The score of one base (b,) and one grasp (g,)."""
        low, high = self._score.problem.base_bounds.T
        if np.any((q_base < low) | (q_base > high)):
            return 0.0
        hold = self._score.holds(grasp[None])
        robot = self._robot
        T_base_world = np.linalg.inv(robot.base_poses(q_base[None])[0])
        T_world_object = self._score.worlds[end].standing[self._score.task.object]
        T_base_tool = T_base_world @ T_world_object @ hold.T_object_tool[0]
        solutions = robot.ik.solve(T_base_tool[None])
        best = 0.0
        for q_arm in solutions.q[solutions.within]:
            q = np.array(robot.q_neutral)
            q[robot.base.indices] = q_base
            q[robot.arm.indices] = q_arm
            best = max(best, self._of_configuration(end, q, hold.opened, hold.closed))
        return best

    def _of_configuration(
        self, end: End, q: Array, opened: Array, closed: Array
    ) -> float:
        hand = self._robot.hand.indices
        q[hand] = closed[0]
        q_open = q.copy()
        q_open[hand] = opened[0]
        if self._closed[end].collide(q) or self._open[end].collide(q_open):
            return 0.0
        terms = (1.0, self._manipulability(q), self._clutter[end](q))
        return float(self._score.factors @ terms)

    def _manipulability(self, q: Array) -> float:
        robot = self._robot
        J = pin.computeFrameJacobian(robot.model, self._data, q, robot.tool_frame)[
            :, robot.arm.indices
        ]
        return max(0.0, float(np.linalg.eigvalsh(J @ J.T)[0]))


class _Pairs:
    """All pairs of one world, checked one configuration at a time."""

    def __init__(self, world: CollisionWorld) -> None:
        self._world = world
        self._data = world.model.createData()
        self._geometry_data = world.geometry.createData()
        make_exact(self._geometry_data, world.allowed_depth)

    def collide(self, q: Array) -> bool:
        """Whether any pair is in collision at q (nq,)."""
        return bool(
            pin.computeCollisions(
                self._world.model,
                self._data,
                self._world.geometry,
                self._geometry_data,
                q,
                True,
            )
        )


class _Clutter:
    """C (paper, eq. 2) from the distances of all pairs of links and obstacles."""

    def __init__(self, world: CollisionWorld) -> None:
        self._world, self._robot = world, world.robot
        self._geometry = world.geometry.clone()
        self._geometry.removeAllCollisionPairs()
        bodies = world.bodies
        self._owners = []
        for i, robot_body in enumerate(bodies):
            for j, other in enumerate(bodies):
                if robot_body.joint == 0 or other.joint != 0:
                    continue
                if (robot_body.kind, other.kind) != ("base", "ground"):
                    self._geometry.addCollisionPair(pin.CollisionPair(i, j))
                    self._owners.append(robot_body.owner)
        self._middles = {o: self._middle(o) for o in self._owners}
        self._data = world.model.createData()
        self._geometry_data = self._geometry.createData()
        make_exact(self._geometry_data)

    def __call__(self, q: Array) -> float:
        """C of one configuration (nq,)."""
        model, data = self._world.model, self._data
        pin.computeDistances(model, data, self._geometry, self._geometry_data, q)
        nearest = dict.fromkeys(self._middles, np.inf)
        results = self._geometry_data.distanceResults
        for owner, result in zip(self._owners, results, strict=True):
            nearest[owner] = min(nearest[owner], result.min_distance)
        return sum(self._weight(link) * d for link, d in nearest.items())

    def _weight(self, link: str) -> float:
        """1 / max(distance of the link's middle to the base's centre, base radius)."""
        robot, data = self._robot, self._data
        joint, middle = self._middles[link]
        base = robot.model.getJointId(robot.base.names[-1])
        centre = data.oMi[base].act(robot.model.inertias[base].lever)
        distance = float(np.linalg.norm(data.oMi[joint].act(middle) - centre))
        return 1.0 / max(distance, robot.base_radius)

    def _middle(self, link: str) -> tuple[int, Array]:
        """The joint that moves a link, and the middle of its bodies in its frame."""
        corners, joint = [], 0
        for body in self._robot.geometry.geometryObjects:
            if self._robot.link_of(body) == link:
                joint = int(body.parentJoint)
                body.geometry.computeLocalAABB()
                box = body.geometry.aabb_local
                for x, y, z in product(*zip(box.min_, box.max_, strict=True)):
                    corners.append(body.placement.act(np.array([x, y, z])))
        return joint, (np.min(corners, axis=0) + np.max(corners, axis=0)) / 2
