"""Faults of a problem that only geometry shows, at their places in the scene file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pinocchio as pin

from mmplan.carry import Upright
from mmplan.collision import (
    TOUCH_TOLERANCE,
    CollisionWorld,
    Scenery,
    depth_in_region,
    overlaps,
    solids_of_obstacle,
)
from mmplan.exceptions import InputError
from mmplan.files.document import Document, Fault, KeyPath
from mmplan.problem import Problem
from mmplan.shapes import Array
from mmplan.zones import base_clearances

_MILLIMETRES = 1000.0


def check_geometry(problem: Problem, document: Document) -> None:
    """Refuse a problem whose start or goals cannot be.

    Raises:
        InputError: A shape cannot be made, the robot starts in collision, or an object
            stands in something at its start or at a goal.
    """
    try:
        world = CollisionWorld.of_problem(problem)
    except InputError:  # of the first shape only
        raise document.error(_shape_faults(problem)) from None
    faults = [
        *_zone_faults(problem),
        *_start_faults(problem, world),
        *_object_faults(problem, world),
        *_carry_faults(problem, world.scenery),
        *_torque_faults(problem),
    ]
    if faults:
        raise document.error(faults)


def _shape_faults(problem: Problem) -> Iterator[Fault]:
    for obstacle in problem.obstacles:
        try:
            solids_of_obstacle(obstacle)
        except InputError as error:  # noqa: PERF203
            yield Fault(("obstacles", obstacle.name), str(error))
    for item in problem.objects:
        try:
            Scenery.solids_of_object(item)
        except InputError as error:  # noqa: PERF203
            yield Fault(("objects", item.name), str(error))


def _zone_faults(problem: Problem) -> Iterator[Fault]:
    """Forbidden zones that the base starts in."""
    robot = problem.robot
    q_base = problem.q_start[None, robot.base.indices]
    for zone in problem.forbidden if len(robot.base) else ():
        clearance = float(base_clearances([zone], q_base, robot.base_radius)[0])
        if clearance < 0.0:
            yield Fault(
                ("robot", "start", "base"),
                f"the robot starts {-clearance:.3g} m deep in {zone.name}; the circle "
                f"of radius {robot.base_radius:g} m around its base must keep out",
            )


def _start_faults(problem: Problem, world: CollisionWorld) -> Iterator[Fault]:
    for contact in world.contacts(problem.q_start)[:3]:
        depth = contact.depth * _MILLIMETRES
        yield Fault(
            ("robot", "start"),
            f"the robot starts in collision: {contact.first} is {depth:.1f} mm deep in "
            f"{contact.second}",
        )


def _object_faults(problem: Problem, world: CollisionWorld) -> Iterator[Fault]:
    """Objects that stand in something, at the start and at each task's goal."""
    standing = dict(world.standing)
    for item in problem.objects:
        where: KeyPath = ("objects", item.name, "at")
        yield from _overlaps(world.scenery, item.name, standing, where)
    for number, task in enumerate(problem.tasks):
        standing[task.object] = task.T_world_goal
        yield from _overlaps(
            world.scenery, task.object, standing, ("tasks", number, "to")
        )


def _carry_faults(problem: Problem, scenery: Scenery) -> Iterator[Fault]:
    """Rules of carrying that an object breaks already where a task begins or ends."""
    standing = {item.name: item.T_world_object for item in problem.objects}
    for number, task in enumerate(problem.tasks):
        ends = {"start": standing[task.object], "goal": task.T_world_goal}
        for end, T_world_object in ends.items():
            where: KeyPath = ("tasks", number, "carry")
            what = f"at its {end} {task.object} is"
            yield from _upright_faults(task.carry.upright, T_world_object, what, where)
            for place, region in enumerate(task.carry.forbidden):
                depth = depth_in_region(scenery, task.object, T_world_object, region)
                if depth > 0.0:
                    message = f"{what} {depth * _MILLIMETRES:.1f} mm deep in this box"
                    yield Fault((*where, "forbidden", place), message)
        standing[task.object] = task.T_world_goal


def _upright_faults(
    upright: Upright | None, T_world_object: Array, what: str, where: KeyPath
) -> Iterator[Fault]:
    if upright is None or upright.depths(T_world_object[None, :3, 3])[0] >= 0.0:
        return
    tilt = float(upright.tilts(T_world_object[None, :3, :3])[0])
    if tilt > upright.angle:
        message = f"{what} tilted by {tilt:.4g} rad, and at most {upright.angle:g} are "
        message += "allowed; name the axis that points up, or regions in which it need "
        yield Fault((*where, "upright"), f"{message}not")


def _torque_faults(problem: Problem) -> Iterator[Fault]:
    """What is missing for torques to be limited, or a start that is too heavy."""
    if not problem.planner.torque:
        return
    where: KeyPath = ("planner", "torque")
    robot, model = problem.robot, problem.robot.model
    limits = model.upperEffortLimit[robot.arm.indices]
    still = np.zeros(model.nv)
    held = pin.rnea(model, model.createData(), problem.q_start, still, still)
    for name, limit, torque in zip(
        robot.arm.names, limits, np.abs(held[robot.arm.indices]), strict=True
    ):
        if not 0.0 < limit < np.inf:
            yield Fault(where, f"{robot.name} has no effort limit for {name}")
        elif torque > limit:
            message = f"at its start {robot.name} needs {torque:.4g} at {name} to stand"
            yield Fault(where, f"{message} still, past its effort limit of {limit:g}")
    if not any(model.inertias[model.getJointId(n)].mass for n in robot.arm.names):
        yield Fault(where, f"the arm of {robot.name} has no masses in its URDF")
    for name in dict.fromkeys(task.object for task in problem.tasks):
        if problem.object(name).mass is None:
            yield Fault(("objects", name), "missing key 'mass', for planner.torque")


def _overlaps(
    scenery: Scenery, name: str, standing: Mapping[str, Array], where: KeyPath
) -> Iterator[Fault]:
    deep = overlaps(scenery, name, standing[name], TOUCH_TOLERANCE, standing)
    for owner, overlap in sorted(deep.items(), key=lambda item: -item[1].depth):
        depth, most = (_MILLIMETRES * length for length in overlap)
        yield Fault(
            where,
            f"{name} is {depth:.1f} mm deep in {owner}; what it stands on it may "
            f"overlap by at most {most:.3g} mm",
        )
