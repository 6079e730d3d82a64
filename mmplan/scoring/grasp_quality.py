"""Grasp quality G: what a family vouches for, or what the contacts resist."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
import pinocchio as pin

from mmplan.collision import Closings, HandCloser
from mmplan.grasps import GraspFamily
from mmplan.grasps.contacts import Contacts, contact_wrenches
from mmplan.grasps.hand import HandSize
from mmplan.grasps.wrench_space import WrenchSpace
from mmplan.problem import Object, Problem, Task
from mmplan.shapes import Array

GRAVITY = 9.81  # m/s^2
# A grasp that holds this many times the object's weight loses no quality to it.
_AMPLE_MARGIN = 2.0
# How many orientations between start and goal the weight is judged in.
_ORIENTATIONS = 5


class Hold(NamedTuple):
    """The hand closed on the object in n grasps."""

    genes: Array  # (n, genes)
    T_object_tool: Array  # (n, 4, 4)
    closings: Closings


class QualityMeasure(Protocol):
    """A measure of grasp quality."""

    def __call__(self, hold: Hold) -> Array:
        """G in [0, 1] of each grasp, (n,); computed once for each grasp."""
        ...


class FamilyQuality:
    """G as the grasp family rates it: 1 for all grasps that close by construction."""

    def __init__(self, family: GraspFamily) -> None:
        """Ask one family."""
        self._family = family

    def __call__(self, hold: Hold) -> Array:
        """G in [0, 1], (n,).

        Raises:
            ValueError: The family returned a quality outside of [0, 1].
        """
        quality = self._family.quality(hold.genes)
        if not np.all((quality >= 0.0) & (quality <= 1.0)):
            name = type(self._family).__name__
            raise ValueError(f"{name}: grasp quality outside of [0, 1]")
        return quality


class WrenchQuality:
    """G from the wrenches that the closed fingers resist.

    The measure, `epsilon` or `volume` of the wrench space about the centre of mass,
    torques in units of the object's size, is divided by that of two ideal pads as far
    apart as the hand opens, which meet the object with all of their width and length,
    squarely through its centre of mass; of the six-dimensional volume the sixth root is
    taken. Where the object's mass is
    known, G also falls from a grasp that holds twice the weight to 0 for one that just
    holds it, at the hand's greatest force and in the worst orientation on the way from
    start to goal.
    """

    def __init__(self, problem: Problem, task: Task, closer: HandCloser) -> None:
        """Prepare for one task and the hand's closer on its object."""
        item = problem.object(task.object)
        self._measure = problem.score.quality
        self._friction = item.friction
        self._closer = closer
        self._centre, self._size = closer.centre_of_mass, closer.size
        self._weight = weight_wrenches(item, task, closer.force)
        space = WrenchSpace.of_wrenches(
            contact_wrenches(
                _ideal_contacts(closer.hand_size).about(np.zeros(3), self._size),
                self._friction,
            ).reshape(-1, 6)
        )
        self._ideal = self._value(space)

    def __call__(self, hold: Hold) -> Array:
        """G in [0, 1], (n,); 0 where the hand does not close."""
        quality = np.zeros(len(hold.T_object_tool))
        contacts = self._closer.contacts(hold.T_object_tool, hold.closings)
        wrenches = contact_wrenches(
            contacts.about(self._centre, self._size), self._friction
        )
        for row in np.flatnonzero(contacts.complete):
            space = WrenchSpace.of_wrenches(wrenches[row].reshape(-1, 6))
            share = min(1.0, self._value(space) / self._ideal)
            quality[row] = share * self._held(space)
        return quality

    def _value(self, space: WrenchSpace) -> float:
        if self._measure == "volume":
            return float(space.volume ** (1.0 / 6.0))
        return space.epsilon

    def _held(self, space: WrenchSpace) -> float:
        """From 1 where the weight is held with ease to 0 where it is just not."""
        if len(self._weight) == 0:
            return 1.0
        excess = (space.margin(self._weight) - 1.0) / (_AMPLE_MARGIN - 1.0)
        return float(np.clip(excess, 0.0, 1.0))


def quality_measure(
    problem: Problem, task: Task, family: GraspFamily, closer: HandCloser
) -> QualityMeasure:
    """The measure that the problem's settings name."""
    if problem.score.quality == "family":
        return FamilyQuality(family)
    return WrenchQuality(problem, task, closer)


def weight_wrenches(item: Object, task: Task, force: float) -> Array:
    """The wrench (s, 6) to hold the object, in its frame, on the way to the goal.

    In units of the hand's greatest `force` (N); none where the mass is not known, or
    the force without limit. The object turns from start to goal at a constant rate
    about one axis.
    """
    if item.mass is None or not np.isfinite(force):
        return np.empty((0, 6))
    R_start, R_goal = item.T_world_object[:3, :3], task.T_world_goal[:3, :3]
    turn = pin.log3(R_start.T @ R_goal)
    shares = np.linspace(0.0, 1.0, _ORIENTATIONS)
    R = np.array([R_start @ pin.exp3(share * turn) for share in shares])
    wrenches = np.zeros((_ORIENTATIONS, 6))
    wrenches[:, :3] = item.mass * GRAVITY / force * R[:, 2, :]  # up, in its frame
    return wrenches


def _ideal_contacts(hand: HandSize) -> Contacts:
    x, y, z = hand.opening / 2.0, hand.width / 2.0, hand.reach / 2.0
    pad = np.array([[x, y, z], [x, -y, z], [x, -y, -z], [x, y, -z]])
    corners = np.array([pad, pad * [-1.0, 1.0, 1.0]])
    normals = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    return Contacts(corners[None], normals[None])
