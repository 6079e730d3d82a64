"""The shipped scenes: things stand on what they stand on, and the wrong grasp fails."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from benchmarks.grasp_coupling import measure
from mmplan import pipeline
from mmplan.assets import robot_names, scene_names, scenes_folder
from mmplan.collision import CollisionWorld, clearances
from mmplan.optimizers import search_space
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.scoring import End, Outcome, ScoreFunction
from mmplan.shapes import Array
from mmplan.verification import examine

# How exactly an object stands on its support, m.
EXACT = 2e-4


@cache
def loaded(name: str) -> Problem:
    return load_problem(scenes_folder() / f"{name}.yaml")


@cache
def score_function(name: str) -> ScoreFunction:
    return pipeline.score_function(loaded(name))


def feasible(name: str, end: End, genes: Array, bases: int) -> Array:
    """Whether each grasp (n, genes) is feasible at one end for one of random bases."""
    score = score_function(name)
    placements = search_space(score).bases[end]
    drawn = placements.sample(bases, np.random.default_rng(0))
    q_base = np.tile(placements.q_base(drawn), (len(genes), 1))
    outcome = score(end, q_base, np.repeat(genes, bases, axis=0)).outcome
    return (outcome == Outcome.SCORED).reshape(len(genes), bases).any(axis=1)


def test_the_papers_problems_are_shipped() -> None:
    assert {"wineglass", "plate"} <= set(scene_names())


@pytest.mark.parametrize("name", scene_names())
def test_objects_stand_exactly_on_one_support(name: str) -> None:
    problem = loaded(name)
    scenery = CollisionWorld.of_problem(problem).scenery
    for task in problem.tasks:
        for T in (problem.object(task.object).T_world_object, task.T_world_goal):
            near = clearances(scenery, task.object, T, 0.002)
            assert len(near) == 1
            assert abs(next(iter(near.values()))) <= EXACT


@pytest.mark.parametrize("name", scene_names())
def test_the_start_is_free_of_collision(name: str) -> None:
    problem = loaded(name)
    world = CollisionWorld.of_problem(problem)
    assert world.contacts(problem.q_start) == ()


@pytest.mark.parametrize("name", scene_names())
def test_every_scene_solves(name: str) -> None:
    problem = loaded(name)
    plan = pipeline.solve(problem, seed=0)
    assert examine(plan, problem).ok


def test_every_robot_has_a_scene() -> None:
    robots = {loaded(name).robot.name for name in scene_names()}
    assert robots == set(robot_names())


def test_fixtures_have_capsule_tines() -> None:
    world = CollisionWorld.of_problem(loaded("wineglass"))
    shapes = [
        type(body.geometry).__name__
        for i, body in enumerate(world.geometry.geometryObjects)
        if world.owner_of(i) == "dishwasher/lower_rack"
    ]
    assert shapes.count("Capsule") == 31


DIRECTIONS = np.linspace(-np.pi, np.pi, 12, endpoint=False)


def at_height(height: float) -> Array:
    """Grasps of the wineglass at one height from all directions."""
    return np.stack([np.full(len(DIRECTIONS), height), DIRECTIONS], axis=1)


@pytest.mark.parametrize("height", [0.13, 0.15, 0.17, 0.19])
def test_the_bowl_can_be_held_on_the_counter_but_not_in_the_rack(height: float) -> None:
    grasps = at_height(height)
    assert feasible("wineglass", End.START, grasps, 40).any()
    assert not feasible("wineglass", End.GOAL, grasps, 40).any()


@pytest.mark.parametrize("height", [0.055, 0.065, 0.075])
def test_the_stem_can_be_held_at_both_ends(height: float) -> None:
    grasps = at_height(height)
    both = feasible("wineglass", End.START, grasps, 40) & feasible(
        "wineglass", End.GOAL, grasps, 40
    )
    assert both.any()


def test_the_foot_can_be_held_in_the_rack_only() -> None:
    grasps = at_height(0.025)
    assert not feasible("wineglass", End.START, grasps, 40).any()
    assert feasible("wineglass", End.GOAL, grasps, 40).any()


def test_only_the_front_of_the_lip_can_be_held_on_the_shelf() -> None:
    grasps = np.stack([DIRECTIONS, np.zeros(len(DIRECTIONS))], axis=1)
    T_world_goal = loaded("plate").tasks[0].T_world_goal
    lip = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS), 0 * DIRECTIONS], axis=1)
    towards_room = -(lip @ T_world_goal[:3, :3].T)[:, 0]  # the room is at lower x
    on_shelf = feasible("plate", End.GOAL, grasps, 60)
    in_rack = feasible("plate", End.START, grasps, 60)
    assert on_shelf[towards_room > 0.9].all()
    assert not on_shelf[towards_room < 0.2].any()
    assert (in_rack & ~on_shelf).any()


@pytest.mark.parametrize("name", ["wineglass", "plate"])
def test_a_grasp_for_the_start_alone_often_fails_at_the_goal(name: str) -> None:
    coupling = measure(loaded(name), grasps=60, bases=60, seed=0)
    assert coupling.start.any(axis=1).sum() >= 15
    assert 0.4 <= coupling.fails_at_goal <= 0.85
    assert (coupling.start.any(axis=1) & coupling.goal.any(axis=1)).any()
