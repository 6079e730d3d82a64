"""What planning does to its process: interrupts, exceptions, output, imports."""

import os
import signal
import subprocess
import sys
import time

import pytest

from mmplan.planning import available_planners

WORLD = """
import sys
from dataclasses import replace
import numpy as np
import coal, pinocchio as pin
from mmplan.planning import *
from mmplan.problem import PlannerSettings

class World:
    def __init__(self):
        self.model, self.geometry = pin.Model(), pin.GeometryModel()
        joint = 0
        for kind, name in ((pin.JointModelPX(), "x"), (pin.JointModelPY(), "y")):
            joint = self.model.addJoint(joint, kind, pin.SE3.Identity(), name)
        body = pin.GeometryObject("point", joint, pin.SE3.Identity(), coal.Sphere(1e-6))
        self.geometry.addGeometryObject(body)
    def in_collision(self, q):
        return np.abs(q[:, 0]) < 0.1 if self.closed else \\
            (np.abs(q[:, 0]) < 0.1) & (np.abs(q[:, 1] - 0.8) > 0.1)
    def any_collision(self, q):
        return bool(self.in_collision(q).any())
    def contacts(self, q):
        return []

world = World()
world.closed = False
joints = MovingJoints(
    ("x", "y"), np.arange(2), -np.ones(2), np.ones(2), np.zeros(2, bool), np.ones(2)
)
round_joints = replace(joints, wraps=np.array([False, True]))
limits = MotionLimits(np.ones(2), np.ones(2))

def plan(joints=joints, **settings):
    settings = PlannerSettings(**settings)
    ends = np.array([[-0.5, -0.5], [0.5, -0.5]])
    rng = np.random.default_rng(0)
    return plan_path(world, ends[0], ends[1:], joints, settings, rng)
"""


def run(script):
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", WORLD + script],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.mark.parametrize("name", available_planners())
def test_found_or_not_nothing_is_printed(name):
    done = run(f"""
world.closed = True
assert not plan(name={name!r}, iterations=200).found
world.closed = False
result = plan(name={name!r})
assert result.found and plan(name={name!r}).found
assert time_path(world, result.path, limits, 0.01).motion is not None
""")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_joints_that_wrap_leak_nothing_either():
    done = run("""
assert plan(round_joints).found
world.closed = True
assert not plan(round_joints, iterations=100).found
""")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_drives_leak_nothing_either():
    done = run("""
world.model.addJoint(2, pin.JointModelRZ(), pin.SE3.Identity(), "heading")
bounds = np.array([[-1.0, 1.0], [-1.0, 1.0], [-np.inf, np.inf]])
ends = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0]])
def drive(**settings):
    settings, rng = PlannerSettings(**settings), np.random.default_rng(0)
    car = ReedsShepp(0.1)
    return plan_drive(world, *ends, np.arange(3), bounds, car, settings, rng).drive
assert drive() is not None
world.closed = True
assert drive(iterations=50) is None
""")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_an_exception_inside_a_check_comes_out_and_leaks_nothing():
    done = run("""
def fail(q):
    if fail.calls == 20:
        raise RuntimeError("the check broke")
    fail.calls += 1
    return World.any_collision(world, q)
fail.calls = 0
world.any_collision = fail
try:
    plan()
except RuntimeError as error:
    print(error)
world.any_collision = lambda q: World.any_collision(world, q)
assert plan().found
""")
    assert (done.returncode, done.stdout, done.stderr) == (0, "the check broke\n", "")


def test_an_uncaught_exception_leaves_only_its_traceback():
    done = run("""
def fail(q):
    if fail.calls == 20:
        raise RuntimeError("the check broke")
    fail.calls += 1
    return World.any_collision(world, q)
fail.calls = 0
world.any_collision = fail
plan()
""")
    assert done.returncode == 1
    assert done.stderr.startswith("Traceback")
    assert done.stderr.endswith("RuntimeError: the check broke\n")
    assert "nanobind" not in done.stderr


def test_an_interrupt_ends_a_search_at_once():
    script = """
world.closed = True
print("ready", flush=True)
try:
    plan(iterations=10**9, time_limit=1e9)
except KeyboardInterrupt:
    print("interrupted")
    sys.exit(130)
"""
    with subprocess.Popen(
        [sys.executable, "-c", WORLD + script],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.3)
        os.kill(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=20)
    assert (process.returncode, out, err) == (130, "interrupted\n", "")


def test_toppra_does_without_matplotlib_until_it_is_used():
    done = run("""
motion = time_path(world, np.array([[0.5, 0.0], [0.5, 0.5]]), limits, 0.01).motion
assert motion is not None
assert "toppra" in sys.modules
assert not [name for name in sys.modules if name.startswith("matplotlib")]
try:
    import matplotlib.pyplot
except ImportError:
    sys.exit(0)
from toppra.algorithm import algorithm
assert matplotlib.__file__
assert algorithm.plt.figure is matplotlib.pyplot.figure
""")
    assert (done.returncode, done.stderr) == (0, "")


def test_a_user_of_ompl_keeps_the_log_level():
    done = run("""
from ompl import util
util.setLogLevel(util.LogLevel.LOG_ERROR)
assert plan().found
assert util.getLogLevel() == util.LogLevel.LOG_ERROR
""")
    assert (done.returncode, done.stderr) == (0, "")
