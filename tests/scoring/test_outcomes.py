"""Every way in which an evaluation can end, and that the first reason is told."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
import pytest

from mmplan.carry import Carry, Region, Upright
from mmplan.collision import CollisionWorld
from mmplan.grasps import Axis, GraspFamily
from mmplan.kinematics import joint_placements
from mmplan.problem import Obstacle, ScoreSettings
from mmplan.scoring import End, Outcome, ScoreFunction
from mmplan.scoring.carriable import Carriable
from mmplan.shapes import Array, Box
from tests.honest import shift
from tests.tabletop import cup_problem

BASE = np.array([-0.25, 0.5])  # 0.65 m before the cup
FROM_THE_FRONT = -np.pi  # the hand comes from where the base stands
ANY_HEIGHT = Axis(along=(-0.2, 0.4))


@dataclass(frozen=True)
class Slippery(Axis):
    """Grasps that are worse the higher they are."""

    def quality(self, genes: Array) -> Array:
        return np.clip(0.5 - 5.0 * genes[:, 0], 0.0, 1.0)


def cup_score(
    *more: Obstacle, family: GraspFamily = ANY_HEIGHT, min_quality: float = 0.0
) -> ScoreFunction:
    settings = ScoreSettings(min_quality=min_quality)
    problem = replace(cup_problem(*more), score=settings)
    world = CollisionWorld.of_problem(problem)
    return ScoreFunction(problem, problem.tasks[0], world, family)


def outcome(
    score: ScoreFunction,
    base: tuple[float, float] | Array = BASE,
    height: float = 0.02,
    direction: float = FROM_THE_FRONT,
) -> Outcome:
    grasp = np.array([[height, direction]])
    return Outcome(score(End.START, np.array([base]), grasp).outcome[0])


def test_outcomes_are_in_the_order_of_the_tests() -> None:
    assert [o.name for o in sorted(Outcome)] == [
        "OUT_OF_BOUNDS",
        "BASE_COLLISION",
        "NO_IK",
        "JOINT_LIMITS",
        "NO_CONTACT",
        "LOW_QUALITY",
        "NOT_CARRIED",
        "COLLISION",
        "HAND_OPEN_COLLISION",
        "SCORED",
    ]
    assert len({o.label for o in Outcome}) == len(Outcome)


def test_a_good_base_and_grasp_score() -> None:
    assert outcome(cup_score()) == Outcome.SCORED


@pytest.mark.parametrize("base", [(-2.01, 0.5), (2.51, 0.5), (0.5, 2.01), (0.0, -9.0)])
def test_a_base_outside_of_its_bounds(base: tuple[float, float]) -> None:
    assert outcome(cup_score(), base) == Outcome.OUT_OF_BOUNDS


def test_bounds_come_before_collisions() -> None:
    table = Obstacle("far_table", Box((1.0, 1.0, 1.0)), shift(5.0, 0.0, 0.5))
    assert outcome(cup_score(table), (5.0, 0.0)) == Outcome.OUT_OF_BOUNDS


def test_a_base_in_the_table() -> None:
    assert outcome(cup_score(), (0.5, 0.5)) == Outcome.BASE_COLLISION


def test_the_base_collides_before_the_arm_is_looked_at() -> None:
    assert outcome(cup_score(), (0.5, -0.75)) == Outcome.BASE_COLLISION


def test_a_base_too_far_away() -> None:
    assert outcome(cup_score(), (-1.0, 0.5)) == Outcome.NO_IK


def test_reach_comes_before_contact() -> None:
    assert outcome(cup_score(), (-1.0, 0.5), height=0.3) == Outcome.NO_IK


def test_only_beyond_the_joint_limits() -> None:
    score = cup_score()
    robot = score.problem.robot
    directions = np.linspace(-np.pi, np.pi, 60, endpoint=False)
    grasps = np.stack([np.full(60, 0.02), directions], axis=1)
    found = score(End.START, np.tile(BASE, (60, 1)), grasps).outcome
    limited = np.flatnonzero(found == Outcome.JOINT_LIMITS)
    assert len(limited) > 0
    T_world_object = score.worlds[End.START].standing["cup"]
    T_base_world = np.linalg.inv(robot.base_poses(BASE[None]))
    solutions = robot.ik.solve(
        T_base_world @ T_world_object @ score.family.tool_poses(grasps)
    )
    assert solutions.exists[limited].any(axis=1).all()
    assert not solutions.within[limited].any()


def test_a_hand_that_closes_above_the_cup() -> None:
    assert outcome(cup_score(), height=0.12) == Outcome.NO_CONTACT


def test_a_grasp_of_low_quality() -> None:
    slippery = Slippery(along=(-0.05, 0.06))
    assert outcome(cup_score(family=slippery, min_quality=0.3)) == Outcome.SCORED
    assert outcome(cup_score(family=slippery, min_quality=0.5)) == Outcome.LOW_QUALITY


def test_a_quality_beyond_its_range_is_a_mistake_of_the_family() -> None:
    class Boasting(Axis):
        def quality(self, genes: Array) -> Array:
            return np.full(len(genes), 1.5)

    with pytest.raises(
        ValueError, match=r"Boasting: grasp quality outside of \[0, 1\]"
    ):
        outcome(cup_score(family=Boasting(along=(-0.05, 0.06))))


def on_its_side(*regions: Region) -> ScoreFunction:
    """The cup must lie on its side on its way, but in some regions."""
    problem = cup_problem()
    upright = Upright(0.2, np.array([1.0, 0.0, 0.0]), regions)
    task = replace(problem.tasks[0], carry=Carry(upright))
    world = CollisionWorld.of_problem(problem)
    return ScoreFunction(problem, task, world, ANY_HEIGHT)


def test_an_object_that_cannot_turn_where_it_must() -> None:
    """It can where the arm reaches, and need not where all of its way is exempt."""
    start, goal = ((0.4, y, 0.88) for y in (0.5, 0.0))
    small, large = (0.3, 0.3, 0.3), (9.0, 9.0, 9.0)
    at_start, at_goal = (Region("low", small, shift(*p)) for p in (start, goal))
    assert outcome(on_its_side(at_start, at_goal)) == Outcome.SCORED
    too_high = Region("high", small, shift(0.4, 0.5, 5.0))
    assert outcome(on_its_side(too_high)) == Outcome.NOT_CARRIED
    assert outcome(on_its_side(Region("all", large, np.eye(4)))) == Outcome.SCORED


def test_no_grasp_is_dropped_that_an_arm_can_carry_by() -> None:
    """Whatever an arm holds upright in a region passes, drawn independently."""
    region = Region("region", (9.0, 9.0, 0.4), shift(0.0, 0.0, 0.6))
    score = on_its_side(region)
    problem, task = score.problem, score.task
    robot, rng = problem.robot, np.random.default_rng(7)
    q = np.tile(problem.q_start, (4000, 1))
    arm = robot.arm
    q[:, arm.indices] = rng.uniform(arm.lower, arm.upper, (4000, len(arm)))
    T = joint_placements(robot.model, q)[:, robot.tool_joint] @ robot.T_joint_tool
    T = T[np.abs(T[:, 2, 3] - 0.6) < 0.2][:200]  # the object's origin at the tool's
    lying = pin.rpy.rpyToMatrix(0.0, -np.pi / 2, 0.4)  # x is up
    T_object_tool = np.tile(np.eye(4), (len(T), 1, 1))
    T_object_tool[:, :3, :3] = lying.T @ T[:, :3, :3]
    start = problem.object(task.object).T_world_object
    assert len(T) > 100
    assert Carriable(problem, task, start)(T_object_tool).all()


def test_a_hand_in_the_table() -> None:
    assert outcome(cup_score(), height=-0.075) == Outcome.COLLISION


def test_a_wall_beside_the_cup_stops_the_open_hand_before_the_closed_one() -> None:
    outcomes = []
    for gap in np.arange(0.002, 0.05, 0.004):  # from the cup's side to the wall
        y = 0.5 + 0.035 + gap + 0.005
        wall = Obstacle("wall", Box((0.06, 0.01, 0.2)), shift(0.4, y, 0.9))
        outcomes.append(outcome(cup_score(wall)))
    assert outcomes == sorted(outcomes)
    assert set(outcomes) == {
        Outcome.COLLISION,
        Outcome.HAND_OPEN_COLLISION,
        Outcome.SCORED,
    }


def test_what_collides_is_named() -> None:
    score = cup_score()
    in_table = score.contacts(End.START, np.array([0.5, 0.0]), np.array([0.0, 0.0]))
    assert {(c.first, c.second) for c in in_table} == {("base", "table")}
    low = score.contacts(End.START, BASE, np.array([-0.075, FROM_THE_FRONT]))
    assert "table" in {c.second for c in low}
    assert score.contacts(End.START, BASE, np.array([0.02, FROM_THE_FRONT])) == ()
