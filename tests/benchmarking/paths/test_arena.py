"""The worlds of path problems."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mmplan.benchmarking.paths.arena import contestant, make_arena
from mmplan.benchmarking.paths.problems import PathProblem, load_path_problems
from mmplan.exceptions import InputError
from tests.benchmarking.paths.made import (
    MOTIONBENCHMAKER,
    arena,
    motionbenchmaker,
    panda,
)

TIAGO = MOTIONBENCHMAKER.with_name("tiago_whole_body.json")


def blocked(hand: float, *problems: PathProblem) -> list[tuple[str, int]]:
    """The problems with an end that collides, the hand open so far."""
    robot = contestant(hand=[hand])
    found = []
    for problem in problems:
        made = make_arena(robot, problem)
        assert made.joints.outside(made.q_start) is None
        assert made.joints.outside(made.q_goal) is None
        if made.world.any_collision(np.stack([made.q_start, made.q_goal])):
            found.append((problem.family, problem.number))
    return found


def test_all_ends_are_free_with_vamps_hand_and_not_with_the_real_one() -> None:
    problems = motionbenchmaker()
    assert blocked(0.065, *problems) == []
    cages = [problem for problem in problems if problem.family == "cage"]
    assert len(blocked(0.04, *cages)) == 6


def test_the_world_is_the_frame_of_the_pandas_first_link() -> None:
    robot = panda().robot
    placement = robot.model.frames[robot.model.getFrameId("panda_link0")]
    assert placement.parentJoint == 0
    np.testing.assert_array_equal(placement.placement.homogeneous, np.eye(4))


def test_the_hand_stands_still() -> None:
    made = arena()
    hand = panda().robot.hand.indices
    assert made.q_start[hand].tolist() == made.q_goal[hand].tolist() == [0.065, 0.065]
    assert not set(hand) & set(made.joints.indices)


def test_whole_bodies_stand_two_metres_away_and_have_eleven_joints() -> None:
    robot = contestant("tiago")
    problems = load_path_problems(TIAGO).problems
    assert len(problems) == 20
    for problem in problems:
        made = make_arena(robot, problem)
        assert len(made.joints.indices) == 11
        assert not made.joints.wraps.any()
        away = np.linalg.norm(problem.q_start[:2] - problem.q_goal[:2])
        assert away == pytest.approx(2.0, abs=1e-5)
        assert made.joints.outside(made.q_start) is None
        assert made.joints.outside(made.q_goal) is None
        assert not made.world.any_collision(np.stack([made.q_start, made.q_goal]))


def test_problems_of_another_robot_are_refused() -> None:
    with pytest.raises(InputError, match="has 7 joints; tiago has 11 in base and arm"):
        make_arena(contestant("tiago"), motionbenchmaker()[0])


def test_hands_of_other_joints_are_refused() -> None:
    with pytest.raises(InputError, match="the hand of panda has 1 joints; got 2"):
        contestant(hand=[0.01, 0.01])


def test_unknown_robots_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown robot"):
        contestant(tmp_path / "none.yaml")
