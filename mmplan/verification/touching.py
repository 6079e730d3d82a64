"""Who may touch whom, when, and how deep.

Everything must stay apart but for three exceptions:

1. While the hand closes on the object of the task or opens around it (segments `grasp`
   and `release`), and while it carries the object, finger links and object may press
   into each other by at most `TOUCH_TOLERANCE`.
2. An object that is carried may press into what it stands on at the start of its task
   by at most `TOUCH_TOLERANCE`, while no corner of the boxes around it is farther than
   `CONTACT_ZONE` from where it was when it stood there. What it stands on are the
   obstacles and other objects whose distance or depth is at most `TOUCH_TOLERANCE`
   then. No depth is let pass beyond half the thickness of the thinner body, lest an
   object is pushed through a sheet.
3. The same for the goal of the task.

The depth of overlap of two convex bodies changes no faster than their points move, as
their distance does. So the proof treats it as a negative distance and exceptions as an
amount by which that may fall below zero. Whether a moment lies within a contact zone
changes with time: a stretch of time enjoys exception 2 or 3 only if the object cannot
leave the zone during it. A stretch across the border of the zone is held to strict
separation, and split until that is shown; only what touches at the border itself, or
beyond, fails. An object dragged along its support fails where it leaves the zone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.collision import CONTACT_ZONE, TOUCH_TOLERANCE, supports
from mmplan.replay import Stage
from mmplan.shapes import Array
from mmplan.verification.bodies import Bodies, Indices, Mask

# Segments in which the hand closes on the object or opens around it.
_HAND_MOVES = ("grasp", "release")


@dataclass(frozen=True, eq=False)
class Zone:
    """Where a carried object may touch what it rests on."""

    joint: int  # that carries the object
    corners: Array  # (k, 3), of the object, in the joint's frame
    at_rest: Array  # (k, 3), the same corners in the world when the object rests
    lever: Array  # (nq,), how far joints carry the object
    pairs: Mask  # (pairs,): object and support
    depth: Array  # (pairs,), m, how deep these may overlap

    def leeway(self, T_world_joint: Array) -> Array:
        """How much farther (m) the object may move and stay in the zone, (n,)."""
        R = T_world_joint[:, self.joint, :3, :3]
        p = T_world_joint[:, self.joint, :3, 3]
        corners = self.corners @ R.transpose(0, 2, 1) + p[:, None]
        moved = np.linalg.norm(corners - self.at_rest, axis=2)
        leeway: Array = CONTACT_ZONE - moved.max(axis=1)
        return leeway


@dataclass(frozen=True, eq=False)
class TouchRule:
    """How deep the pairs of one segment may overlap."""

    depth: Array  # (pairs,), m, at all times
    zones: tuple[Zone, ...]

    @classmethod
    def of_stage(cls, stage: Stage, bodies: Bodies) -> TouchRule:
        """The rule of a segment, for the pairs of its world."""
        item = stage.task.object
        finger = np.array(bodies.kinds) == "finger"
        gripped = _between(finger, bodies.belong_to([item]), bodies.world.pairs)
        touched = item in stage.attached or stage.segment.name in _HAND_MOVES
        depth = np.where(gripped & touched, TOUCH_TOLERANCE, 0.0)
        return cls(depth, _zones(stage, bodies) if item in stage.attached else ())

    def allowances(
        self, T_world_joint: Array, reach: Array, moment: Indices, pair: Indices
    ) -> tuple[Array, Array]:
        """How deep pairs (k,) may overlap: at moments (k,), and all around these.

        All around is as far as joints get that move by up to `reach` (n, nq) from where
        they are at the n moments, with poses `T_world_joint` (n, joints, 4, 4).
        """
        leeways = [zone.leeway(T_world_joint) for zone in self.zones]
        left = [
            leeway - reach @ zone.lever
            for leeway, zone in zip(leeways, self.zones, strict=True)
        ]
        return self._allowed(leeways, moment, pair), self._allowed(left, moment, pair)

    def _allowed(self, leeways: list[Array], moment: Indices, pair: Indices) -> Array:
        allowed = self.depth[pair]
        for zone, leeway in zip(self.zones, leeways, strict=True):
            rests = zone.pairs[pair] & (leeway >= 0.0)[moment]
            allowed = np.where(rests, zone.depth[pair], allowed)
        return allowed


def _zones(stage: Stage, bodies: Bodies) -> tuple[Zone, ...]:
    """The contact zones of the object that a segment carries: start and goal."""
    item, world = stage.task.object, bodies.world
    held, corners = bodies.belong_to([item]), bodies.corners(item)
    T_joint_object = world.robot.T_joint_tool @ stage.attached[item]
    thinner = bodies.halves.min(axis=1)[world.pairs].min(axis=1)
    zones = []
    for T_world_object in (stage.T_world_start, stage.T_world_goal):
        below = supports(
            world.scenery, item, T_world_object, TOUCH_TOLERANCE, world.standing
        )
        T_world_joint = T_world_object @ np.linalg.inv(T_joint_object)
        zones.append(
            Zone(
                joint=world.robot.tool_joint,
                corners=corners,
                at_rest=corners @ T_world_joint[:3, :3].T + T_world_joint[:3, 3],
                lever=bodies.levers[held].max(axis=0),
                pairs=_between(held, bodies.belong_to(below), world.pairs),
                depth=np.minimum(TOUCH_TOLERANCE, thinner),
            )
        )
    return tuple(zones)


def _between(a: Mask, b: Mask, pairs: Indices) -> Mask:
    """Which pairs (p, 2) have one side in `a` and the other in `b`, (p,)."""
    first, second = pairs.T
    between: Mask = (a[first] & b[second]) | (b[first] & a[second])
    return between
