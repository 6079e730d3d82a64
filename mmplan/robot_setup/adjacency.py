"""Which links of a robot are neighbours."""

from __future__ import annotations

from collections.abc import Set

import pinocchio as pin

from mmplan.robot import Robot


def neighbours(robot: Robot) -> Set[frozenset[str]]:
    """Pairs of links with bodies, one the nearest such link above the other.

    Links without bodies between the two do not count.
    """
    bodies = robot.geometry.geometryObjects
    frames = {int(body.parentFrame) for body in bodies}
    pairs = set()
    for frame in frames:
        above = robot.model.frames[frame].parentFrame
        while above and above not in frames:
            above = robot.model.frames[above].parentFrame
        if above in frames:
            pairs.add(frozenset({_link(robot, frame), _link(robot, above)}))
    return pairs


def _link(robot: Robot, frame: int) -> str:
    found: pin.Frame = robot.model.frames[frame]
    return str(found.name)
