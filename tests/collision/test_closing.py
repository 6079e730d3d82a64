"""The hand closes until each finger touches, and never goes farther."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mmplan.collision import Closings, CollisionWorld, HandCloser, Scenery
from mmplan.collision.closing import CONTACT_DISTANCE, LEAST_SHARE, OPENING_SHARE
from mmplan.collision.separation import signed_distance, transform
from mmplan.kinematics import joint_placements
from mmplan.problem import Object
from mmplan.shapes import Array, Box, Capsule, Cone, Revolve, Shape, Sphere
from tests.collision.worlds import SCENES, among, scene
from tests.honest import puma, shift

SHAPES: dict[str, Shape] = {
    "ball": Sphere(0.02),
    "bar": Box((0.02, 0.03, 0.2)),
    "rod": Capsule(0.01, 0.1),
    "hat": Cone(0.03, 0.08),
    **{name: scene(name).objects[0].shape for name in SCENES},
}
ROUNDING = 3e-6  # m, of coal's distances at contact


@cache
def closer(name: str) -> HandCloser:
    item = Object(name, SHAPES[name], np.eye(4))
    return HandCloser(puma(), Scenery.solids_of_object(item))


def close(shape: Shape, *T_object_tool: Array) -> Closings:
    solids = Scenery.solids_of_object(Object("thing", shape, np.eye(4)))
    return HandCloser(puma(), solids).close(np.array(T_object_tool))


@cache
def standing(name: str) -> CollisionWorld:
    return among(Object(name, SHAPES[name], np.eye(4)))


def finger_distances(name: str, T_object_tool: Array, hand: Array) -> Array:
    """Signed distances (fingers,) to the object, over all pairs of bodies."""
    robot = puma()
    q = robot.q_neutral.copy()
    q[robot.hand.indices] = hand
    T_world_object = robot.tool_pose(q) @ np.linalg.inv(T_object_tool)
    T_world_joint = joint_placements(robot.model, q[None])[0]
    distances = dict.fromkeys(robot.hand.names, np.inf)
    for body in robot.geometry.geometryObjects:
        link = robot.link_of(body)
        if link not in distances:
            continue
        pose = transform(T_world_joint[body.parentJoint] @ body.placement.homogeneous)
        for solid in standing(name).scenery.objects[name]:
            other = transform(T_world_object @ solid.placement)
            found = signed_distance(body.geometry, pose, solid.geometry, other)
            distances[link] = min(distances[link], found)
    return np.array(list(distances.values()))


def random_grasp(seed: int) -> Array:
    """A tool pose whose target point is within 3 cm of the middle of the object."""
    rng = np.random.default_rng(seed)
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    T = shift(*rng.uniform(-0.03, 0.03, 3))
    T[:3, :3] = rotation * np.linalg.det(rotation)
    return T


@pytest.mark.parametrize("name", SHAPES)
@settings(max_examples=20)
@given(seed=st.integers(0, 10_000))
def test_fingers_touch_and_never_overlap(name: str, seed: int) -> None:
    robot, T_object_tool = puma(), random_grasp(seed)
    closing = closer(name).close(T_object_tool[None])
    at_first = finger_distances(name, T_object_tool, robot.hand_open)
    at_last = finger_distances(name, T_object_tool, closing.closed[0])
    clear = at_first > CONTACT_DISTANCE
    assert np.all(at_last[clear] > 0.0)
    near = (at_last > 0.0) & (at_last <= CONTACT_DISTANCE + ROUNDING)
    if clear.all():
        assert closing.touches[0] == near.all()
    assert near.all() or not closing.touches[0]
    # A finger that does not touch has met nothing all the way, or is in the object.
    for finger in np.flatnonzero(~near):
        ends = [robot.hand_closed[finger]]
        if at_first[finger] <= 0.0:
            ends.append(robot.hand_open[finger])
        assert closing.closed[0, finger] in ends


@pytest.mark.parametrize("name", SHAPES)
def test_nothing_is_in_the_way_of_a_hand_that_closes(name: str) -> None:
    grasps = np.array([random_grasp(seed) for seed in range(60)])
    opened, closed, touches = closer(name).close(grasps)
    assert touches.any()
    for row in np.flatnonzero(touches):
        for share in (0.0, 0.3, 0.7):
            hand = opened[row] + share * (closed - opened)[row]
            assert np.all(finger_distances(name, grasps[row], hand) > 0.0)


@pytest.mark.parametrize("name", SHAPES)
@settings(max_examples=20)
@given(seed=st.integers(0, 10_000))
def test_before_closing_the_hand_is_a_little_more_open(name: str, seed: int) -> None:
    robot = puma()
    opened, closed, touches = closer(name).close(random_grasp(seed)[None])
    assert np.all((closed <= opened) & (opened <= robot.hand_open))
    stroke = robot.hand_open - robot.hand_closed
    most = np.minimum(closed + OPENING_SHARE * stroke, robot.hand_open)
    free = finger_distances(name, random_grasp(seed), robot.hand_open) > 0.0
    np.testing.assert_allclose(opened[0, free], most[0, free])
    assert np.all(opened <= most + 1e-12)
    tight = opened - closed < LEAST_SHARE * stroke - 1e-12
    assert not touches[0] or not tight[0, ~free].any()


@pytest.mark.parametrize("name", SHAPES)
def test_a_batch_is_the_same_as_its_rows(name: str) -> None:
    grasps = np.array([random_grasp(seed) for seed in range(12)])
    together = closer(name).close(grasps)
    assert together.touches.shape == (12,)
    for row, T in enumerate(grasps):
        alone = closer(name).close(T[None])
        np.testing.assert_allclose(alone.opened[0], together.opened[row], atol=1e-12)
        np.testing.assert_allclose(alone.closed[0], together.closed[row], atol=1e-12)
        assert alone.touches[0] == together.touches[row]


@pytest.mark.parametrize("half", [0.005, 0.02, 0.04, 0.0498])
def test_fingers_stop_at_the_sides_of_a_box(half: float) -> None:
    _, closed, touches = close(Box((0.03, 2 * half, 0.03)), np.eye(4))
    assert touches[0]
    np.testing.assert_allclose(closed[0], half, atol=CONTACT_DISTANCE)
    assert np.all(closed[0] > half)


def test_something_wider_than_the_hand_is_not_touched() -> None:
    _, closed, touches = close(Box((0.03, 0.11, 0.03)), np.eye(4))
    assert not touches[0]
    np.testing.assert_array_equal(closed[0], puma().hand_open)


def test_nothing_between_the_fingers_is_not_touched() -> None:
    for aside in (shift(0.1, 0, 0), shift(0, 0, -0.1), shift(0, 0.2, 0)):
        opened, closed, touches = close(Sphere(0.02), aside)
        assert not touches[0]
        np.testing.assert_array_equal(closed[0], puma().hand_closed)
        assert np.all(opened[0] > closed[0])


@pytest.mark.parametrize("aside", [-0.019, -0.005, 0.0, 0.01])
def test_each_finger_stops_by_itself(aside: float) -> None:
    """The tool's y is the closing direction; the left finger comes from its + side."""
    _, closed, touches = close(Box((0.03, 0.04, 0.03)), shift(0.0, aside, 0.0))
    assert touches[0]
    expected = [0.02 - aside, 0.02 + aside]
    np.testing.assert_allclose(closed[0], expected, atol=CONTACT_DISTANCE)


def test_one_finger_alone_does_not_hold() -> None:
    """A sheet all on the left of the hand's middle: the right finger passes it by."""
    _, closed, touches = close(Box((0.03, 0.01, 0.03)), shift(0.0, -0.03, 0.0))
    assert not touches[0]
    np.testing.assert_allclose(closed[0], [0.035, 0.0], atol=CONTACT_DISTANCE)


def test_what_fills_the_hand_however_narrow_is_not_touched() -> None:
    _, closed, touches = close(Box((0.1, 0.2, 0.1)), np.eye(4))
    assert not touches[0]
    np.testing.assert_array_equal(closed[0], puma().hand_open)


@pytest.mark.parametrize("wide", [0.052, 0.06])
def test_a_wall_is_pinched_where_the_hand_does_not_fit_in_fully_open(
    wide: float,
) -> None:
    """A pipe, from above: one finger in it, where there is no room for its stroke."""
    inside, outside = wide / 2 - 0.004, wide / 2
    profile = [[inside, 0.0], [outside, 0.0], [outside, 0.1], [inside, 0.1]]
    T = shift(0.0, (inside + outside) / 2, 0.095)
    T[:3, :3] = np.diag([1.0, -1.0, -1.0])
    opened, closed, touches = close(Revolve(np.array(profile)), T)
    assert touches[0]
    # Flat fingers touch the hollow side with their edges.
    assert np.all((closed[0] > 0.002) & (closed[0] < 0.005))
    # Fingers are 8 mm thick, and wide: that is more than they need on a hollow side.
    assert closed[0, 0] < opened[0, 0] < 2 * inside - 0.008
    np.testing.assert_allclose(opened[0, 1], closed[0, 1] + 0.01)
