"""The second half of a task's motion: with the object lifted to its goal."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mmplan.candidate import Candidate
from mmplan.collision import CollisionWorld
from mmplan.motion.connections import Connector
from mmplan.motion.parts import Blocked, BlockedError, Part
from mmplan.motion.segments import Timing
from mmplan.motion.short_motions import ShortMotions
from mmplan.plan import Segment
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Delivery:
    """Plans a candidate's transfer, lower, release and retreat.

    It knows of the half before only where that ends, so that another process can be at
    work on it before that is planned.
    """

    candidate: Candidate
    short: ShortMotions
    connector: Connector
    timing: Timing
    carrying: CollisionWorld  # the world with the object in the hand

    def blocked_place(self) -> Blocked | None:
        """What stands in the way of the short motions, planned first."""
        try:
            self._place  # noqa: B018 (kept for the segments)
        except BlockedError as error:
            return error.blocked
        return None

    def segments(
        self, q_start: Array, lifted: bool, rng: np.random.Generator
    ) -> tuple[Segment, ...] | Blocked:
        """The segments from q_start (nq,), or what stood in their way.

        Where the object was not lifted or is not lowered, it starts or ends in contact.
        """
        try:
            return self.timing.segments(self._parts(q_start, lifted, rng))
        except BlockedError as error:
            return error.blocked

    def _parts(
        self, q_start: Array, lifted: bool, rng: np.random.Generator
    ) -> list[Part]:
        """The transfer, and the place on the winding that it arrives at."""
        world, short, task = self.carrying, self.short, self.short.task
        if not lifted:
            world = short.resting(world, short.world.standing[task.object])
        if not self._place[0].moves:
            world = short.resting(world, task.T_world_goal)
        way = self.connector.connection(world, q_start, self._place)
        _, transfer, place = self.connector.connect(
            "transfer", world, q_start, {0: way}, rng
        )
        return [transfer, *place]

    @cached_property
    def _place(self) -> list[Part]:
        """The short motions.

        Raises:
            BlockedError: One of them is not free, or the arm is too weak.
        """
        place = self.short.place(self.candidate, self.carrying)
        self.timing.require_strength(place[0])
        return place
