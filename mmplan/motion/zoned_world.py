"""A world whose forbidden zones count as things that the base must not touch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision import CollisionWorld
from mmplan.planning import PlanningWorld
from mmplan.planning.world import Touch
from mmplan.problem import Problem
from mmplan.shapes import Array
from mmplan.zones import base_clearances


class _Entry(NamedTuple):
    first: str
    second: str


@dataclass(frozen=True, eq=False)
class ZonedWorld:
    """A collision world and the zones of a problem, for planning."""

    world: CollisionWorld
    problem: Problem
    margin: float  # m, to keep from all zones

    @property
    def model(self) -> pin.Model:
        """The robot's kinematic model."""
        return self.world.model

    @property
    def geometry(self) -> pin.GeometryModel:
        """Every body of the world; zones have none."""
        return self.world.geometry

    def in_collision(self, q: Array) -> npt.NDArray[np.bool_]:
        """Which of the configurations (n, nq) are in collision or in a zone, (n,)."""
        return self._in_zone(q) | self.world.in_collision(q)

    def any_collision(self, q: Array) -> bool:
        """Whether any of the configurations (n, nq) is in collision or in a zone."""
        return bool(self._in_zone(q).any()) or self.world.any_collision(q)

    def contacts(self, q: Array) -> Sequence[Touch]:
        """The zones that the base is in at one configuration (nq,), then contacts."""
        entered = [
            _Entry("the base", zone.name)
            for zone in self.problem.forbidden
            if _clearances(self.problem, q[None], zone.name)[0] < self.margin
        ]
        return [*entered, *self.world.contacts(q)]

    def _in_zone(self, q: Array) -> npt.NDArray[np.bool_]:
        inside: npt.NDArray[np.bool_] = _clearances(self.problem, q) < self.margin
        return inside


def with_zones(world: CollisionWorld, problem: Problem, *ends: Array) -> PlanningWorld:
    """The world in which the base must keep out of the problem's zones.

    By the planner's clearance, or by as much as one of the configurations `ends` (nq,)
    does. The world as it is where there are no zones, or no base that moves.
    """
    if not problem.forbidden or problem.base_stands:
        return world
    kept = float(_clearances(problem, np.array(ends)).min())
    return ZonedWorld(world, problem, max(0.0, min(problem.planner.clearance, kept)))


def are_alike(first: PlanningWorld, second: PlanningWorld) -> bool:
    """Whether two worlds of one scene, with its zones or without, have the same rules.

    That is the same distances to keep. Worlds with other rules are never alike.
    """
    if isinstance(first, ZonedWorld) and isinstance(second, ZonedWorld):
        same = first.margin == second.margin
        return same and are_alike(first.world, second.world)
    if isinstance(first, CollisionWorld) and isinstance(second, CollisionWorld):
        return first.clearance == second.clearance
    return first is second


def _clearances(problem: Problem, q: Array, name: str | None = None) -> Array:
    """How far the base keeps from all zones, or from one, at q (n, nq), (n,)."""
    robot = problem.robot
    zones = [z for z in problem.forbidden if name in (None, z.name)]
    return base_clearances(zones, q[:, robot.base.indices], robot.base_radius)
