"""Torque limits: laws of inverse dynamics, and motions that keep them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.collision import CollisionWorld, Scenery, inertia_of
from mmplan.plan import Plan
from mmplan.planning import TimedPath, TorqueLimit, motion_limits, time_path
from mmplan.problem import Object, PlannerSettings, Problem
from mmplan.robot import Robot
from mmplan.robot_build import load_robot
from mmplan.shapes import Array, Box, Cylinder, Revolve, Shape
from mmplan.verification import examine
from tests.honest import bottle_plan, bottle_problem


def inertia(shape: Shape, mass: float) -> pin.Inertia:
    return inertia_of(Scenery.solids_of_object(Object("o", shape, np.eye(4))), mass)


@given(
    size=st.tuples(*[st.floats(0.01, 2.0)] * 3),
    mass=st.floats(0.01, 50.0),
)
def test_the_inertia_of_a_box(size: tuple[float, float, float], mass: float) -> None:
    x, y, z = np.square(size)
    found = inertia(Box(size), mass)
    assert np.isclose(found.mass, mass)
    assert np.allclose(found.lever, 0.0, atol=1e-12)
    expected = mass / 12.0 * np.array([y + z, z + x, x + y])
    assert np.allclose(found.inertia, np.diag(expected), rtol=1e-9, atol=1e-12)


def test_pieces_of_a_ring_weigh_what_the_ring_does() -> None:
    """A pipe of radii 4 and 5 cm, 20 cm long, that is cut into convex pieces."""
    pipe = Revolve(np.array([[0.04, 0.1], [0.05, 0.1], [0.05, 0.3], [0.04, 0.3]]))
    found = inertia(pipe, 2.0)
    along = 2.0 / 2.0 * (0.04**2 + 0.05**2)
    assert np.isclose(found.mass, 2.0)
    assert np.allclose(found.lever, [0.0, 0.0, 0.2], atol=1e-6)
    assert np.isclose(found.inertia[2, 2], along, rtol=0.02)
    across = along / 2.0 + 2.0 * 0.2**2 / 12.0
    assert np.allclose(np.diag(found.inertia)[:2], across, rtol=0.02)


@cache
def weak_panda() -> Robot:
    """A Panda that can just lift what it holds."""
    robot = load_robot("panda_mobile")
    model = robot.model.copy()
    model.upperEffortLimit = 0.47 * model.upperEffortLimit
    return replace(robot, model=model)


HELD = inertia(Cylinder(0.03, 0.1), 1.0)


def swing(robot: Robot, carried: pin.Inertia | None, *, limited: bool) -> TimedPath:
    """The arm turning and rearing up while the base drives."""
    q = np.array([robot.q_neutral, robot.q_neutral])
    q[:, robot.arm.indices] = [
        [0.0, -0.6, 0.0, -2.4, 0.0, 1.9, 0.8],
        [2.2, -1.0, 0.6, -1.2, 0.8, 1.5, -0.8],
    ]
    q[1, robot.base.indices[0]] = 0.2
    problem = Problem("free", robot, q[0], np.zeros((3, 2)), (), (), ())
    more = (TorqueLimit(robot, carried),) if limited else ()
    limits = motion_limits(robot, more)
    motion = time_path(CollisionWorld.of_problem(problem), q, limits, 0.05).motion
    assert motion is not None
    return motion


def shares(robot: Robot, carried: pin.Inertia | None, motion: TimedPath) -> Array:
    """Torques of the arm as shares of its limits, finely, by a model of our own."""
    model = robot.model.copy()
    if carried is not None:
        placement = pin.SE3(robot.T_joint_tool)
        model.appendBodyToJoint(robot.tool_joint, carried, placement)
    data, t = model.createData(), np.linspace(0.0, motion.duration, 4001)[1:-1]
    motions = (
        motion.curve.positions(t),
        motion.curve.velocities(t),
        motion.curve.accelerations(t),
    )
    torques = [pin.rnea(model, data, *row) for row in zip(*motions, strict=True)]
    arm = robot.arm.indices
    found: Array = np.abs(np.array(torques)[:, arm] / model.upperEffortLimit[arm])
    return found


def test_a_limit_that_binds_makes_the_motion_slower_and_is_kept() -> None:
    robot = weak_panda()
    free, kept = (swing(robot, HELD, limited=limited) for limited in (False, True))
    assert shares(robot, HELD, free).max() > 1.02
    assert 0.95 < shares(robot, HELD, kept).max() <= 1.0
    assert kept.duration > 1.01 * free.duration


def test_what_is_carried_counts() -> None:
    robot = weak_panda()
    empty, loaded = (swing(robot, held, limited=True) for held in (None, HELD))
    assert loaded.duration > empty.duration


def test_a_limit_that_does_not_bind_changes_nothing() -> None:
    robot = load_robot("panda_mobile")
    free, kept = (swing(robot, None, limited=limited) for limited in (False, True))
    assert shares(robot, None, free).max() < 0.9
    assert np.allclose(free.times, kept.times, rtol=1e-3)


@pytest.mark.parametrize("slower", [1.0, 1.7, 4.0])
def test_a_motion_slowed_down_as_told_just_keeps_the_limit(slower: float) -> None:
    robot = weak_panda()
    limit = TorqueLimit(robot, HELD)
    motion = swing(robot, HELD, limited=False).stretched(slower)
    factor = limit.stretch(motion.curve)
    assert np.isclose(limit.stretch(motion.stretched(factor).curve), 1.0, rtol=1e-6)


def test_a_weight_that_cannot_be_held_at_any_speed() -> None:
    robot = weak_panda()
    motion = swing(robot, None, limited=False)
    heavy = inertia(Cylinder(0.03, 0.1), 40.0)
    assert TorqueLimit(robot, heavy).stretch(motion.curve) == np.inf
    with pytest.raises(AssertionError):
        swing(robot, heavy, limited=True)
    weak = TorqueLimit(robot, heavy).too_weak(motion.positions[0])
    assert weak is not None
    assert "of its effort limit to stand still" in weak
    assert TorqueLimit(robot).too_weak(motion.positions[0]) is None


def heavy_bottle(mass: float) -> tuple[Plan, Problem]:
    problem = bottle_problem()
    bottle = replace(problem.objects[0], mass=mass)
    planner = replace(PlannerSettings(), torque=True)
    return bottle_plan(), replace(problem, objects=(bottle,), planner=planner)


def test_the_verifier_refuses_a_bottle_that_is_too_heavy() -> None:
    report = examine(*heavy_bottle(1.0))
    assert report.ok
    (peak,) = report.peaks
    assert peak.rule == "torque"
    assert 0.1 < peak.largest < 1.0
    report = examine(*heavy_bottle(30.0))
    assert {fault.kind for fault in report.faults} == {"torque"}
    assert {f.message.split(":")[0] for f in report.faults} == {
        f"task 1 (bottle), {name}" for name in ("lift", "transfer", "lower")
    }
    assert "past its limit of" in report.faults[0].message
