from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.hermite import HermiteCurve
from mmplan.planning import (
    PathChecker,
    TimingSettings,
    motion_limits,
    plan_path,
    time_path,
    transit_joints,
)
from mmplan.planning.blending import blend_sizes, smooth_curves
from mmplan.planning.sweep import sweep_of
from mmplan.planning.toppra_speeds import fastest_speeds

RESOLUTION = 0.02
CORNER = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [1.0, 1.0, 1.5]])


def assert_within_limits(motion, limits):
    """By the derivatives of each cubic at its ends and where they are extreme."""
    step = np.diff(motion.times)[:, None]
    slope = np.diff(motion.positions, axis=0) / step
    v0, v1 = motion.velocities[:-1], motion.velocities[1:]
    c2 = (3 * slope - 2 * v0 - v1) / step
    c3 = (v0 + v1 - 2 * slope) / step**2
    for s in (step * 0.0, step):
        assert np.all(np.abs(2 * c2 + 6 * c3 * s) <= limits.acceleration * (1 + 1e-9))
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.clip(np.nan_to_num(-c2 / (3 * c3)), 0.0, step)
    for s in (step * 0.0, turn, step):
        speed = np.abs(v0 + 2 * c2 * s + 3 * c3 * s**2)
        assert np.all(speed <= limits.velocity * (1 + 1e-9))


def assert_a_motion(motion, path, limits):
    assert motion.times[0] == 0.0
    assert np.all(np.diff(motion.times) > 0.0)
    assert np.all(motion.velocities[[0, -1]] == 0.0)
    assert motion.positions[0] == pytest.approx(path[0], abs=1e-12)
    assert motion.positions[-1] == pytest.approx(path[-1], abs=1e-9)
    assert_within_limits(motion, limits)


def distance_to_polyline(q, path, sweep):
    """How far each q (n, 3) is from the nearest of many points of a polyline."""
    t = np.linspace(0.0, 1.0, 400)[:, None]
    points = np.vstack([a + t * (b - a) for a, b in pairwise(path)])
    return sweep.distance(q[:, None] - points[None]).min(axis=1)


waypoints = st.lists(
    st.tuples(*[st.floats(-1.5, 1.5, allow_subnormal=False)] * 3),
    min_size=2,
    max_size=7,
).filter(lambda p: np.abs(np.diff(p, axis=0)).max() > 1e-6)


@given(path=waypoints)
def test_any_polyline_becomes_a_motion_within_limits(
    path, stick_world_class, stick_limits
):
    path = np.array(path)
    world = stick_world_class.among()
    result = time_path(world, path, stick_limits, RESOLUTION)
    assert result.motion is not None
    assert_a_motion(result.motion, path, stick_limits)


@pytest.mark.parametrize("blend", [0.02, 0.1, 0.3])
def test_the_motion_stays_as_near_to_the_path_as_asked(
    stick_among, stick_limits, blend
):
    settings = TimingSettings(blend=blend)
    world = stick_among()
    result = time_path(world, CORNER, stick_limits, RESOLUTION, settings)
    motion = result.motion
    q = HermiteCurve(motion.times, motion.positions, motion.velocities).positions(
        np.linspace(0.0, motion.duration, 300)
    )
    off = distance_to_polyline(q, CORNER, sweep_of(world))
    # 5 mm for the spacing of the points that the polyline is compared by.
    assert off.max() <= blend + settings.deviation + 0.005
    assert off.max() >= blend / 4


def test_larger_blends_are_faster(stick_among, stick_limits):
    durations = [
        time_path(
            stick_among(), CORNER, stick_limits, RESOLUTION, TimingSettings(blend=blend)
        ).motion.duration
        for blend in (0.01, 0.05, 0.2)
    ]
    assert durations == sorted(durations, reverse=True)


def test_a_straight_path_takes_the_least_time_there_is(stick_among, stick_limits):
    path = np.array([[0.0, 0.0, 0.0], [1.6, 0.0, 0.0]])
    motion = time_path(stick_among(), path, stick_limits, RESOLUTION).motion
    v, a = stick_limits.velocity[0], stick_limits.acceleration[0]
    assert 1.6 / v + v / a <= motion.duration < 1.02 * (1.6 / v + v / a)


@pytest.mark.parametrize("rate", [20.0, 60.0])
def test_the_density_of_samples_is_what_was_asked(stick_among, stick_limits, rate):
    settings = TimingSettings(rate=rate)
    motion = time_path(stick_among(), CORNER, stick_limits, RESOLUTION, settings).motion
    assert 0.8 * rate < len(motion.times) / motion.duration < 1.5 * rate


def test_blends_shrink_where_it_is_narrow(stick_among):
    # The stick, pointing along y, comes along x and turns off along y.
    path = np.array([[0.0, 0.0, 1.5708], [1.0, 0.0, 1.5708], [1.0, 1.0, 1.5708]])
    # A post inside of the corner, so near that only a small blend passes it.
    narrow = stick_among(post=(0.5, 0.52, 0.97, 3.0))
    wide, tight = (
        blend_sizes(path, PathChecker(world, 0.005), 0.2)[1]
        for world in (stick_among(), narrow)
    )
    assert 0.0 < tight < wide


def test_a_motion_stops_where_a_corner_cannot_be_rounded(stick_among, stick_limits):
    path = np.array([[0.0, 0.0, 1.5708], [1.0, 0.0, 1.5708], [1.0, 1.0, 1.5708]])
    post = stick_among(post=(0.5, 0.5001, 0.9999, 3.0))
    result = time_path(post, path, stick_limits, 0.0005)
    assert result.stops == 1
    motion = result.motion
    assert_a_motion(motion, path, stick_limits)
    corner = np.abs(motion.positions - path[1]).max(axis=1) < 1e-9
    assert corner.sum() == 1
    assert np.all(motion.velocities[corner] == 0.0)


def test_a_motion_stops_where_the_path_turns_back(stick_among, stick_limits):
    path = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.001, 0.0]])
    result = time_path(stick_among(), path, stick_limits, RESOLUTION)
    assert result.stops == 1
    assert_a_motion(result.motion, path, stick_limits)


def test_a_path_in_collision_is_refused_by_name(stick_among, stick_limits):
    world = stick_among(post=(0.9, 0.4, 1.1, 0.6))
    result = time_path(world, CORNER, stick_limits, RESOLUTION)
    assert result.motion is None
    assert result.message == "the timed motion collides: stick touches post"


def test_a_path_that_does_not_move_has_no_timing(stick_among, stick_limits):
    with pytest.raises(ValueError, match="does not move"):
        time_path(stick_among(), CORNER[[0, 0]], stick_limits, RESOLUTION)


@pytest.mark.parametrize("seed", range(10))
def test_rounded_curves_have_continuous_directions(stick_among, seed):
    path = np.random.default_rng(seed).uniform(-1, 1, (6, 3))
    checker = PathChecker(stick_among(), RESOLUTION)
    sizes = blend_sizes(path, checker, 0.2)
    for curve in smooth_curves(path, sizes, checker.sweep.weights):
        joints = curve.starts[1:]
        for order in (0, 1):
            before, after = (curve(joints + d, order) for d in (-1e-9, 1e-9))
            assert before == pytest.approx(after, abs=1e-6)
        s = np.linspace(0.01, curve.length - 0.01, 50)
        numeric = (curve(s + 1e-6) - curve(s - 1e-6)) / 2e-6
        assert curve(s, 1) == pytest.approx(numeric, abs=1e-5)
    assert curve(np.array([curve.length]))[0] == pytest.approx(path[-1])


def test_the_motion_of_a_planned_path_is_free(kitchen, kitchen_world):
    q_goal = kitchen.q_start.copy()
    q_goal[kitchen.robot.base.indices] = [1.0, 0.8]
    q_goal[kitchen.robot.arm.indices] = kitchen.robot.configurations["home"]
    rng = np.random.default_rng(3)
    result = plan_path(
        kitchen_world,
        kitchen.q_start,
        q_goal,
        transit_joints(kitchen),
        kitchen.planner,
        rng,
    )
    limits = motion_limits(kitchen.robot)
    timed = time_path(kitchen_world, result.path, limits, kitchen.planner.resolution)
    motion = timed.motion
    assert_a_motion(motion, result.path, limits)
    q = motion.curve.positions(np.linspace(0.0, motion.duration, 500))
    depths = [c.depth for row in q for c in kitchen_world.contacts(row)]
    assert max(depths, default=0.0) < kitchen.planner.resolution / 2


@pytest.mark.parametrize("failures", [{1}, {1, 2, 3, 4}])
def test_a_grid_on_which_toppra_fails_is_not_the_end(
    stick_among, stick_limits, monkeypatch, failures
):
    """The first call is for the rough profile, later ones for finer grids."""
    calls = []

    def sometimes(curve, grid, limits):
        calls.append(len(grid))
        if len(calls) - 1 in failures:
            raise ArithmeticError("toppra found no time parametrization of a path")
        return fastest_speeds(curve, grid, limits)

    monkeypatch.setattr("mmplan.planning.speed_profile.fastest_speeds", sometimes)
    path = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 1.0]])
    motion = time_path(stick_among(), path, stick_limits, RESOLUTION).motion
    assert len(calls) == len(failures) + 1 + (len(failures) == 1)
    assert np.array_equal(motion.positions[[0, -1]], path)
    assert np.all(motion.fastest() <= stick_limits.velocity * (1 + 1e-9))


def test_a_path_that_toppra_cannot_time_is_a_result(
    stick_among, stick_limits, monkeypatch
):
    def never(*_):
        raise ArithmeticError("toppra found no time parametrization of a path")

    monkeypatch.setattr("mmplan.planning.speed_profile.fastest_speeds", never)
    path = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 1.0]])
    result = time_path(stick_among(), path, stick_limits, RESOLUTION)
    assert result.motion is None
    assert "toppra found no time parametrization" in result.message


def test_a_joint_that_reaches_its_limit_on_the_way_does_not_pass_it(
    stick_among, stick_limits
):
    """Corners on the limit itself, where samples alone would let it pass by a hair."""
    upper = np.array([np.inf, 0.3, np.inf])
    limits = replace(stick_limits, upper=upper)
    path = np.array(
        [[0.0, 0.29, 0.0], [0.5, 0.3, 0.5], [1.0, 0.3, 1.0], [1.5, 0.29, 1.5]]
    )
    free = time_path(stick_among(), path, stick_limits, RESOLUTION).motion
    assert free.curve.position_extremes().greatest.max(axis=0)[1] > 0.3 + 1e-9
    motion = time_path(stick_among(), path, limits, RESOLUTION).motion
    assert motion.curve.position_extremes().greatest.max(axis=0)[1] <= 0.3
    assert_within_limits(motion, stick_limits)
    assert motion.duration < 1.01 * free.duration
