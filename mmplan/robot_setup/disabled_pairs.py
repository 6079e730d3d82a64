"""Which pairs of links need no check for collision, and why."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from typing import NamedTuple

import numpy as np

from mmplan.robot import Robot
from mmplan.robot_setup.adjacency import neighbours
from mmplan.robot_setup.evidence import Evidence
from mmplan.robot_setup.self_collisions import LinkPair, SelfCollisions

# Links that come nearer than this stay checked: the search may have missed a touch, m.
LEAST_DISTANCE = 0.002
# Links that overlap this often where the joints are at 0 are not meant to be apart.
_OFTEN = 0.5


class DisabledPair(NamedTuple):
    """Two links that are not checked against each other, and the reason."""

    first: str
    second: str
    reason: str


def disabled_pairs(
    robot: Robot,
    links: SelfCollisions,
    evidence: Mapping[LinkPair, Evidence],
    given: Iterable[tuple[str, str, str]] = (),
) -> list[DisabledPair]:
    """The pairs to disable, in the order of the links.

    `given` are those of an SRDF, links and reason, which hold whatever is found. Of
    the others these are disabled: neighbours; links that overlap in every sample;
    links that overlap in half of the samples and with all joints at 0; fingers that
    meet each other or the palm when the hand closes or opens; and links that never come
    near each other.
    """
    said = {frozenset(pair[:2]): pair[2] for pair in given}
    beside = neighbours(robot)
    at_zero = links.overlaps(robot.q_neutral[None])[0]
    meeting = _meeting_in_hand(robot, links)
    found = []
    for k, pair in enumerate(links.pairs):
        both = frozenset(pair)
        reason: str | None
        if both in said:
            reason = f"SRDF: {said[both].lower()}"
        elif both in beside:
            reason = "adjacent"
        elif pair in meeting:
            reason = "fingers or palm, which meet when the hand closes or opens"
        else:
            reason = _reason(evidence[pair], bool(at_zero[k]))
        if reason is not None:
            found.append(DisabledPair(*pair, reason))
    return found


def _reason(evidence: Evidence, at_zero: bool) -> str | None:
    """Why samples say that a pair needs no check; None where it does."""
    if evidence.share == 1.0:
        return f"always: the bodies overlap in all of {evidence.samples} samples"
    if at_zero and evidence.share >= _OFTEN:
        percent = 100 * evidence.share
        return f"default: the bodies overlap at rest and in {percent:.0f} % of samples"
    if evidence.share == 0.0 and evidence.distance >= LEAST_DISTANCE:
        near = f"{evidence.distance * 1e3:.3g} mm"
        return (
            f"never: no nearer than {near} in {evidence.samples} samples and a search"
        )
    return None


def _meeting_in_hand(robot: Robot, links: SelfCollisions) -> Set[LinkPair]:
    """Pairs of links of the hand that overlap where it is open, or closed."""
    hand = hand_links(robot)
    q = np.tile(robot.q_neutral, (2, 1))
    q[:, robot.hand.indices] = [robot.hand_open, robot.hand_closed]
    meet = np.asarray(links.overlaps(q).any(axis=0))
    return {
        pair
        for pair, meets in zip(links.pairs, meet, strict=True)
        if meets and set(pair) <= hand
    }


def hand_links(robot: Robot) -> set[str]:
    """The fingers, and the links that do not move against the tool."""
    return {
        robot.link_of(body)
        for body in robot.geometry.geometryObjects
        if robot.kind_of(body) == "finger" or body.parentJoint == robot.tool_joint
    }
