"""What planning needs to know of the world: the narrow side of a collision world."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision import PlannerSpace
from mmplan.shapes import Array


class Touch(Protocol):
    """Two things that overlap, by name."""

    @property
    def first(self) -> str:
        """The one."""

    @property
    def second(self) -> str:
        """The other."""


class PlanningWorld(Protocol):
    """A robot among things that it must not touch.

    Bodies of `geometry` whose `parentJoint` is not 0 move with the robot, a carried
    object among them.
    """

    def __hash__(self) -> int:
        """Worlds are values, each its own."""

    @property
    def model(self) -> pin.Model:
        """The robot's kinematic model, every joint of one degree of freedom."""

    @property
    def geometry(self) -> pin.GeometryModel:
        """Every body of the world."""

    def in_collision(self, q: Array) -> npt.NDArray[np.bool_]:
        """Which of the configurations (n, nq) are in collision, (n,)."""

    def any_collision(self, q: Array) -> bool:
        """Whether any of the configurations (n, nq) is in collision."""

    def contacts(self, q: Array) -> Sequence[Touch]:
        """What overlaps at one configuration (nq,), worst first."""


class QuickAnswers(Protocol):
    """Which points and edges of a planner's space are free."""

    def state_free(self, point: list[float]) -> bool:
        """Whether a point (k,) is free."""

    def edge_free(self, ends: list[float]) -> bool:
        """Whether all steps of an edge are free; both ends, (2 k,)."""

    @property
    def steps(self) -> int:
        """Into how many steps the last edge was cut."""


@runtime_checkable
class MovingWorld(PlanningWorld, Protocol):
    """A world that answers for whole motions from q (nq,) to q + dq."""

    def steps_collide(self, q: Array, dq: Array, steps: int) -> bool:
        """Whether any of q + k / steps · dq, k = 1, ..., steps, is in collision."""

    def motion_collides(
        self, q: Array, dq: Array, *, likely_free: bool = False
    ) -> bool:
        """Whether anything collides on the way; a likely answer is told sooner."""

    def in_space(self, space: PlannerSpace) -> QuickAnswers | None:
        """Quick answers to questions in a planner's coordinates, where there are."""


@runtime_checkable
class RuledWorld(PlanningWorld, Protocol):
    """A world with rules beside the one that nothing may touch."""

    def broken_rules(self, q: Array) -> Sequence[str]:
        """The rules that are broken at one configuration (nq,), in words."""


@lru_cache(maxsize=16)  # it takes long to see what a world can do
def moving_part(world: PlanningWorld) -> MovingWorld | None:
    """The world, or the one within that other rules are laid upon, if it can do so."""
    inner: object = world
    while not isinstance(inner, MovingWorld):
        inner = getattr(inner, "world", None)
        if inner is None:
            return None
    return inner


def contact_names(world: PlanningWorld, q: Array) -> str:
    """`forearm touches counter, hand touches wineglass` at one configuration (nq,)."""
    broken = world.broken_rules(q) if isinstance(world, RuledWorld) else ()
    touches = [f"{c.first} touches {c.second}" for c in world.contacts(q)]
    return ", ".join([*broken, *touches]) or "in collision"
