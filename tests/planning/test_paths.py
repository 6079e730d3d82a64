import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from mmplan.exceptions import InputError
from mmplan.planning import (
    PathChecker,
    PathOutcome,
    available_planners,
    plan_path,
    transfer_joints,
    transit_joints,
)
from mmplan.planning.search import Budget, Search, search
from mmplan.planning.shortening import path_length, shorten
from mmplan.planning.turns import Turns
from mmplan.problem import RANGES, PlannerSettings

RESOLUTION = 0.02
SETTINGS = PlannerSettings(iterations=3000, resolution=RESOLUTION, shortcuts=30)
# A wall between left and right with one gap.
GAP = {"lower": (-0.05, -9.0, 0.05, 0.3), "upper": (-0.05, 0.7, 0.05, 9.0)}
LEFT = np.array([-1.2, -0.5, 1.0])
RIGHT = np.array([1.2, -0.8, -1.0])
# Four walls around the goal.
CELL = {
    "west": (0.4, -1.8, 0.5, 0.3),
    "east": (1.9, -1.8, 2.0, 0.3),
    "south": (0.4, -1.9, 2.0, -1.8),
    "north": (0.4, 0.3, 2.0, 0.4),
}


def finely(path, parts=200):
    t = np.linspace(0.0, 1.0, parts)[:, None]
    return np.vstack([a + t * (b - a) for a, b in pairwise(path)])


@pytest.fixture
def gap(stick_among):
    return stick_among(**GAP)


@pytest.mark.parametrize("seed", range(10))
def test_every_state_of_a_path_is_valid(gap, stick_joints, seed):
    rng = np.random.default_rng(seed)
    result = plan_path(gap, LEFT, RIGHT, stick_joints, SETTINGS, rng)
    assert result.outcome is PathOutcome.FOUND
    assert np.array_equal(result.path[0], LEFT)
    assert np.array_equal(result.path[-1], RIGHT)
    # Checks are RESOLUTION apart: nothing is deeper in a wall than half of that.
    assert not gap.shrunk(RESOLUTION / 2).any_collision(finely(result.path))
    assert np.all(result.path >= stick_joints.lower)
    assert np.all(result.path <= stick_joints.upper)
    assert result.states > 0
    assert result.edges > 0


@pytest.mark.parametrize("name", available_planners())
def test_every_planner_finds_the_gap_the_same_way_twice(gap, stick_joints, name):
    settings = PlannerSettings(name=name, iterations=3000, resolution=RESOLUTION)
    first, second = (
        plan_path(gap, LEFT, RIGHT, stick_joints, settings, np.random.default_rng(4))
        for _ in range(2)
    )
    assert first.found, first.message
    assert first.path.tobytes() == second.path.tobytes()
    assert (first.states, first.edges) == (second.states, second.edges)
    assert not gap.shrunk(RESOLUTION / 2).any_collision(finely(first.path))


def test_another_seed_finds_another_path(gap, stick_joints):
    one, other = (
        plan_path(gap, LEFT, RIGHT, stick_joints, SETTINGS, np.random.default_rng(seed))
        for seed in (0, 1)
    )
    assert one.path.tobytes() != other.path.tobytes()


def test_paths_of_the_robot_are_valid_and_repeat(kitchen, kitchen_world):
    q_goal = kitchen.q_start.copy()
    q_goal[kitchen.robot.base.indices] = [1.0, 0.8]
    q_goal[kitchen.robot.arm.indices] = kitchen.robot.configurations["home"]
    assert not kitchen_world.any_collision(q_goal[None])
    first, second = (
        plan_path(
            kitchen_world,
            kitchen.q_start,
            q_goal,
            transit_joints(kitchen),
            kitchen.planner,
            np.random.default_rng(7),
        )
        for _ in range(2)
    )
    assert first.found
    assert first.path.tobytes() == second.path.tobytes()
    sampled = finely(first.path)
    single = [kitchen_world.contacts(q) for q in sampled[::10]]
    assert all(c.depth < kitchen.planner.resolution / 2 for cs in single for c in cs)


def test_the_fingers_stay_still_in_a_transfer(kitchen):
    hand = kitchen.robot.hand.indices
    assert np.intersect1d(transfer_joints(kitchen).indices, hand).size == 0
    assert np.intersect1d(transit_joints(kitchen).indices, hand).size == hand.size


def test_the_base_keeps_to_the_bounds_of_the_problem(kitchen):
    joints = transit_joints(kitchen)
    assert np.all(joints.lower[:2] >= kitchen.base_bounds[:, 0])
    assert np.all(joints.upper[:2] <= kitchen.base_bounds[:, 1])


def test_a_path_goes_to_the_goal_that_can_be_reached(stick_among, stick_joints):
    world = stick_among(**CELL, **GAP)
    goals = np.array([[1.2, -0.8, 0.0], [0.0, 0.0, 0.0], [0.8, 1.2, 0.0]])
    rng = np.random.default_rng(0)
    result = plan_path(world, LEFT, goals, stick_joints, SETTINGS, rng)
    assert result.goal == 2
    assert np.array_equal(result.path[-1], goals[2])


def test_a_failed_search_says_how_far_it_got(stick_among, stick_joints):
    world = stick_among(**CELL)
    rng = np.random.default_rng(0)
    result = plan_path(world, LEFT, RIGHT, stick_joints, SETTINGS, rng)
    assert result.outcome is PathOutcome.ITERATIONS
    assert result.iterations == SETTINGS.iterations
    assert result.path is None
    assert 0.0 < result.gap < 2.5
    assert result.start_tree > 100
    assert result.goal_tree > 0
    # No state outside of the cell is nearer to the goal than its walls.
    assert result.gap > 0.5
    told = re.search(r" in (\d+) tries, .* in (\d+) tries, ", result.message)
    assert sum(int(tries) for tries in told.groups()) == result.iterations
    assert f"{result.gap:.2f} m left to go" in result.message


@pytest.mark.parametrize("iterations", [1, 17, 400])
def test_a_search_ends_after_so_many_iterations(stick_among, stick_joints, iterations):
    settings = PlannerSettings(iterations=iterations, resolution=RESOLUTION)
    world = stick_among(**CELL)
    rng = np.random.default_rng(0)
    result = plan_path(world, LEFT, RIGHT, stick_joints, settings, rng)
    assert result.iterations == iterations


def test_the_time_limit_is_a_safety_net(stick_among, stick_joints):
    settings = PlannerSettings(iterations=10**9, time_limit=0.1, resolution=RESOLUTION)
    world = stick_among(**CELL)
    rng = np.random.default_rng(0)
    result = plan_path(world, LEFT, RIGHT, stick_joints, settings, rng)
    assert result.outcome is PathOutcome.TIME_LIMIT
    assert result.iterations < 10**9


def test_a_planner_that_gives_up_says_so(monkeypatch, gap, stick_joints):
    nothing = Search(None, 5, False, gap=1.5, start_tree=3, goal_tree=1)
    monkeypatch.setattr("mmplan.planning.path_finder.search", lambda *_: nothing)
    rng = np.random.default_rng(0)
    result = plan_path(gap, LEFT, RIGHT, stick_joints, SETTINGS, rng)
    assert result.outcome is PathOutcome.GAVE_UP
    assert "3 states connected to the start, 1 to the goal, 1.50 m" in result.message


@pytest.mark.parametrize("name", ["RRTConnect", "PRM", "KPIECE1"])
def test_searches_with_several_goals_repeat(gap, stick_joints, name):
    goals = RIGHT + np.array([[0.0, 0.1 * k, 0.0] for k in range(4)])
    settings = PlannerSettings(name=name, iterations=3000, resolution=RESOLUTION)
    first, second = (
        plan_path(gap, LEFT, goals, stick_joints, settings, np.random.default_rng(1))
        for _ in range(2)
    )
    assert first.path.tobytes() == second.path.tobytes()
    assert np.array_equal(first.path[-1], goals[first.goal])


def test_what_is_wrong_with_the_ends_is_said_by_name(gap, stick_joints):
    rng = np.random.default_rng(0)
    inside, beyond = np.array([0.0, -1.0, 0.0]), np.array([2.5, 0.0, 0.0])
    start = plan_path(gap, inside, RIGHT, stick_joints, SETTINGS, rng)
    assert start.outcome is PathOutcome.INVALID_START
    assert start.message == "the start: stick touches lower"
    goal = plan_path(gap, LEFT, inside, stick_joints, SETTINGS, rng)
    assert goal.outcome is PathOutcome.INVALID_GOAL
    assert goal.message == "the goal: stick touches lower"
    goal = plan_path(gap, LEFT, beyond, stick_joints, SETTINGS, rng)
    assert goal.outcome is PathOutcome.INVALID_GOAL
    assert goal.message == "the goal: x = 2.5 is outside [-2, 2]"


def test_an_unknown_planner_is_refused_with_what_there_is(gap, stick_joints):
    settings = PlannerSettings(name="RRTConect")
    rng = np.random.default_rng(0)
    with pytest.raises(InputError, match=r"'RRTConect'; did you mean 'RRTConnect'\?"):
        plan_path(gap, LEFT, RIGHT, stick_joints, settings, rng)


def test_joints_that_do_not_move_must_not_differ(kitchen, kitchen_world):
    q_goal = kitchen.q_start.copy()
    q_goal[kitchen.robot.hand.indices[0]] -= 0.01
    with pytest.raises(ValueError, match=kitchen.robot.hand.names[0]):
        plan_path(
            kitchen_world,
            kitchen.q_start,
            q_goal,
            transfer_joints(kitchen),
            kitchen.planner,
            np.random.default_rng(0),
        )


@pytest.mark.parametrize("seed", range(20))
def test_shortening_never_lengthens_and_keeps_the_ends(gap, stick_joints, seed):
    rng = np.random.default_rng(seed)
    checker = PathChecker(gap, RESOLUTION)
    knots = rng.uniform([-1.5, -1.0, -1.0], [-0.6, 1.5, 1.0], (5, 3))
    path = np.vstack([LEFT, knots, LEFT + np.array([0.0, 1.0, 0.0])])
    if not checker.path_free(path):
        path = np.vstack(
            [LEFT, LEFT + np.array([0.0, 0.5, 0.0]), LEFT + np.array([0.0, 1.0, 0.0])]
        )
    short = shorten(path, checker, stick_joints, 50, rng)
    weights = checker.sweep.weights
    assert path_length(short, weights) <= path_length(path, weights) + 1e-12
    assert np.array_equal(short[[0, -1]], path[[0, -1]])
    assert not gap.shrunk(RESOLUTION / 2).any_collision(finely(short))


def test_a_detour_in_the_open_becomes_a_straight_line(stick_among, stick_joints):
    path = np.array([[0.0, 0, 0], [1, 1, 2], [-1, 1, -2], [1.0, 0, 0]])
    checker = PathChecker(stick_among(), RESOLUTION)
    short = shorten(path, checker, stick_joints, 10, np.random.default_rng(0))
    assert np.array_equal(short, path[[0, -1]])


def test_no_shortcut_is_tried_when_the_time_for_it_is_over(gap, stick_joints):
    rng = np.random.default_rng(0)
    path = plan_path(gap, LEFT, RIGHT, stick_joints, SETTINGS, rng).first
    checker = PathChecker(gap, RESOLUTION)
    none = shorten(path, checker, stick_joints, 0, np.random.default_rng(1))
    late = shorten(path, checker, stick_joints, 10**9, np.random.default_rng(1), 0.0)
    assert np.array_equal(none, late)


class Unsolved:
    """A problem without a solution, and a planner that notes its ranges."""

    def __init__(self):
        self.ranges = []

    def hasExactSolution(self):
        return False

    def setRange(self, longest):
        self.ranges.append(longest)


@pytest.mark.parametrize("given", [None, 0.3])
def test_lengths_of_edges_take_turns_unless_one_is_given(given):
    unsolved = Unsolved()
    budget = Budget(PlannerSettings(iterations=6, range=given), unsolved, unsolved)
    assert [budget() for _ in range(7)] == [False] * 6 + [True]
    assert unsolved.ranges == ([] if given else [*RANGES, *RANGES])


@pytest.fixture
def trees_in_turn(monkeypatch):
    """The turns of every search, in the order of their beginning."""
    begun = []

    class Noted(Turns):
        def __init__(self):
            super().__init__()
            begun.append(self)

    monkeypatch.setattr("mmplan.planning.search.Turns", Noted)
    return begun


@pytest.mark.parametrize("seed", range(5))
def test_the_smaller_tree_is_extended(stick_among, stick_joints, trees_in_turn, seed):
    world = stick_among(**CELL)
    checker = PathChecker(world, RESOLUTION)
    settings = replace(SETTINGS, iterations=300)
    found = search(checker, LEFT, RIGHT[None], stick_joints, settings, seed)
    assert found.waypoints is None
    assert found.iterations == 300
    (turns,) = trees_in_turn
    assert turns.sizes == [found.start_tree, found.goal_tree]
    assert sum(found.tries) == found.iterations
    assert abs(found.start_tree - found.goal_tree) < 10


def test_turns_that_pass_are_no_iterations():
    turns, unsolved = Turns(), Unsolved()
    budget = Budget(PlannerSettings(iterations=3), unsolved, unsolved, turns)
    passed = []
    while not budget():
        passed.append(turns.passes)
        if not turns.passes:
            turns.note(free=len(passed) == 1)
    assert passed == [False, False, True, False]
    assert budget.iterations == 3
