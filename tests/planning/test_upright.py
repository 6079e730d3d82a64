"""Carrying upright: projection, and whole motions judged by kinematics alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mmplan import pipeline
from mmplan.carry import Carry, Region, Upright
from mmplan.hermite import HermiteCurve
from mmplan.kinematics import joint_placements
from mmplan.motion.carrying import kept_upright
from mmplan.plan import Plan, Segment
from mmplan.planning import (
    MotionLimits,
    ToolSpeed,
    UprightRule,
    motion_limits,
    straight_motion,
    time_path,
    transfer_joints,
)
from mmplan.planning.world import contact_names
from mmplan.problem import Problem
from mmplan.shapes import Array
from tests.honest import T_OBJECT_TOOL, bottle_plan, bottle_problem, puma, shift
from tests.tabletop import cup_problem

UP = np.array([0.0, 0.0, 1.0])
T_TOOL_OBJECT = np.linalg.inv(T_OBJECT_TOOL)


def rule(upright: Upright, *ends: Array) -> UprightRule:
    q = transfer_ends()[0]
    return UprightRule(puma(), "bottle", upright, T_TOOL_OBJECT, 0.01, ends or (q,))


def transfer_ends() -> tuple[Array, Array]:
    segments = bottle_plan().tasks[0].segments
    positions = next(s for s in segments if s.name == "transfer").positions
    return positions[0], positions[-1]


def drawn(count: int) -> Array:
    """Random configurations (count, nq) that may carry the bottle."""
    joints = transfer_joints(bottle_problem())
    q = np.tile(transfer_ends()[0], (count, 1))
    rng = np.random.default_rng(0)
    shape = (count, len(joints.indices))
    q[:, joints.indices] = rng.uniform(joints.lower, joints.upper, shape)
    return q


def object_poses(q: Array, T_tool_object: Array) -> Array:
    robot = puma()
    T = joint_placements(robot.model, q)[:, robot.tool_joint]
    poses: Array = T @ robot.T_joint_tool @ T_tool_object
    return poses


@pytest.mark.parametrize("angle", [0.02, 0.17, 1.0])
def test_what_is_projected_is_upright_and_otherwise_left_alone(angle: float) -> None:
    upright, q = Upright(angle, UP), drawn(300)
    joints, weights = transfer_joints(bottle_problem()), np.ones(10)
    projected, obeys = rule(upright).project(q, joints, weights)
    assert obeys.mean() > 0.8
    tilts = upright.tilts(object_poses(projected, T_TOOL_OBJECT)[:, :3, :3])
    assert np.array_equal(obeys, rule(upright).excess(projected) <= 0.0)
    assert tilts[obeys].max() <= angle
    inside = projected[:, joints.indices]
    assert np.all((inside >= joints.lower) & (inside <= joints.upper))
    already = rule(upright).excess(q) <= 0.0
    assert np.array_equal(projected[already], q[already])


def test_in_a_region_nothing_is_projected() -> None:
    everywhere = Region("exempt region 1", (99.0, 99.0, 99.0), np.eye(4))
    q = drawn(50)
    exempt = rule(Upright(0.1, UP, (everywhere,)))
    joints = transfer_joints(bottle_problem())
    projected, obeys = exempt.project(q, joints, np.ones(10))
    assert obeys.all()
    assert np.array_equal(projected, q)


def test_the_object_is_brought_to_points() -> None:
    q, joints = drawn(100), transfer_joints(bottle_problem())
    points = np.random.default_rng(1).uniform(
        (0.5, -0.5, 0.6), (1.0, 0.5, 1.2), (100, 3)
    )
    brought = rule(Upright(0.1, UP)).brought(q, points, joints, np.ones(10))
    off = object_poses(brought, T_TOOL_OBJECT)[:, :3, 3] - points
    assert np.median(np.linalg.norm(off, axis=1)) < 0.01


def test_a_tilted_motion_is_told_in_words() -> None:
    problem = bottle_problem()
    task = replace(problem.tasks[0], carry=Carry(Upright(0.1, UP)))
    world = pipeline.CollisionWorld.of_problem(problem).attach("bottle", T_TOOL_OBJECT)
    q = transfer_ends()[0].copy()
    ruled = kept_upright(world, problem, task, world.attached, q)
    assert not ruled.any_collision(q[None])
    q[6] += 0.3
    assert ruled.in_collision(q[None]).all()
    assert contact_names(ruled, q) == "bottle tilts by 0.294 rad, 0.1 are allowed"
    assert kept_upright(world, problem, problem.tasks[0], world.attached, q) is world


def carried(segments: tuple[Segment, ...]) -> list[tuple[Segment, Array, Array]]:
    """Segments with an object in the hand: its poses (n, 4, 4), the tool's speeds."""
    found = []
    for segment in segments:
        if not segment.attached:
            continue
        (T_tool_object,) = segment.attached.values()
        curve = HermiteCurve(segment.times, segment.positions, segment.velocities)
        t = np.linspace(0.0, segment.times[-1], 3000)
        poses = object_poses(curve.positions(t), T_tool_object)
        tool = (poses @ np.linalg.inv(T_tool_object))[:, :3, 3]
        speeds = np.linalg.norm(np.diff(tool, axis=0), axis=1) / np.diff(t)
        found.append((segment, poses, speeds))
    return found


def solved(carry: Carry) -> tuple[Problem, Plan]:
    problem = cup_problem()
    task = replace(problem.tasks[0], carry=carry)
    problem = replace(problem, tasks=(task,))
    return problem, pipeline.solve(problem, seed=2)


def test_a_cup_is_carried_as_its_task_wants() -> None:
    free, upright = Upright(3.0, UP), Upright(0.02, UP)
    _, plan = solved(Carry())
    loose = [
        free.tilts(T[:, :3, :3]).max() for _, T, _ in carried(plan.tasks[0].segments)
    ]
    quick = [speeds.max() for _, _, speeds in carried(plan.tasks[0].segments)]
    assert max(loose) > 0.04, "without the rule the cup tilts"
    assert max(quick) > 0.45, "without the rule the tool is quicker"
    _, plan = solved(Carry(upright, max_speed=0.4))
    for _, T, speeds in carried(plan.tasks[0].segments):
        assert upright.tilts(T[:, :3, :3]).max() <= 0.02
        assert speeds.max() <= 0.4
    assert plan.verification is not None
    assert {peak.rule for peak in plan.verification.peaks} == {"tilt", "tool_speed"}


def test_the_speed_of_the_tool_binds_where_it_must() -> None:
    problem, (q_start, q_goal) = bottle_problem(), transfer_ends()
    world = pipeline.CollisionWorld.of_problem(problem).attach("bottle", T_TOOL_OBJECT)
    path = np.vstack([q_start, q_goal])
    durations = []
    for limit in (9.0, 0.2, 0.1):
        limits: MotionLimits = motion_limits(puma(), (ToolSpeed(puma(), limit),))
        motion = time_path(world, path, limits, 0.01).motion
        assert motion is not None
        durations.append(motion.duration)
        t = np.linspace(0.0, motion.duration, 5000)
        tool = object_poses(motion.curve.positions(t), np.eye(4))[:, :3, 3]
        assert (np.linalg.norm(np.diff(tool, axis=0), axis=1) / t[1]).max() <= limit
    unlimited = time_path(world, path, motion_limits(puma()), 0.01).motion
    assert unlimited is not None
    assert durations[0] == unlimited.duration
    assert durations[2] > durations[1] > 1.05 * durations[0]
    assert durations[2] <= 1.1 * 0.4 / 0.1  # the way is 0.4 m


def test_a_lift_that_would_leave_the_region_tilted_ends() -> None:
    problem, q = bottle_problem(), transfer_ends()[0].copy()
    q[6] += 0.3
    low = Region("exempt region 1", (9.0, 9.0, 2.0), shift(0.0, 0.0, 0.0))
    task = replace(problem.tasks[0], carry=Carry(Upright(0.1, UP, (low,))))
    world = pipeline.CollisionWorld.of_problem(problem).attach("bottle", T_TOOL_OBJECT)
    ruled = kept_upright(world, problem, task, world.attached, q)
    motion = straight_motion(ruled, q, UP, 0.3, 0.01)
    z = object_poses(motion.path, T_TOOL_OBJECT)[:, 2, 3]
    assert not motion.complete
    assert "bottle tilts by 0.294 rad" in motion.message
    assert 0.98 < z[-1] <= 1.0
