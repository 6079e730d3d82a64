"""Joints without limits: edges go the short way round, paths are real curves."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.exceptions import InputError
from mmplan.planning import PathOutcome, available_planners, plan_path
from mmplan.planning.metric import Metric
from mmplan.problem import PlannerSettings
from mmplan.robot import Follower

RESOLUTION = 0.02
SETTINGS = PlannerSettings(iterations=3000, resolution=RESOLUTION, shortcuts=30)
GAP = {"lower": (-0.05, -9.0, 0.05, 0.3), "upper": (-0.05, 0.7, 0.05, 9.0)}
LEFT = np.array([-1.2, -0.5, 3.0])
RIGHT = np.array([1.2, -0.8, -2.9])
TURN = 2 * np.pi


def finely(path, parts=200):
    t = np.linspace(0.0, 1.0, parts)[:, None]
    return np.vstack([a + t * (b - a) for a, b in pairwise(path)])


@pytest.mark.parametrize("turns", [-2, 0, 3])
def test_a_straight_way_crosses_the_seam(stick_among, turning_joints, turns):
    start = np.add(LEFT, [0, 0, turns * TURN])
    rng = np.random.default_rng(0)
    result = plan_path(stick_among(), start, RIGHT, turning_joints, SETTINGS, rng)
    assert len(result.path) == 2
    assert np.array_equal(result.path[0], start)
    assert result.path[1, 2] - start[2] == pytest.approx(TURN - 5.9)
    assert np.array_equal(result.path[-1], RIGHT + result.turns)
    np.testing.assert_allclose(result.turns, [0, 0, (turns + 1) * TURN])


@pytest.mark.parametrize("name", available_planners(circles=True))
def test_paths_are_continuous_and_valid(stick_among, turning_joints, name):
    gap = stick_among(**GAP)
    goals = np.array([RIGHT, np.add(RIGHT, [0.2, 0.3, 1.0])])
    settings = replace(SETTINGS, name=name)
    start = np.add(LEFT, [0, 0, TURN])
    rng = np.random.default_rng(1)
    result = plan_path(gap, start, goals, turning_joints, settings, rng)
    assert result.outcome is PathOutcome.FOUND, result.message
    assert np.array_equal(result.path[0], start)
    assert np.array_equal(result.path[-1], goals[result.goal] + result.turns)
    assert np.array_equal(result.turns[:2], [0, 0])
    assert result.turns[2] / TURN == pytest.approx(np.rint(result.turns[2] / TURN))
    assert np.abs(np.diff(result.path[:, 2])).max() <= np.pi + 1e-9
    # Checks are RESOLUTION apart: nothing is deeper than half of that.
    assert not gap.shrunk(RESOLUTION / 2).any_collision(finely(result.path))


def test_the_same_seed_gives_the_same_path(stick_among, turning_joints):
    paths = [
        plan_path(
            stick_among(**GAP),
            LEFT,
            RIGHT,
            turning_joints,
            SETTINGS,
            np.random.default_rng(5),
        ).path
        for _ in range(2)
    ]
    assert np.array_equal(*paths)


def test_planners_without_circles_are_refused(stick_among, turning_joints):
    settings = replace(SETTINGS, name="InformedRRTstar")
    rng = np.random.default_rng(0)
    with pytest.raises(InputError, match=r"cannot plan for joints .* RRTConnect"):
        plan_path(stick_among(), LEFT, RIGHT, turning_joints, settings, rng)


@given(st.integers(0, 2**32 - 1))
def test_distances_do_not_count_turns(seed):
    rng = np.random.default_rng(seed)
    metric = Metric(np.array([1.0, 0.5, 2.0]), np.array([False, True, True]))
    a, b = rng.uniform(-20, 20, (2, 30, 3))
    turned = a + metric.wraps * TURN * rng.integers(-3, 4, (30, 3))
    np.testing.assert_allclose(
        metric.distances(turned, b), metric.distances(a, b), atol=1e-9
    )
    np.testing.assert_allclose(metric.distances(b, a), metric.distances(a, b))
    assert np.all(
        metric.distances(a, b)
        <= np.linalg.norm((a - b) * metric.weights, axis=1) + 1e-9
    )
    path = metric.unwrapped(a)
    assert np.array_equal(path[0], a[0])
    assert np.all(np.abs(np.diff(path, axis=0)[:, 1:]) <= np.pi + 1e-9)
    np.testing.assert_allclose(metric.distances(path, a), 0.0, atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_followers_go_with_their_leaders(stick_among, stick_joints, seed):
    """The angle follows y: planning moves x and y alone."""
    joints = replace(
        stick_joints,
        names=stick_joints.names[:2],
        indices=stick_joints.indices[:2],
        lower=stick_joints.lower[:2],
        upper=stick_joints.upper[:2],
        wraps=stick_joints.wraps[:2],
        costs=stick_joints.costs[:2],
        followers=(Follower(2, 1, -0.5, 0.2),),
    )
    ends = joints.with_followers(np.array([LEFT, RIGHT]))
    gap = stick_among(**GAP)
    rng = np.random.default_rng(seed)
    result = plan_path(gap, ends[0], ends[1], joints, SETTINGS, rng)
    assert result.found
    assert len(result.path) > 2
    np.testing.assert_allclose(
        result.path, joints.with_followers(result.path), atol=1e-12
    )
    assert not gap.shrunk(RESOLUTION / 2).any_collision(finely(result.path))


def test_a_joint_that_costs_more_moves_less(stick_among, stick_joints):
    """Way round the end of a wall: more of it is left to the cheap joint."""
    ways = []
    ends = np.array([LEFT, RIGHT]) * [1, 0, 0]
    for cost in (1.0, 20.0):
        joints = replace(stick_joints, costs=np.array([1.0, cost, 1.0]))
        lengths = []
        for seed in range(6):
            rng = np.random.default_rng(seed)
            wall = stick_among(wall=(-0.05, -0.4, 0.05, 0.3))
            result = plan_path(wall, *ends, joints, SETTINGS, rng)
            lengths.append(np.abs(np.diff(result.path[:, 1])).sum())
        ways.append(np.mean(lengths))
    assert ways[1] < ways[0]
