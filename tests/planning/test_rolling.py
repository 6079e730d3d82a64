"""Ways of bases that roll: exact ends, shortest words, tangents, free drives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ompl import base as ob

from mmplan.planning import (
    ReedsShepp,
    TurnInPlace,
    plan_drive,
    time_drive,
)
from mmplan.planning.drive import Arc, make_drive
from mmplan.planning.joints import MotionLimits
from mmplan.planning.rolling import RollingPiece, joints_of, wrapped
from mmplan.problem import PlannerSettings

RADIUS = 0.7
BASE = np.arange(3)
BOUNDS = np.array([[-2.0, 2.0], [-2.0, 2.0], [-np.inf, np.inf]])
GAP = {"lower": (-0.05, -9.0, 0.05, 0.0), "upper": (-0.05, 0.9, 0.05, 9.0)}
SETTINGS = PlannerSettings(iterations=3000, resolution=0.02)
STEERINGS = (TurnInPlace(), ReedsShepp(RADIUS))
LIMITS = MotionLimits(np.array([0.8, 0.8, 1.5]), np.array([0.8, 0.8, 2.0]))
SEEDS = st.integers(0, 2**32 - 1)


def two_poses(seed):
    """Two poses, from far apart to almost the same."""
    rng = np.random.default_rng(seed)
    apart = 10.0 ** rng.uniform(-3, 0.5)
    start = rng.uniform([-3, -3, -9], [3, 3, 9])
    return start, start + apart * rng.uniform(-1, 1, 3) * [1, 1, np.pi]


def rolled(start, pieces, parts=50):
    """Poses all along pieces."""
    fractions = np.linspace(0.0, 1.0, parts)
    poses = zip(joints_of(pieces, start), pieces, strict=False)
    return [piece.poses(pose, fractions) for pose, piece in poses]


@pytest.mark.parametrize("steering", STEERINGS, ids=["in place", "car"])
@given(SEEDS)
def test_a_way_ends_where_it_shall(steering, seed):
    start, end = two_poses(seed)
    reached = joints_of(steering.pieces(start, end), start)[-1]
    np.testing.assert_allclose(reached[:2], end[:2], atol=1e-7)
    assert abs(wrapped(reached[2] - end[2])) < 1e-7


@pytest.mark.parametrize("steering", STEERINGS, ids=["in place", "car"])
@given(SEEDS)
def test_a_way_rolls_along_its_heading(steering, seed):
    start, end = two_poses(seed)
    for poses in rolled(start, steering.pieces(start, end)):
        middle = (poses[1:, 2] + poses[:-1, 2]) / 2.0
        way = np.diff(poses[:, :2], axis=0)
        aside = way[:, 1] * np.cos(middle) - way[:, 0] * np.sin(middle)
        assert np.abs(aside).max() < 1e-9  # exact for chords of arcs


@given(SEEDS)
def test_a_car_never_turns_tighter_than_its_radius(seed):
    start, end = two_poses(seed)
    for piece in ReedsShepp(RADIUS).pieces(start, end):
        assert RADIUS * abs(piece.turn) <= abs(piece.length) + 1e-12


@given(SEEDS)
def test_a_differential_drive_turns_or_goes_straight(seed):
    start, end = two_poses(seed)
    for piece in TurnInPlace().pieces(start, end):
        assert 0.0 in (piece.turn, piece.length)


@given(SEEDS)
def test_a_cars_way_is_as_short_as_ompls(seed):
    start, end = two_poses(seed)
    space = ob.ReedsSheppStateSpace(RADIUS)
    states = [space.allocState() for _ in range(2)]
    for state, pose in zip(states, (start, end), strict=True):
        state.setXY(float(pose[0]), float(pose[1]))
        state.setYaw(wrapped(float(pose[2])))
    pieces = ReedsShepp(RADIUS).pieces(start, end)
    length = sum(abs(piece.length) for piece in pieces)
    assert length == pytest.approx(space.distance(*states), abs=1e-6)


@given(st.floats(-3, 3), st.floats(-3, 3), SEEDS)
def test_an_arcs_derivatives_are_those_of_its_positions(length, turn, seed):
    if abs(length) < 0.05 or abs(turn) < 0.05:
        return
    q = np.random.default_rng(seed).uniform(-2, 2, 5)
    base = np.array([1, 3, 4])
    piece = RollingPiece(length, turn)
    q_end = q.copy()
    q_end[base] = piece.end(q[base])
    arc = Arc(q, q_end, base, piece)
    h = 1e-5
    s = np.linspace(2 * h, arc.length - 2 * h, 20)
    for order in (1, 2):
        slope = (arc(s + h, order - 1) - arc(s - h, order - 1)) / (2 * h)
        np.testing.assert_allclose(arc(s, order), slope, rtol=1e-6, atol=1e-6)
    ends = arc(np.array([0.0, arc.length]))
    np.testing.assert_allclose(ends, [q, q_end], atol=1e-12)


@pytest.mark.parametrize("steering", STEERINGS, ids=["in place", "car"])
@pytest.mark.parametrize("seed", range(4))
def test_a_drive_goes_round_what_is_in_the_way(stick_among, steering, seed):
    gap = stick_among(**GAP)
    rng = np.random.default_rng(seed)
    q, goal = np.array([-1.2, -0.5, 1.0]), np.array([1.3, -0.8, -2.0])
    result = plan_drive(gap, q, goal, BASE, BOUNDS, steering, SETTINGS, rng)
    assert result.drive is not None, result.message
    drive = result.drive
    assert np.array_equal(drive.path[0], q)
    np.testing.assert_allclose(drive.path[-1, :2], goal[:2], atol=1e-12)
    assert abs(wrapped(drive.path[-1, 2] - goal[2])) < 1e-9
    motion = time_drive(gap, drive, LIMITS, 0.02).motion
    t = np.arange(0.0, motion.duration, 1e-3)
    poses, v = motion.curve.positions(t), motion.curve.velocities(t)
    assert not gap.shrunk(0.01).any_collision(poses)
    slip = v[:, 1] * np.cos(poses[:, 2]) - v[:, 0] * np.sin(poses[:, 2])
    assert np.abs(slip).max() < 1e-4
    assert np.all(np.abs(v) <= LIMITS.velocity * (1 + 1e-6))


def test_there_is_a_way_out_where_there_is_no_room_to_turn(stick_among):
    """A stall as narrow as a stick: out of it one goes straight."""
    stall = stick_among(left=(-0.5, 0.02, 0.6, 0.1), right=(-0.5, -0.1, 0.6, -0.02))
    q, goal = np.zeros(3), np.array([1.2, 1.0, 2.0])
    rng = np.random.default_rng(0)
    result = plan_drive(stall, q, goal, BASE, BOUNDS, TurnInPlace(), SETTINGS, rng)
    assert result.drive is not None, result.message
    first = result.drive.pieces[0]
    assert first.turn == 0.0
    assert first.length > 0.4


def test_what_is_in_the_way_of_the_posture_is_named(stick_among):
    world = stick_among(post=(0.9, 0.9, 1.1, 1.1))
    rng = np.random.default_rng(0)
    goal = np.array([0.8, 1.0, 0.0])
    result = plan_drive(
        world, np.zeros(3), goal, BASE, BOUNDS, TurnInPlace(), SETTINGS, rng
    )
    assert result.drive is None
    assert "at the goal: stick touches post" in result.message


def test_bounds_are_kept_and_may_leave_no_way(stick_among):
    bounds = np.array([[-2.0, 2.0], [-1.0, 0.2], [-np.inf, np.inf]])
    gap = stick_among(lower=(*GAP["lower"][:3], 0.4))
    settings = PlannerSettings(iterations=60, resolution=0.02)
    for steering in STEERINGS:
        rng = np.random.default_rng(0)
        q, goal = np.array([-1.2, -0.5, 0.0]), np.array([1.3, -0.8, 0.0])
        result = plan_drive(gap, q, goal, BASE, bounds, steering, settings, rng)
        assert result.drive is None
        assert "found no way" in result.message


def test_headings_keep_to_limits_of_the_joint(stick_among):
    """The way would turn the base by half a turn beyond its limit."""
    bounds = np.vstack([BOUNDS[:2], [-0.5, 0.5]])
    rng = np.random.default_rng(0)
    q, goal = np.array([0.0, 0.0, 0.0]), np.array([0.0, 1.5, 0.0])
    result = plan_drive(
        stick_among(), q, goal, BASE, bounds, TurnInPlace(), SETTINGS, rng
    )
    assert result.drive is None
    assert "limits of its heading" in result.message


def test_a_drive_turned_is_the_same_drive():
    drive = make_drive(
        np.zeros(4), np.array([0, 1, 2]), [np.zeros(3), np.ones(3)], ReedsShepp(0.3)
    )
    turn = np.array([0.0, 0.0, 2 * np.pi, 4 * np.pi])
    np.testing.assert_allclose(drive.turned(turn).path, drive.path + turn)
