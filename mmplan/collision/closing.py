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
# How far the fingers open beyond contact before grasping, as a share of their stroke;
# the least is for where the object leaves no room for more.
OPENING_SHARE, LEAST_SHARE = 0.2, 0.02
# Where the object is in the way of fingers that are as far open as they can be, they
# start from the widest of so many openings, evenly spaced, at which it is not.
_OPENINGS = 24
_MAX_STEPS = 60


class Closings(NamedTuple):
    """The hand on n grasps: joint values before and after it closes.

    `touches` says whether every finger touches, having been clear before.
    """

    opened: Array  # (n, hand joints)
    closed: Array  # (n, hand joints)
    touches: npt.NDArray[np.bool_]  # (n,)


class HandCloser:
    """Closes each finger of a robot's hand on one object by conservative advancement.

    A finger moves by its distance to the object over the greatest speed of its points,
    so that it stops at contact without ever passing it. It comes from as far as the
    hand opens or, where the object is in the way there, as in a bowl whose wall is
    grasped, from as far as it is not. Before it closes, the hand is open a little wider
    than at contact, and never wider than that.
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
        clear = np.tile(robot.hand_open, (n, 1))
        closed = clear.copy()
        touches = np.ones(n, dtype=np.bool_)
        for drive in self._fingers.drives:
            touches &= self._close(T_object_tool, clear, closed, drive)
        stroke = robot.hand_closed - robot.hand_open
        room = np.abs(closed - clear)
        past = np.minimum(OPENING_SHARE * np.abs(stroke), room)
        # A hand that is as far open as it can be has room, be it ever so little.
        tight = (clear != robot.hand_open) & (room < LEAST_SHARE * np.abs(stroke))
        touches &= ~tight.any(axis=1)
        return Closings(closed - np.sign(stroke) * past, closed, touches)

    def contacts(self, T_object_tool: Array, closings: Closings) -> Contacts:
        """Where the closed fingers touch at tool poses (n, 4, 4), which were closed."""
        placed = [
            self._fingers.placed(T_object_tool, closings.closed, finger)
            for drive in self._fingers.drives
            for finger in drive.fingers.values()
        ]
        return contacts_of(self._object, placed, closings.touches)

    def _close(
        self, T_object_tool: Array, clear: Array, closed: Array, drive: Drive
    ) -> npt.NDArray[np.bool_]:
        """Move one drive of n hands `closed` to contact, in place; which touch, (n,).

        Those that the object is in the way of from the first start narrower; `clear`
        is where they start, changed in place.
        """
        touching = self._advance(T_object_tool, closed, drive)
        still = closed[:, drive.place] == self._robot.hand_open[drive.place]
        blocked = np.flatnonzero(~touching & still)
        if len(blocked) > 0:
            T, moved = T_object_tool[blocked], np.array(list(drive.fingers))
            hand = closed[blocked]
            self._make_clear(T, hand, drive)
            clear[np.ix_(blocked, moved)] = hand[:, moved]
            touching[blocked] = self._advance(T, hand, drive)
            closed[blocked] = hand
        return touching

    def _make_clear(self, T_object_tool: Array, hand: Array, drive: Drive) -> None:
        """Narrow one drive of n opened hands, in place, until it is off the object.

        Left alone where the object is in the way however narrow it is.
        """
        robot, own = self._robot, drive.place
        rows = np.arange(len(hand))
        for share in np.arange(1, _OPENINGS) / _OPENINGS:
            tried = hand[rows]
            tried[:, own] += share * (robot.hand_closed - robot.hand_open)[own]
            self._fingers.move(tried, np.arange(len(rows)), drive)
            gaps = self._distances(T_object_tool[rows], tried, drive)
            off = (gaps > CONTACT_DISTANCE).all(axis=1)
            hand[rows[off]] = tried[off]
            rows = rows[~off]
            if len(rows) == 0:
                break

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
