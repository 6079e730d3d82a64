"""A small honest plan made by hand: a bottle moved along a counter by a Puma."""

from __future__ import annotations

from functools import cache

import numpy as np

from mmplan import assets
from mmplan.collision import CollisionWorld
from mmplan.plan import Plan, Segment, TaskEnd, TaskPlan
from mmplan.plan_assembly import assemble_plan
from mmplan.problem import Object, Obstacle, Problem, Task
from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.robot_file import load_robot_description
from mmplan.shapes import Array, Box, Cylinder, read_only

BOTTLE_RADIUS = 0.03
COUNTER_TOP = 0.75
# The hand comes along x, its fingers close along y, 12 cm above the counter.
T_OBJECT_TOOL = read_only(
    [[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.02], [0, 0, 0, 1]]
)
BASE_X = 0.15  # m, the bottle stands 0.75 m ahead
MOVED = 0.4  # m, along y


def shift(x: float, y: float, z: float) -> Array:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


@cache
def puma() -> Robot:
    path = assets.robots_folder() / "puma_mobile" / "robot.yaml"
    return build_robot(load_robot_description(path))


def bottle_problem(*more: Obstacle) -> Problem:
    """A bottle on a counter, to be moved along it; `more` obstacles if wanted."""
    floor = Obstacle("floor", Box((8, 8, 0.1)), shift(0, 0, -0.05), ground=True)
    counter = Obstacle(
        "counter",
        Box((0.5, 2.4, COUNTER_TOP)),
        shift(1.0, 0, COUNTER_TOP / 2),
    )
    bottle = Object(
        "bottle", Cylinder(BOTTLE_RADIUS, 0.2), shift(0.9, 0, COUNTER_TOP + 0.1)
    )
    robot = puma()
    q_start = _configurations(robot)["start"]
    return Problem(
        name="bottle",
        robot=robot,
        q_start=q_start,
        base_bounds=np.array([[-3.0, 3.0], [-3.0, 3.0]]),
        obstacles=(floor, counter, *more),
        objects=(bottle,),
        tasks=(Task("bottle", shift(0.9, MOVED, COUNTER_TOP + 0.1)),),
        fingerprint="0123",
    )


@cache
def _configurations(robot: Robot) -> dict[str, Array]:
    """Where the robot stops on its way, by name."""
    hand = {"open": robot.hand_open, "closed": _closed_hand(robot)}
    arm = _arm_configurations(robot)
    stops = {
        "start": (-0.65, 0.0, "before", "open"),
        "before": (BASE_X, 0.0, "before", "open"),
        "around": (BASE_X, 0.0, "at", "open"),
        "held": (BASE_X, 0.0, "at", "closed"),
        "lifted": (BASE_X, 0.0, "above", "closed"),
        "lifted_goal": (BASE_X, MOVED, "above", "closed"),
        "held_goal": (BASE_X, MOVED, "at", "closed"),
        "around_goal": (BASE_X, MOVED, "at", "open"),
        "away": (BASE_X, MOVED, "before", "open"),
    }
    configurations = {}
    for name, (x, y, arm_name, hand_name) in stops.items():
        q = np.zeros(robot.model.nq)
        q[robot.base.indices] = x, y
        q[robot.arm.indices] = arm[arm_name]
        q[robot.hand.indices] = hand[hand_name]
        configurations[name] = read_only(q)
    return configurations


def _closed_hand(robot: Robot) -> Array:
    """Finger joints at which the pads are half a bottle from the middle of the hand."""
    world = CollisionWorld.of_problem(_bare_problem(robot))
    low, high = robot.hand_closed, robot.hand_open
    for _ in range(40):
        q = np.zeros(robot.model.nq)
        q[robot.hand.indices] = middle = (low + high) / 2
        at_tool = world.place(
            "bottle", robot.tool_pose(q) @ np.linalg.inv(T_OBJECT_TOOL)
        )
        low, high = (middle, high) if at_tool.any_collision(q[None]) else (low, middle)
    return high


def _bare_problem(robot: Robot) -> Problem:
    bottle = Object("bottle", Cylinder(BOTTLE_RADIUS, 0.2), np.eye(4))
    bounds = np.array([[-3.0, 3.0], [-3.0, 3.0]])
    q = np.zeros(robot.model.nq)
    return Problem("bare", robot, q, bounds, (), (bottle,), ())


def _arm_configurations(robot: Robot) -> dict[str, Array]:
    """Joints of the arm with the tool at the bottle, 12 cm before it and 8 above."""
    T_base_tool = shift(0.75, 0, COUNTER_TOP + 0.1) @ T_OBJECT_TOOL
    T = np.array([T_base_tool, shift(-0.12, 0, 0) @ T_base_tool])
    T = np.array([*T, shift(0, 0, 0.08) @ T_base_tool])
    solutions = robot.ik.solve(T)
    branch = np.flatnonzero(solutions.within.all(axis=0))[0]
    return dict(zip(("at", "before", "above"), solutions.q[:, branch], strict=True))


def rest_to_rest(
    name: str, q: Array, q_end: Array, attached: dict[str, Array]
) -> Segment:
    """A straight motion of the joints within the robot's limits."""
    robot, way = puma(), np.abs(q_end - q)
    duration = 0.1
    for group in (robot.base, robot.arm, robot.hand):
        part = way[group.indices]
        duration = max(duration, float(np.max(1.5 * part / group.velocity)))
        duration = max(duration, float(np.max(np.sqrt(6 * part / group.acceleration))))
    times = np.linspace(0.0, duration * 1.001, 12)
    s = (times / times[-1])[:, None]
    return Segment(
        name=name,
        times=times,
        positions=q + (q_end - q) * (3 * s**2 - 2 * s**3),
        velocities=(q_end - q) * (6 * s - 6 * s**2) / times[-1],
        attached=attached,
    )


def bottle_plan() -> Plan:
    """An honest plan for `bottle_problem()`."""
    robot = puma()
    q = _configurations(robot)
    held = {"bottle": read_only(np.linalg.inv(T_OBJECT_TOOL))}
    segments = (
        rest_to_rest("transit", q["start"], q["before"], {}),
        rest_to_rest("approach", q["before"], q["around"], {}),
        rest_to_rest("grasp", q["around"], q["held"], {}),
        rest_to_rest("lift", q["held"], q["lifted"], held),
        rest_to_rest("transfer", q["lifted"], q["lifted_goal"], held),
        rest_to_rest("lower", q["lifted_goal"], q["held_goal"], held),
        rest_to_rest("release", q["held_goal"], q["around_goal"], {}),
        rest_to_rest("retreat", q["around_goal"], q["away"], {}),
    )
    task = TaskPlan(
        object="bottle",
        grasp="side",
        genes=np.array([0.12, 0.5]),
        T_object_tool=T_OBJECT_TOOL,
        hand_open=robot.hand_open,
        hand_closed=q["held"][robot.hand.indices],
        start=TaskEnd(q["held"][robot.base.indices], {"manipulability": 31.0}),
        goal=TaskEnd(q["held_goal"][robot.base.indices], {"manipulability": 31.0}),
        segments=segments,
    )
    return assemble_plan(bottle_problem(), (task,), seed=7)
