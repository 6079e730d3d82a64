"""The hand in the scene and all else are checked apart, together as the whole."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.kinematics import joint_placements
from tests.collision.worlds import SCENES, draw, shipped


@pytest.mark.parametrize("name", SCENES)
def test_the_hand_in_the_scene_and_the_rest_make_up_the_whole(name: str) -> None:
    world, q = shipped(name), draw(300, 21)
    hand, rest = world.hand_in_scene(), world.except_hand_in_scene()
    assert len(hand.pairs) + len(rest.pairs) == len(world.pairs)
    by_hand = hand.in_collision_at(joint_placements(world.model, q))
    np.testing.assert_array_equal(by_hand, hand.in_collision(q))
    np.testing.assert_array_equal(by_hand | rest.in_collision(q), world.in_collision(q))
    assert 0 < by_hand.sum() < world.in_collision(q).sum()


def test_a_rule_is_added_to_those_before_it() -> None:
    fingers = shipped("plate").fingers_alone()
    both = fingers.hand_in_scene(), fingers.except_hand_in_scene()
    assert sum(len(world.pairs) for world in both) == len(fingers.pairs)
    assert all(len(world.pairs) > 0 for world in both)
