"""Which pairs of links are disabled, against what is known of a robot."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from mmplan.robot import Robot
from mmplan.robot_build import load_robot
from mmplan.robot_setup.adjacency import neighbours
from mmplan.robot_setup.configurations import draw
from mmplan.robot_setup.disabled_pairs import LEAST_DISTANCE, disabled_pairs
from mmplan.robot_setup.evidence import Evidence, gather, smallest_distance
from mmplan.robot_setup.self_collisions import SelfCollisions

SAMPLES = 1500


@cache
def puma() -> tuple[Robot, SelfCollisions, dict[tuple[str, str], Evidence]]:
    robot = load_robot("puma_mobile")
    links = SelfCollisions(robot)
    return robot, links, dict(gather(robot, links, SAMPLES))


def test_every_pair_that_moves_is_looked_at_once() -> None:
    robot, links, evidence = puma()
    names = {robot.link_of(g) for g in robot.geometry.geometryObjects}
    assert len(links.pairs) == len(names) * (len(names) - 1) // 2
    assert set(evidence) == set(links.pairs)


def test_overlaps_are_negative_distances() -> None:
    robot, links, _ = puma()
    q = draw(robot, 60, np.random.default_rng(3))
    overlaps = links.overlaps(q)
    assert 0.1 < overlaps.mean() < 0.9
    for row, found in zip(q, overlaps, strict=True):
        for pair, overlap in zip(links.pairs, found, strict=True):
            assert (links.distance(row, pair) <= 0.0) == overlap


def test_only_what_is_asked_for_is_checked() -> None:
    robot, links, _ = puma()
    q = draw(robot, 40, np.random.default_rng(4))
    asked = np.arange(len(links.pairs)) % 2 == 0
    np.testing.assert_array_equal(links.overlaps(q, asked), links.overlaps(q) & asked)


def test_the_search_gets_nearer_than_samples() -> None:
    robot, links, _ = puma()
    q = draw(robot, 20, np.random.default_rng(5))
    for pair in (("shoulder", "finger_left"), ("forearm", "hand")):
        sampled = min(links.distance(row, pair) for row in q)
        assert smallest_distance(robot, links, pair, q) < sampled - 1e-3


def test_the_search_finds_a_touch_that_samples_miss() -> None:
    robot, links, _ = puma()
    pair = ("finger_left", "finger_right")  # they meet only where both are closed
    q = draw(robot, 20, np.random.default_rng(5))
    assert min(links.distance(row, pair) for row in q) > 0.0
    assert smallest_distance(robot, links, pair, q) <= 0.0


def test_pairs_disabled_by_hand_are_found() -> None:
    """The Puma's own list was made from the exact geometry of its links."""
    robot, links, evidence = puma()
    found = {frozenset(pair[:2]): pair.reason for pair in disabled_pairs(*puma())}
    checked = {
        frozenset(
            robot.link_of(robot.geometry.geometryObjects[k])
            for k in (pair.first, pair.second)
        )
        for pair in robot.geometry.collisionPairs
    }
    everything = {frozenset(pair) for pair in links.pairs}
    by_hand = everything - checked
    # a quarter of a millimetre is not enough for samples to be sure
    assert by_hand - set(found) == {frozenset({"wrist_roll", "hand"})}
    assert not set(found) - by_hand
    for pair, reason in found.items():
        if reason.startswith("never"):
            key = next(p for p in links.pairs if set(p) == pair)
            assert evidence[key].distance >= LEAST_DISTANCE
    assert found[frozenset({"upper_arm", "forearm"})] == "adjacent"
    meet = found[frozenset({"finger_left", "finger_right"})]
    assert meet.startswith("fingers or palm")


def test_neighbours_of_the_puma() -> None:
    chain = ("base", "shoulder", "upper_arm", "forearm", "wrist_roll", "wrist_pitch")
    along = {frozenset(pair) for pair in pairwise(chain)}
    hand = {frozenset(("hand", f"finger_{side}")) for side in ("left", "right")}
    wrist = {frozenset(("wrist_pitch", "hand"))}
    assert neighbours(puma()[0]) == along | hand | wrist


@pytest.mark.parametrize(
    ("evidence", "at_rest", "starts"),
    [
        (Evidence(100, 1.0, 0.0), False, "always"),
        (Evidence(100, 0.7, 0.0), True, "default"),
        (Evidence(100, 0.7, 0.0), False, None),
        (Evidence(100, 0.2, 0.0), True, None),
        (Evidence(100, 0.0, 0.05), False, "never: no nearer than 50 mm in 100 samples"),
        (Evidence(100, 0.0, 0.001), False, None),
    ],
)
def test_reasons(evidence: Evidence, at_rest: bool, starts: str | None) -> None:
    robot, links, _ = puma()
    pair = ("base", "wrist_pitch")  # no neighbours, no fingers

    class Overlapping:
        pairs = links.pairs

        def overlaps(self, q: np.ndarray) -> np.ndarray:
            return np.full((len(q), len(self.pairs)), at_rest)

    every = dict.fromkeys(links.pairs, evidence)
    found = disabled_pairs(robot, Overlapping(), every)  # type: ignore[arg-type]
    reasons = {tuple(p[:2]): p.reason for p in found}
    reason = reasons.get(pair)
    assert reason is None if starts is None else (reason or "").startswith(starts)


def test_an_srdf_is_followed() -> None:
    robot, links, evidence = puma()
    given = [("wrist_pitch", "base", "Never")]
    found = disabled_pairs(robot, links, evidence, given)
    assert ("base", "wrist_pitch", "SRDF: never") in [tuple(pair) for pair in found]


def test_the_same_seed_gives_the_same() -> None:
    robot, links, _ = puma()
    assert gather(robot, links, 300) == gather(robot, links, 300)
