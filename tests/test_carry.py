"""Laws of tilts and regions, and what scenes say of them."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from hypothesis import given
from hypothesis import strategies as st

from mmplan.carry import Region, Upright
from mmplan.shapes import Array

angles = st.floats(-3.0, 3.0)
lengths = st.floats(-2.0, 2.0)
points = st.tuples(lengths, lengths, lengths).map(np.array)
turns = st.tuples(angles, angles, angles).map(lambda a: pin.rpy.rpyToMatrix(*a))
directions = points.filter(lambda p: np.linalg.norm(p) > 1e-3).map(
    lambda p: p / np.linalg.norm(p)
)


def region(R: Array, p: Array) -> Region:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return Region("box", (0.4, 0.6, 1.0), T)


@given(axis=directions, yaw=angles, heading=angles, tilt=st.floats(0.0, 3.1))
def test_an_object_turned_about_a_level_axis_tilts_by_that(
    axis: Array, yaw: float, heading: float, tilt: float
) -> None:
    """However it is turned about its own axis before, or about the vertical after."""
    upright = Upright(0.1, axis)
    up = pin.Quaternion.FromTwoVectors(axis, np.array([0.0, 0.0, 1.0])).matrix()
    own = pin.AngleAxis(yaw, axis).matrix()
    level = np.array([np.cos(heading), np.sin(heading), 0.0])
    about = pin.AngleAxis(tilt, level).matrix()
    round_up = pin.AngleAxis(heading, np.array([0.0, 0.0, 1.0])).matrix()
    R = np.array([about @ up @ own, round_up @ about @ up @ own])
    assert np.allclose(upright.tilts(R), tilt, atol=1e-6)


@given(R=turns, p=points, local=points)
def test_depth_in_a_region_is_that_to_the_nearest_face(
    R: Array, p: Array, local: Array
) -> None:
    depth = region(R, p).depths((R @ local + p)[None])[0]
    half = np.array([0.2, 0.3, 0.5])
    assert np.isclose(depth, (half - np.abs(local)).min(), atol=1e-9)


@given(R=turns, p=points, a=points, b=points)
def test_depth_changes_no_faster_than_the_point_moves(
    R: Array, p: Array, a: Array, b: Array
) -> None:
    depths = region(R, p).depths(np.array([a, b]))
    assert abs(depths[1] - depths[0]) <= np.linalg.norm(b - a) + 1e-9


def test_the_deepest_of_all_regions_counts() -> None:
    here, there = region(np.eye(3), np.zeros(3)), region(np.eye(3), np.array([3, 0, 0]))
    upright = Upright(0.1, np.array([0.0, 0.0, 1.0]), (here, there))
    depths = upright.depths(np.array([[0.0, 0, 0], [3.0, 0, 0], [1.5, 0, 0]]))
    assert np.allclose(depths, [0.2, 0.2, -1.3])
    assert Upright(0.1, np.array([0.0, 0.0, 1.0])).depths(np.zeros((1, 3))) == -np.inf
