"""What OMPL is told: the same from its coordinates on, compiled, as without."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from ompl import base as ob

from mmplan.collision import CollisionWorld, PlannerSpace, compile_motions, kernels
from mmplan.collision.compiled_space import CompiledSpace
from mmplan.planning import PathChecker, transit_joints
from mmplan.planning.metric import Metric
from mmplan.planning.state_space import Answers, ScaledStates
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.shapes import Array

STATES, RESOLUTION = 150, 0.03
# The last two have bases that turn without end and fingers that follow others.
NAMES = ("wineglass", "tiago_shelf", "panda_bin")


class Slow(PathChecker):
    """Leaves compiled answers from coordinates on alone."""

    def in_space(self, space: PlannerSpace) -> None:
        """None, whatever there is."""


@cache
def problem(name: str) -> Problem:
    return load_problem(name)


@cache
def asked(name: str) -> tuple[Answers, Answers, list[ob.State]]:
    """Both ways of answering, and random states about the robot's start."""
    compile_motions()
    world, joints = (
        CollisionWorld.of_problem(problem(name)),
        transit_joints(problem(name)),
    )
    q_start = problem(name).q_start
    world.steps_collide(q_start, np.zeros_like(q_start), 1)  # compiled by now
    quick, slow = PathChecker(world, RESOLUTION), Slow(world, RESOLUTION)
    states = ScaledStates(
        q_start, joints, Metric.of_joints(joints, quick.sweep.weights)
    )
    drawn = q_start + np.zeros((STATES, 1))
    k, rng = joints.indices, np.random.default_rng(5)
    lower, upper = np.maximum(joints.lower, -np.pi), np.minimum(joints.upper, np.pi)
    away = rng.uniform(lower, upper, (STATES, len(k))) - q_start[k]
    drawn[:, k] += rng.uniform(0.0, 1.0, (STATES, 1)) * away
    made = [as_state(states, q) for q in drawn]
    return Answers(states, quick), Answers(states, slow), made


def as_state(states: ScaledStates, q: Array) -> ob.State:
    state = states.space(q[None]).allocState()
    states.write(q, state)
    return state


@pytest.mark.parametrize("name", NAMES)
def test_states_are_free_or_not_in_both_ways(name: str) -> None:
    quick, slow, states = asked(name)
    told = [quick.state_free(state) for state in states]
    assert told == [slow.state_free(state) for state in states]
    assert 0 < sum(told) < STATES


@pytest.mark.parametrize("name", NAMES)
def test_edges_are_free_or_not_in_both_ways(name: str) -> None:
    quick, slow, states = asked(name)
    before = [(a.checker.states, a.checker.edges) for a in (quick, slow)]
    edges = list(pairwise(states))
    told = [quick.edge_free(*edge) for edge in edges]
    assert told == [slow.edge_free(*edge) for edge in edges]
    assert 0 < sum(told) < len(edges)
    done = [(a.checker.states, a.checker.edges) for a in (quick, slow)]
    assert np.array_equal(
        np.subtract(done[0], before[0]), np.subtract(done[1], before[1])
    )


@pytest.mark.parametrize("name", NAMES)
def test_much_is_settled_without_coal(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick, _, states = asked(name)
    quick.state_free(states[0])  # ready from then on
    compiled = quick._quick
    assert isinstance(compiled, CompiledSpace)
    judge, left = compiled._judge, list[int]()

    def counted(finds: list[tuple[int, int]], place: Callable[[int], Array]) -> bool:
        left.append(len(finds))
        return judge(finds, place)

    monkeypatch.setattr(compiled, "_judge", counted)
    for state in states:
        quick.state_free(state)
    assert 0 < len(left) < 0.9 * STATES


def test_edges_go_the_short_way_round() -> None:
    """Across the place where a heading begins anew."""
    quick, slow, _ = asked("tiago_shelf")
    heading = problem("tiago_shelf").robot.base.indices[2]
    turned = np.tile(problem("tiago_shelf").q_start, (2, 1))
    turned[:, heading] = np.pi - 0.05, -np.pi + 0.05
    ends = [as_state(quick.states, q) for q in turned]
    assert quick.edge_free(*ends) == slow.edge_free(*ends)
    assert quick._quick is not None
    assert quick._quick.steps < 20


@pytest.mark.parametrize("name", NAMES)
def test_points_are_the_same_configurations(name: str) -> None:
    quick, _, drawn = asked(name)
    quick.state_free(drawn[0])
    made, states = quick._quick, quick.states
    assert isinstance(made, CompiledSpace)
    q = np.empty_like(problem(name).q_start)
    for state in drawn:
        point = np.array(states.coordinates(state))
        kernels._configure(point, 0, made._places, made._rows, made._followers, q)
        assert np.array_equal(q, states.configuration(state))
