"""C = Σ w_l d_l, against a sum that is made pair by pair."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import coal
import numpy as np
import pinocchio as pin
import pytest

from mmplan.collision import CollisionWorld
from mmplan.problem import Obstacle, Problem
from mmplan.robot import Robot
from mmplan.scoring import End, Grasped, ScoreFunction
from mmplan.scoring.clutter import Clutter
from mmplan.scoring.link_weights import LinkWeights
from mmplan.shapes import Array, Sphere
from tests.honest import shift
from tests.scoring.conftest import Evaluated
from tests.tabletop import two_tasks


def grasped(robot: Robot, end: End, q: Array) -> Grasped:
    """Configurations (n, nq) that have neither base nor grasp in common."""
    T_world_tool = np.array([robot.tool_pose(row) for row in q])
    return Grasped(end, q, np.arange(len(q)), np.arange(len(q)), T_world_tool)


def clutter_of(problem: Problem, *, without: str | None = None) -> Clutter:
    world = CollisionWorld.of_problem(problem)
    if without is not None:
        world = world.without(without)
    return Clutter(problem.robot, dict.fromkeys(End, world))


def distances_by_pinocchio(world: CollisionWorld, q: Array) -> dict[str, float]:
    """The distance from each link to the nearest obstacle: over all pairs."""
    geometry = world.geometry.clone()
    geometry.removeAllCollisionPairs()
    robot_kinds, pairs = ("base", "arm", "finger"), []
    for (i, link), (j, other) in product(enumerate(world.bodies), repeat=2):
        on_ground = (link.kind, other.kind) == ("base", "ground")
        if link.kind in robot_kinds and other.kind not in robot_kinds and not on_ground:
            geometry.addCollisionPair(pin.CollisionPair(i, j))
            pairs.append(link.owner)
    data = geometry.createData()
    for request in data.distanceRequests:
        request.gjk_initial_guess = coal.GJKInitialGuess.DefaultGuess
    pin.computeDistances(world.model, world.model.createData(), geometry, data, q)
    nearest: dict[str, float] = {}
    for owner, result in zip(pairs, data.distanceResults, strict=True):
        nearest[owner] = min(nearest.get(owner, np.inf), result.min_distance)
    return nearest


def weight_of(robot: Robot, link: str, q: Array) -> float:
    """1 / distance between the middle of a link's bodies and the base's centre."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    bodies = [b for b in robot.geometry.geometryObjects if robot.link_of(b) == link]
    corners = []
    for body in bodies:
        body.geometry.computeLocalAABB()
        box = body.geometry.aabb_local
        ends = product(*zip(box.min_, box.max_, strict=True))
        corners += [body.placement.act(np.array(corner)) for corner in ends]
    middle = (np.min(corners, axis=0) + np.max(corners, axis=0)) / 2
    base = robot.model.getJointId(robot.base.names[-1])
    centre = data.oMi[base].act(robot.model.inertias[base].lever)
    apart = np.linalg.norm(data.oMi[bodies[0].parentJoint].act(middle) - centre)
    return float(1.0 / max(apart, robot.base_radius))


def test_c_is_the_weighted_sum_over_links(
    evaluated: Evaluated, kitchen_score: ScoreFunction
) -> None:
    feasible = evaluated.scores.total > 0.0
    q = evaluated.scores.q[feasible][:12]
    assert len(q) >= 5
    world = kitchen_score.worlds[evaluated.end].without("wineglass")
    clutter = Clutter(world.robot, {evaluated.end: world, End.START: world})
    expected = np.array(
        [
            sum(
                weight_of(world.robot, link, configuration) * d
                for link, d in distances_by_pinocchio(world, configuration).items()
            )
            for configuration in q
        ]
    )
    np.testing.assert_allclose(
        clutter(grasped(world.robot, evaluated.end, q)), expected, rtol=0, atol=1e-9
    )


def test_every_link_counts_once() -> None:
    robot = two_tasks().robot
    links = clutter_of(two_tasks()).links
    assert sorted(links) == sorted(
        {robot.link_of(b) for b in robot.geometry.geometryObjects}
    )


def test_no_weight_is_more_than_the_base_allows() -> None:
    robot = two_tasks().robot
    rng = np.random.default_rng(0)
    low, high = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    weights = LinkWeights(robot)(rng.uniform(low, high, (50, robot.model.nq)))
    most = 1.0 / robot.base_radius
    assert np.all((weights > 0.0) & (weights <= most))
    base = clutter_of(two_tasks()).links.index("base")
    assert np.all(weights[:, base] == most)
    assert np.all(np.delete(weights, base, axis=1).min(axis=0) < most)


def test_the_ground_is_no_obstacle_for_the_base_but_for_the_arm() -> None:
    problem = two_tasks()
    q = np.tile(problem.q_start, (1, 1))
    q[:, problem.robot.arm.indices] = [0.0, 0.0, -1.5, 0.0, 0.0, 0.0]  # hand low down
    bare = replace(
        problem, obstacles=tuple(o for o in problem.obstacles if not o.ground)
    )
    with_ground, without = (clutter_of(p) for p in (problem, bare))
    change = without.distances(
        grasped(problem.robot, End.START, q)
    ) - with_ground.distances(grasped(problem.robot, End.START, q))
    base = with_ground.links.index("base")
    assert change[0, base] == 0.0
    assert np.delete(change[0], base).max() > 0.0


def test_objects_that_stand_count_and_the_one_in_the_hand_does_not() -> None:
    problem = two_tasks()
    q = problem.q_start[None].copy()
    q[:, problem.robot.base.indices] = -0.2, 0.5  # beside the cup
    all_stand = clutter_of(problem)(grasped(problem.robot, End.START, q))
    no_cup = clutter_of(problem, without="cup")(grasped(problem.robot, End.START, q))
    no_bottle = clutter_of(problem, without="bottle")(
        grasped(problem.robot, End.START, q)
    )
    assert all_stand < no_cup
    assert all_stand <= no_bottle


def test_links_without_any_obstacle_add_nothing() -> None:
    problem = two_tasks()
    ground = tuple(o for o in problem.obstacles if o.ground)
    empty = replace(problem, obstacles=(), objects=())
    only_ground = replace(problem, obstacles=ground, objects=())
    q = problem.q_start[None]
    assert clutter_of(empty)(grasped(problem.robot, End.START, q)) == [0.0]
    by_link = clutter_of(only_ground).by_link(grasped(problem.robot, End.START, q))
    assert np.isfinite(by_link).all()
    assert by_link[0, clutter_of(only_ground).links.index("base")] == 0.0
    assert by_link.sum() > 0.0


@pytest.mark.parametrize("away", [0.1, 0.5, 2.0])
def test_clutter_grows_as_the_only_obstacle_moves_away(away: float) -> None:
    problem = two_tasks()
    q = problem.q_start[None]

    def at(x: float) -> Array:
        ball = Obstacle("ball", Sphere(0.1), shift(x, 0.0, 0.8))
        alone = replace(problem, obstacles=(ball,), objects=())
        return clutter_of(alone)(grasped(problem.robot, End.START, q))

    assert at(1.0) < at(1.0 + away)
