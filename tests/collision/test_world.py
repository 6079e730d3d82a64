"""Worlds are values: what stands where, who may touch whom, and how deep."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.collision import TOUCH_TOLERANCE, CollisionWorld
from mmplan.problem import Object, Obstacle
from mmplan.shapes import Array, Box, Capsule, Cylinder, Shape, Sphere
from tests.collision.worlds import among, carrying, held_at, q_tucked
from tests.honest import puma, shift

FAR = shift(3.0, 0.0, 0.5)  # where the tucked robot is not
FINGERS = {"finger_left", "finger_right"}


def touched(world: CollisionWorld, q: Array) -> set[frozenset[str]]:
    return {frozenset(c[:2]) for c in world.contacts(q)}


def with_ball(radius: float = 0.02) -> CollisionWorld:
    return among(Object("ball", Sphere(radius), FAR))


def at_tool(z: float, radius: float = 0.02) -> tuple[CollisionWorld, Array]:
    """A ball standing on the axis of the hand of the tucked robot, z from the tool."""
    q = q_tucked()
    T = puma().tool_pose(q) @ shift(0.0, 0.0, z)
    return with_ball(radius).place("ball", T), q


def test_the_tucked_robot_is_free() -> None:
    assert with_ball().contacts(q_tucked()) == ()


def test_placing_makes_another_world_and_leaves_the_old_one() -> None:
    world, q = with_ball(), q_tucked()
    assert not world.any_collision(q[None])
    moved = world.place("ball", shift(0.0, 0.0, 0.2))
    assert moved.contacts(q)[0][:2] == ("base", "ball")
    assert world.contacts(q) == ()
    np.testing.assert_array_equal(world.standing["ball"], FAR)
    np.testing.assert_array_equal(moved.object_pose("ball", q), shift(0.0, 0.0, 0.2))


def test_poses_that_are_kept_cannot_be_written_to() -> None:
    T = shift(0.0, 0.0, 0.2)
    moved = with_ball().place("ball", T)
    T[0, 3] = 9.0
    assert moved.standing["ball"][0, 3] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        moved.standing["ball"][0, 3] = 1.0


def test_attaching_takes_the_object_from_where_it_stood() -> None:
    world, q = with_ball(), q_tucked()
    placed = world.place("ball", shift(0.0, 0.0, 0.2))
    held = placed.attach("ball", np.eye(4))
    assert "ball" not in held.standing
    assert "ball" not in placed.attached
    assert held.contacts(q) == ()
    assert placed.any_collision(q[None])
    put_down = held.place("ball", FAR)
    assert "ball" not in put_down.attached
    np.testing.assert_array_equal(put_down.standing["ball"], FAR)


def test_a_world_without_an_object_knows_nothing_of_it() -> None:
    placed = with_ball().place("ball", shift(0.0, 0.0, 0.2))
    for gone in (
        placed.without("ball"),
        with_ball().attach("ball", FAR).without("ball"),
    ):
        assert not gone.any_collision(q_tucked()[None])
        assert not gone.standing
        assert not gone.attached
        assert "ball" not in {body.owner for body in gone.bodies}
    assert placed.any_collision(q_tucked()[None])


@pytest.mark.parametrize("name", ["wineglass", "plate"])
def test_a_carried_object_goes_where_the_tool_goes(name: str) -> None:
    world = carrying(name, "attached")
    rng = np.random.default_rng(0)
    for _ in range(5):
        q = q_tucked() + rng.uniform(-0.3, 0.3, world.model.nq)
        expected = world.robot.tool_pose(q) @ world.attached[name]
        np.testing.assert_allclose(world.object_pose(name, q), expected)


def test_a_carried_object_meets_what_the_robot_would_miss() -> None:
    post = Obstacle("post", Sphere(0.05), shift(2.0, 0.0, 2.0))
    world = among(post, Object("stick", Cylinder(0.01, 1.0), FAR))
    q = q_tucked()
    held = held_at(world, "stick", q, shift(2.0, 0.0, 1.5))
    assert world.contacts(q) == ()
    assert touched(held, q) == {frozenset({"stick", "post"})}
    moved_on = q_tucked(0.0, 0.5)  # and the stick with the hand
    assert held.contacts(moved_on) == ()


def test_a_carried_object_meets_the_robot_that_carries_it() -> None:
    q = q_tucked()
    held = held_at(with_ball(), "ball", q, shift(0.0, 0.0, 0.2))
    assert touched(held, q) == {frozenset({"ball", "base"})}
    # Whatever else the robot does, the hand keeps what is in it out of the palm.
    in_palm = with_ball().attach("ball", shift(0.0, 0.0, -0.1))
    assert in_palm.contacts(q) == ()  # rigid with the hand: never checked
    assert with_ball().place("ball", FAR).contacts(q) == ()


def test_objects_standing_and_carried_meet() -> None:
    q = q_tucked()
    world = among(Object("ball", Sphere(0.02), FAR), Object("box", Box((1, 1, 1)), FAR))
    held = held_at(world, "ball", q, FAR)
    assert touched(held, q) == {frozenset({"ball", "box"})}


def test_things_that_stand_still_are_not_checked_among_themselves() -> None:
    wall = Obstacle("wall", Box((1, 1, 1)), FAR)
    both = [Object(name, Sphere(0.1), FAR) for name in ("ball", "globe")]
    assert among(wall, *both).contacts(q_tucked()) == ()


# Base and ground


def test_the_base_may_touch_the_ground_and_the_arm_may_not() -> None:
    q = q_tucked()
    slab = Box((8.0, 8.0, 2.0))  # up to 1 m: the base is in it and so is the shoulder
    ground = among(Obstacle("ground", slab, np.eye(4), ground=True))
    links = {c.first for c in ground.contacts(q)}
    assert "base" not in links
    assert "shoulder" in links
    solid = among(Obstacle("block", slab, np.eye(4)))
    assert "base" in {c.first for c in solid.contacts(q)}


def test_a_carried_object_may_not_touch_the_ground() -> None:
    ground = Obstacle("ground", Box((8, 8, 0.1)), shift(0, 0, -0.05), ground=True)
    world = among(ground, Object("ball", Sphere(0.02), FAR))
    q = q_tucked()
    held = held_at(world, "ball", q, shift(3.0, 0.0, 0.01))
    assert touched(held, q) == {frozenset({"ball", "ground"})}


def test_the_base_alone_is_checked_alone() -> None:
    world, q = at_tool(0.0)
    low = Obstacle("low", Box((0.1, 0.1, 0.1)), shift(0.3, 0.0, 0.1))
    assert not world.base_alone().any_collision(q[None])
    with_low = among(low, Object("ball", Sphere(0.02), FAR)).base_alone()
    assert touched(with_low, q) == {frozenset({"base", "low"})}


# Fingers and object


def test_fingers_may_touch_what_they_may_touch() -> None:
    world, q = at_tool(0.0, radius=0.06)  # wider than the hand: in both fingers
    assert {c.first for c in world.contacts(q)} >= FINGERS
    permitted = world.permit_touch("ball", fingers=True)
    assert not FINGERS & {c.first for c in permitted.contacts(q)}
    again = permitted.forbid_touch("ball")
    assert again.contacts(q) == world.contacts(q)


def test_the_palm_may_not_touch_what_the_fingers_may() -> None:
    world, q = at_tool(-0.08)
    permitted = world.permit_touch("ball", fingers=True)
    assert touched(permitted, q) == {frozenset({"hand", "ball"})}


def test_what_is_carried_is_touched_until_it_is_put_down() -> None:
    _, q = at_tool(0.0)
    T_world_ball = puma().tool_pose(q)
    held = with_ball(0.06).attach("ball", np.eye(4))
    assert not FINGERS & {n for pair in touched(held, q) for n in pair}
    strict = held.forbid_touch("ball")
    assert {n for pair in touched(strict, q) for n in pair} >= FINGERS
    put_down = held.place("ball", T_world_ball)
    assert {n for pair in touched(put_down, q) for n in pair} >= FINGERS


def test_touching_one_object_does_not_permit_another() -> None:
    q = q_tucked()
    T = puma().tool_pose(q)
    balls = [Object(name, Sphere(0.06), T) for name in ("ball", "globe")]
    world = among(*balls).permit_touch("ball", fingers=True)
    fingered = {c.second for c in world.contacts(q) if c.first in FINGERS}
    assert fingered == {"globe"}


# Object and support

BOX = Box((0.1, 0.1, 0.1))
TABLE = Obstacle("table", Box((1.0, 1.0, 0.5)), shift(3.0, 0.0, 0.25))
SHELF = Obstacle("shelf", Box((1.0, 1.0, 0.5)), shift(3.0, 0.0, 0.25))


def on_table(depth: float, shape: Shape = BOX, half: float = 0.05) -> CollisionWorld:
    """A carried object `depth` (m) deep in the table that it may touch by 1 mm."""
    world = among(TABLE, Object("cup", shape, FAR))
    T = shift(3.0, 0.0, 0.5 + half - depth)
    held = held_at(world, "cup", q_tucked(), T)
    return held.permit_touch("cup", supports={"table": TOUCH_TOLERANCE})


SHAPES = {
    "box": (BOX, 0.05),
    "sphere": (Sphere(0.05), 0.05),
    "cylinder": (Cylinder(0.03, 0.1), 0.05),
    "capsule": (Capsule(0.03, 0.1), 0.08),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    ("depth", "collides"),
    [
        (-0.01, False),
        (-0.0001, False),
        (0.0, False),
        (0.0005, False),
        (0.00099, False),
        (0.00101, True),
        (0.003, True),
        (0.03, True),
        (0.09, True),
    ],
)
def test_a_support_is_pressed_down_to_the_stated_depth_and_not_deeper(
    shape: str, depth: float, collides: bool
) -> None:
    world = on_table(depth, *SHAPES[shape])
    assert world.any_collision(q_tucked()[None]) == collides


def test_without_permission_the_least_overlap_is_a_collision() -> None:
    for depth, collides in ((-1e-5, False), (1e-5, True)):
        held = on_table(depth).forbid_touch("cup").permit_touch("cup", fingers=True)
        assert held.any_collision(q_tucked()[None]) == collides


def test_a_depth_is_allowed_for_the_support_that_is_named_alone() -> None:
    world = among(TABLE, SHELF, Object("cup", BOX, FAR))
    held = held_at(world, "cup", q_tucked(), shift(3.0, 0.0, 0.5495))
    permitted = held.permit_touch("cup", supports={"table": TOUCH_TOLERANCE})
    assert touched(permitted, q_tucked()) == {frozenset({"cup", "shelf"})}
    both = permitted.permit_touch("cup", supports={"shelf": TOUCH_TOLERANCE})
    assert both.contacts(q_tucked()) == ()


def test_a_depth_is_not_allowed_for_the_robot() -> None:
    q = q_tucked()
    wall = Obstacle("wall", Box((0.1, 1, 1)), shift(0.28 + 0.05 - 0.0005, 0, 0.2))
    world = among(wall, Object("cup", BOX, FAR))
    world = world.permit_touch("cup", supports={"wall": TOUCH_TOLERANCE})
    assert touched(world, q) == {frozenset({"base", "wall"})}


@pytest.mark.parametrize("height", np.linspace(-0.04, 0.04, 5))
def test_depth_is_the_way_out_however_thin_the_support(height: float) -> None:
    """A sheet of half a millimetre somewhere in a box is deeper than it is thick."""
    sheet = Obstacle("sheet", Box((1, 1, 0.0005)), shift(3.0, 0.0, 0.5 + height))
    world = among(sheet, Object("cup", BOX, FAR))
    held = held_at(world, "cup", q_tucked(), shift(3.0, 0.0, 0.5))
    permitted = held.permit_touch("cup", supports={"sheet": TOUCH_TOLERANCE})
    (contact,) = permitted.contacts(q_tucked())
    assert contact.depth == pytest.approx(0.05 + 0.00025 - abs(height), abs=1e-6)


@pytest.mark.parametrize("height", np.linspace(-0.0002, 0.0002, 5))
def test_thin_things_do_not_pass_through_each_other(height: float) -> None:
    """A disc and a sheet that overlap by less than the tolerance, one in the other."""
    sheet = Obstacle("sheet", Box((1, 1, 0.0005)), shift(3.0, 0.0, 0.5))
    world = among(sheet, Object("disc", Cylinder(0.1, 0.0004), FAR))
    for z, collides in ((0.5 + height, True), (0.5004, False)):
        held = held_at(world, "disc", q_tucked(), shift(3.0, 0.0, z))
        permitted = held.permit_touch("disc", supports={"sheet": TOUCH_TOLERANCE})
        assert permitted.any_collision(q_tucked()[None]) == collides


def test_contacts_name_the_deepest_overlap_first() -> None:
    world = among(
        Obstacle("near", Sphere(0.05), shift(0.3, 0.0, 0.2)),
        Obstacle("far", Sphere(0.05), shift(-0.32, 0.0, 0.2)),
    )
    first, second = world.contacts(q_tucked())
    assert (first.first, first.second) == ("base", "near")
    assert first.depth == pytest.approx(0.03, abs=1e-6)
    assert (second.first, second.second) == ("base", "far")
    assert second.depth == pytest.approx(0.01, abs=1e-6)


def test_every_geometry_belongs_to_something_with_a_name() -> None:
    world = carrying("wineglass", "attached")
    owners = {world.owner_of(i) for i in range(len(world.bodies))}
    assert {"forearm", "counter", "dishwasher/lower_rack", "wineglass"} <= owners
    assert len(world.bodies) == world.geometry.ngeoms
    assert len(world.pairs) == len(world.allowed_depth)
    pairs = [(p.first, p.second) for p in world.geometry.collisionPairs]
    np.testing.assert_array_equal(world.pairs, pairs)
