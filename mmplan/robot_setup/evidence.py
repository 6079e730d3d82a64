"""What random configurations say about pairs of links: how often and how near."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from mmplan.robot import Robot
from mmplan.robot_setup.configurations import draw
from mmplan.robot_setup.self_collisions import LinkPair, SelfCollisions
from mmplan.shapes import Array

SAMPLES = 10_000
_FIRST = 1000  # samples that all pairs are checked in, to say how often they overlap
_STARTS, _STEPS = 4, 50  # of the search for the smallest distance
_SHRINK = 0.9  # of its steps, each by each
_LOOKED_AT = 60  # samples that the search may start from


class Evidence(NamedTuple):
    """What is known of two links.

    They overlap in a `share` of the configurations drawn: 0 in none and 1 in all of
    `samples`, in between as among the first thousand. `distance` (m) is the smallest
    that was found where they never overlap, else 0.
    """

    samples: int
    share: float
    distance: float


def gather(
    robot: Robot, links: SelfCollisions, samples: int = SAMPLES, seed: int = 0
) -> Mapping[LinkPair, Evidence]:
    """Evidence on all pairs of links; the same seed gives the same."""
    rng = np.random.default_rng(seed)
    q = draw(robot, samples, rng)
    first = links.overlaps(q[:_FIRST])
    share = first.mean(axis=0)
    open_cases = (share == 0.0) | (share == 1.0)
    rest = links.overlaps(q[_FIRST:], open_cases)
    total = np.where(open_cases, (first.sum(axis=0) + rest.sum(axis=0)) / len(q), share)
    return {
        pair: _judged(robot, links, pair, float(part), q)
        for pair, part in zip(links.pairs, total, strict=True)
    }


def _judged(
    robot: Robot, links: SelfCollisions, pair: LinkPair, share: float, q: Array
) -> Evidence:
    """The evidence on one pair; one that seems apart is driven together."""
    if share > 0.0:
        return Evidence(len(q), share, 0.0)
    distance = smallest_distance(robot, links, pair, q[:_LOOKED_AT])
    if distance <= 0.0:
        return Evidence(len(q), 1.0 / (len(q) + 1), 0.0)
    return Evidence(len(q), 0.0, distance)


def smallest_distance(
    robot: Robot, links: SelfCollisions, pair: LinkPair, q: Array
) -> float:
    """A small distance (m) of two links, found by descent from the nearest of q.

    It stops at the first overlap.
    """
    found = np.array([links.distance(row, pair) for row in q])
    rng = np.random.default_rng(0)
    reach = np.zeros(robot.model.nq)
    reach[links.joints_between(pair)] = 0.5
    lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    reach *= np.where(np.isfinite(upper - lower), upper - lower, 2.0 * np.pi)
    best = np.inf
    for start in np.argsort(found, kind="stable")[:_STARTS]:
        here, distance = q[start], float(found[start])
        for step in range(_STEPS):
            change = rng.normal(size=len(here)) * reach * _SHRINK**step
            tried = np.clip(here + change, lower, upper)
            tried = robot.with_followers(tried)
            if (nearer := links.distance(tried, pair)) < distance:
                here, distance = tried, nearer
        best = min(best, distance)
        if best <= 0.0:
            break
    return best
