"""Closing the hand on an object until the fingers touch it."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.collision.fingers import Drive, Fingers, ObjectSolids
from mmplan.collision.hand_size import hand_size
from mmplan.collision.pads import contacts_of
from mmplan.collision.scenery import centre_of_mass
from mmplan.collision.solids import Solid
from mmplan.grasps.contacts import Contacts
from mmplan.grasps.hand import HandSize
from mmplan.robot import Robot
from mmplan.shapes import Array

# A finger stops when it is this near to the object, m; it never overlaps it.
CONTACT_DISTANCE = 1e-4
# Fingers that one drive moves together all touch if they are this near, m, when the
# first of them does.
TOGETHER = 1e-3
# How far the fingers open beyond contact before grasping, as a share of their stroke.
OPENING_SHARE = 0.2
_MAX_STEPS = 60


class Closings(NamedTuple):
    """The hand on n grasps: joint values before and after it closes.

    `touches` says whether every finger touches, having been clear when fully open.
    """

    opened: Array  # (n, hand joints)
    closed: Array  # (n, hand joints)
    touches: npt.NDArray[np.bool_]  # (n,)


class HandCloser:
    """Closes each finger of a robot's hand on one object by conservative advancement.

    A finger moves by its distance to the object over the greatest speed of its points,
    so that it stops at contact without ever passing it. Before it closes, the hand is
    open a little wider than at contact, and never wider than it can be.
    """

    def __init__(self, robot: Robot, solids: tuple[Solid, ...]) -> None:
        """Prepare for an object made of `solids`."""
        self._robot = robot
        self._object = ObjectSolids(solids)
        self._fingers = Fingers(robot)
        self._solids = solids

    @cached_property
    def hand_size(self) -> HandSize:
        """The measures of the hand."""
        return hand_size(self._robot)

    @cached_property
    def centre_of_mass(self) -> Array:
        """That of the object (3,), in its frame, of even density."""
        return centre_of_mass(self._solids)

    @cached_property
    def size(self) -> float:
        """Half the diagonal of the object's bounds, m."""
        return self._object.half_diagonal

    @property
    def force(self) -> float:
        """What all fingers together press with at most, N; infinite if not limited.

        A turning finger presses least where it is longest.
        """
        limits = self._robot.model.upperEffortLimit
        velocities = self._robot.model.idx_vs
        total = 0.0
        for drive in self._fingers.drives:
            name = self._robot.hand.names[drive.place]
            effort = limits[velocities[self._robot.model.getJointId(name)]]
            total += float(effort) / drive.top_speed if effort > 0.0 else np.inf
        return total

    def close(self, T_object_tool: Array) -> Closings:
        """Close the hand at tool poses (n, 4, 4) in the object's frame."""
        robot = self._robot
        n = len(T_object_tool)
        closed = np.tile(robot.hand_open, (n, 1))
        touches = np.ones(n, dtype=np.bool_)
        for drive in self._fingers.drives:
            touches &= self._advance(T_object_tool, closed, drive)
        stroke = robot.hand_closed - robot.hand_open
        past = OPENING_SHARE * np.abs(stroke)
        opened = closed - np.sign(stroke) * np.minimum(
            past, np.abs(closed - robot.hand_open)
        )
        return Closings(opened, closed, touches)

    def contacts(self, T_object_tool: Array, closings: Closings) -> Contacts:
        """Where the closed fingers touch at tool poses (n, 4, 4), which were closed."""
        placed = [
            self._fingers.placed(T_object_tool, closings.closed, finger)
            for drive in self._fingers.drives
            for finger in drive.fingers.values()
        ]
        return contacts_of(self._object, placed, closings.touches)

    def _advance(
        self, T_object_tool: Array, hand: Array, drive: Drive
    ) -> npt.NDArray[np.bool_]:
        """Move one drive of n hands to contact, `hand` in place; which touch, (n,)."""
        own = drive.place
        stop = self._robot.hand_closed[own]
        direction = np.sign(stop - self._robot.hand_open[own])
        touching = np.zeros(len(hand), dtype=np.bool_)
        moving = np.arange(len(hand))
        for _ in range(_MAX_STEPS):
            gaps = self._distances(T_object_tool[moving], hand[moving], drive)
            distance = gaps.min(axis=1)
            near = distance <= CONTACT_DISTANCE
            touching[moving[near]] = _all_touch(gaps[near])
            ahead = (distance - CONTACT_DISTANCE / 2) / drive.top_speed
            missed = ~near & (ahead >= np.abs(stop - hand[moving, own]))
            hand[moving[missed], own] = stop
            on = ~near & ~missed
            hand[moving[on], own] += direction * ahead[on]
            self._fingers.move(hand, moving[~near], drive)
            moving = moving[on]
            if len(moving) == 0:
                break
        return touching

    def _distances(self, T_object_tool: Array, hand: Array, drive: Drive) -> Array:
        """Distances (n, fingers) of the fingers of one drive to the object."""
        gaps = np.full((len(hand), len(drive.fingers)), np.inf)
        for column, finger in enumerate(drive.fingers.values()):
            for geometry, T in self._fingers.placed(T_object_tool, hand, finger):
                nearest = self._object.nearest(geometry, T)
                gaps[:, column] = np.minimum(gaps[:, column], nearest)
        return gaps


def _all_touch(gaps: Array) -> npt.NDArray[np.bool_]:
    """Whether all fingers of a drive that has come to contact touch, (n,)."""
    inside = (gaps <= 0.0).any(axis=1)
    return np.asarray(~inside & (gaps <= TOGETHER).all(axis=1))
