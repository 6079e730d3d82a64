"""From a well-formed scene file to a problem that can be computed with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from mmplan.carry import Carry, Region, Upright
from mmplan.collision import Scenery
from mmplan.exceptions import InputError
from mmplan.files.carry_sections import CarrySection, RegionSection, UprightSection
from mmplan.files.document import Fault
from mmplan.files.robot_composition import pose_of
from mmplan.files.scene_sections import (
    BoundsSection,
    ObstacleSection,
    SceneSection,
    StartSection,
)
from mmplan.fixed_base import hold_base, stand_at
from mmplan.grasp_build import default_grasps, named_grasps
from mmplan.grasps import GraspFamily
from mmplan.problem import Object, Obstacle, Problem, Task
from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.scene_reader import SceneFile
from mmplan.scene_values import pose, shape
from mmplan.shapes import Array, Fixture, read_only
from mmplan.zones import Zone

BOUNDS_MARGIN = 1.5  # of the robot's reach, around the start and all poses


def build_problem(scene: SceneFile) -> Problem:
    """The problem of a scene, whose geometry is not checked yet.

    Raises:
        InputError: The robot's model cannot be built.
    """
    section = scene.section
    robot = _robot(scene)
    return Problem(
        name=section.name,
        robot=robot,
        q_start=_start(robot, section.robot.start),
        base_bounds=_base_bounds(robot, section),
        obstacles=tuple(
            _obstacle(scene, name, o) for name, o in section.obstacles.items()
        ),
        objects=tuple(_objects(scene, robot)),
        tasks=_tasks(section),
        score=section.score.settings(),
        optimizer=section.optimizer.settings(),
        planner=section.planner.settings(),
        forbidden=tuple(
            Zone(f"forbidden zone {number}", read_only(zone.corners))
            for number, zone in enumerate(section.robot.forbidden, start=1)
        ),
        path=scene.document.path,
        fingerprint=scene.fingerprint(),
    )


def _robot(scene: SceneFile) -> Robot:
    """The robot, at its place if it has no mobile base, or held where it starts."""
    section, description = scene.section.robot, scene.robot
    if section.at is not None:
        description = stand_at(description, pose_of(section.at))
    if section.base == "fixed" and description.base_joints:
        description = hold_base(description, section.start.base)
    return build_robot(description)


def _start(robot: Robot, start: StartSection) -> Array:
    """The start configuration (nq,)."""
    leads = robot.hand.leads
    hand = {"open": robot.hand_open[leads], "closed": robot.hand_closed[leads]}
    q = np.zeros(robot.model.nq)
    q[robot.base.indices] = start.base[: len(robot.base)]
    q[robot.arm.indices] = _named(start.arm, robot.configurations)
    q[robot.hand.indices[leads]] = _named(start.hand, hand)
    return read_only(robot.with_followers(q))


def _named(value: str | tuple[float, ...], known: dict[str, Array]) -> Array:
    return known[value] if isinstance(value, str) else np.array(value)


def _base_bounds(robot: Robot, section: SceneSection) -> Array:
    """Where the base may go, (base joints, 2), within its joint limits.

    Where the scene says nothing: the box around the start and all poses, grown by
    `BOUNDS_MARGIN` times the robot's reach.
    """
    limits = np.stack([robot.base.lower, robot.base.upper], axis=1)
    if len(limits) == 0:
        return read_only(limits)
    poses = [o.at for o in section.objects.values()] + [t.to for t in section.tasks]
    start = section.robot.start.base[:2]
    points = np.array([start, *(p.xyz[:2] for p in poses)])
    margin = BOUNDS_MARGIN * robot.reach
    bounds = np.stack(
        [points.min(axis=0) - margin, points.max(axis=0) + margin], axis=1
    )
    for axis, given in enumerate(_given(section.robot.bounds)):
        if given is not None:
            bounds[axis] = given
    bounds = np.clip(bounds, limits[:2, :1], limits[:2, 1:])
    return read_only(np.concatenate([bounds, limits[2:]]))


def _given(bounds: BoundsSection) -> Sequence[tuple[float, float] | None]:
    return (bounds.x, bounds.y)


def _obstacle(scene: SceneFile, name: str, section: ObstacleSection) -> Obstacle:
    if section.urdf is not None:
        configuration = tuple(section.configuration.items())
        fixture = Fixture(scene.folder / section.urdf, configuration)
        return Obstacle(name, fixture, pose(section.at), section.ground)
    solid = shape(section, scene.folder)
    return Obstacle(name, solid, pose(section.at), section.ground)


def _objects(scene: SceneFile, robot: Robot) -> Iterator[Object]:
    """The objects; one that a task moves has the grasps of its shape if no others."""
    moved = {task.move for task in scene.section.tasks}
    for name, section in scene.section.objects.items():
        solid = shape(section, scene.folder)
        item = Object(name, solid, pose(section.at), {}, section.mass, section.friction)
        yield (
            replace(item, grasps=_grasps(scene, item, robot)) if name in moved else item
        )


def _grasps(scene: SceneFile, item: Object, robot: Robot) -> dict[str, GraspFamily]:
    """The grasps of an object; none if its shape is at fault, which is found later.

    Raises:
        InputError: The hand cannot grasp it so, with the place in the scene.
    """
    section = scene.section.objects[item.name]
    try:
        Scenery.solids_of_object(item)
    except InputError:
        return {}
    families, faults = named_grasps(section, item, robot, scene.folder)
    if not section.grasps:
        try:
            families = default_grasps(item, robot)
        except InputError as error:
            faults = [Fault(("objects", item.name), str(error), at_key=True)]
    if faults:
        raise scene.document.error(faults)
    return families


def _tasks(section: SceneSection) -> tuple[Task, ...]:
    return tuple(
        Task(
            t.move, pose(t.to), t.approach, t.lift, t.lower, t.retreat, _carry(t.carry)
        )
        for t in section.tasks
    )


def _carry(section: CarrySection) -> Carry:
    upright = section.upright_keys
    return Carry(
        upright=None if upright is None else _upright(upright),
        max_speed=section.max_speed,
        forbidden=_regions("forbidden region", section.forbidden),
    )


def _upright(section: UprightSection) -> Upright:
    axis = np.array(section.axis)
    return Upright(
        angle=section.angle,
        axis=read_only(axis / np.linalg.norm(axis)),
        exempt=_regions("exempt region", section.outside),
    )


def _regions(name: str, sections: Sequence[RegionSection]) -> tuple[Region, ...]:
    return tuple(
        Region(f"{name} {number}", section.box, pose(section.at))
        for number, section in enumerate(sections, start=1)
    )
