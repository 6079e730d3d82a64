"""Films: where everything is, against the plan itself."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.replay import replay
from mmplan.visualization.clearance import clearance_curve
from mmplan.visualization.exhibit import Exhibit
from mmplan.visualization.film import film_at, film_of_plan, film_of_scene
from mmplan.visualization.part import WORLD, joint_carrier, object_carrier
from mmplan.visualization.rotations import pose_numbers


def test_a_film_goes_through_every_waypoint_of_the_plan(
    problem: Problem, plan: Plan
) -> None:
    start = 0.0
    for stage in replay(problem, plan.tasks):
        segment = stage.segment
        # Just before the end, which is the beginning of the next segment.
        times = start + np.minimum(segment.times, segment.duration * (1 - 1e-9))
        film = film_at(problem, plan, times)
        assert np.allclose(film.q, segment.positions, atol=1e-6)
        for row in (0, len(times) // 2, len(times) - 1):
            T_world_tool = problem.robot.tool_pose(film.q[row])
            assert np.allclose(film.tool_path[row], T_world_tool[:3, 3])
            for name, T in stage.object_poses(T_world_tool).items():
                assert np.allclose(film.poses[object_carrier(name)][row], T)
        start += segment.duration


def test_a_film_ends_with_the_objects_at_their_goals(
    problem: Problem, exhibit: Exhibit
) -> None:
    assert exhibit.film.duration == pytest.approx(exhibit.plan.duration)
    for task in problem.tasks:
        T = exhibit.film.poses[object_carrier(task.object)][-1]
        assert np.allclose(T, task.T_world_goal, atol=1e-3)


def test_nothing_jumps_from_one_moment_to_the_next(
    problem: Problem, plan: Plan
) -> None:
    film = film_of_plan(problem, plan, 50.0)
    for T in film.poses.values():
        way = np.linalg.norm(np.diff(T[:, :3, 3], axis=0), axis=1)
        assert way.max() < 0.08
        numbers = pose_numbers(T)
        assert (np.einsum("ij,ij->i", numbers[1:, 3:], numbers[:-1, 3:]) > 0.9).all()


def test_marks_follow_each_other_without_gaps(exhibit: Exhibit) -> None:
    film = exhibit.film
    assert [m.name for m in film.marks] == [
        s.name for task in exhibit.plan.tasks for s in task.segments
    ]
    assert film.marks[0].start == 0.0
    assert [m.end for m in film.marks[:-1]] == [m.start for m in film.marks[1:]]
    for mark in film.marks:
        assert film.mark_at((mark.start + mark.end) / 2) == mark


def test_a_scene_is_a_film_of_one_moment(problem: Problem) -> None:
    film = film_of_scene(problem)
    assert film.duration == 0.0
    assert np.array_equal(film.q[0], problem.q_start)
    for item in problem.objects:
        assert np.array_equal(
            film.poses[object_carrier(item.name)][0], item.T_world_object
        )


def test_every_part_is_carried_by_something_in_the_film(exhibit: Exhibit) -> None:
    carriers = {part.carrier for part in exhibit.parts}
    assert carriers <= {WORLD, *exhibit.film.poses}
    robot = exhibit.problem.robot
    moved = {joint_carrier(name) for name in robot.arm.names}
    assert moved <= carriers
    names = [part.name for part in exhibit.parts]
    assert len(set(names)) == len(names)


def test_the_clearance_is_that_of_the_proof(
    problem: Problem, plan: Plan, exhibit: Exhibit
) -> None:
    curve = clearance_curve(problem, plan, exhibit.film)
    proven = plan.verification.clearance
    # The curve has samples only, which may miss the nearest moment by a little.
    assert curve.distances.min() >= proven.distance - 1e-6
    assert curve.distances.min() <= proven.distance + 0.01
    assert len(curve.pairs) == len(curve.times)
    assert all(first and second for first, second in curve.pairs)
