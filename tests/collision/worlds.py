"""Worlds and configurations that the tests of collision share."""

from __future__ import annotations

import warnings
from functools import cache

import coal
import numpy as np
import pinocchio as pin

from mmplan.assets import scenes_folder
from mmplan.collision import CollisionWorld
from mmplan.collision.separation import signed_distance, transform
from mmplan.problem import Object, Obstacle, Problem
from mmplan.scene_file import load_problem
from mmplan.shapes import Array
from tests.honest import puma

SCENES = ("wineglass", "plate")
BOUNDS = np.array([[-3.0, 3.0], [-3.0, 3.0]])


@cache
def scene(name: str) -> Problem:
    return load_problem(scenes_folder() / f"{name}.yaml")


@cache
def shipped(name: str) -> CollisionWorld:
    """A shipped scene with its object standing."""
    return CollisionWorld.of_problem(scene(name))


@cache
def carried(name: str) -> CollisionWorld:
    """A shipped scene with its object in the hand."""
    (item,) = scene(name).objects
    (family,) = item.grasps.values()
    genes = family.genes.sample(1, np.random.default_rng(0))
    T_tool_object = np.linalg.inv(family.tool_poses(genes)[0])
    return shipped(name).attach(item.name, T_tool_object)


@cache
def carrying(name: str, where: str) -> CollisionWorld:
    """A shipped scene with its object `standing` or `attached`."""
    return carried(name) if where == "attached" else shipped(name)


def draw(n: int, seed: int) -> Array:
    """Configurations (n, nq) of the Puma all over the kitchen, some in collision."""
    model, rng = puma().model, np.random.default_rng(seed)
    q = rng.uniform(model.lowerPositionLimit, model.upperPositionLimit, (n, model.nq))
    q[:, 0] = rng.uniform(-0.5, 1.2, n)
    q[:, 1] = rng.uniform(-1.5, 1.5, n)
    return q


def among(*things: Obstacle | Object) -> CollisionWorld:
    """The Puma among a few things."""
    return CollisionWorld.of_problem(problem_of(*things))


def problem_of(*things: Obstacle | Object) -> Problem:
    """The Puma among a few things, with nothing to do."""
    obstacles = tuple(t for t in things if isinstance(t, Obstacle))
    objects = tuple(t for t in things if isinstance(t, Object))
    return Problem("few", puma(), q_tucked(), BOUNDS, obstacles, objects, ())


def q_tucked(x: float = 0.0, y: float = 0.0) -> Array:
    """The arm tucked in, the hand open, the base at (x, y)."""
    robot = puma()
    q = robot.q_neutral.copy()
    q[robot.base.indices] = x, y
    q[robot.arm.indices] = robot.configurations["tucked"]
    return q


def held_at(
    world: CollisionWorld, name: str, q: Array, T_world_object: Array
) -> CollisionWorld:
    """The world in which the object is carried and is at a pose when the robot is at q.

    It need not be anywhere near the hand.
    """
    return world.attach(name, np.linalg.inv(world.robot.tool_pose(q)) @ T_world_object)


def fresh_data(world: CollisionWorld) -> pin.GeometryData:
    """Geometry data that has never been used, without memory from query to query."""
    data = world.geometry.createData()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        for request in data.collisionRequests:
            request.enable_cached_gjk_guess = False
        for request in data.distanceRequests:
            request.enable_cached_gjk_guess = False
    return data


def pair_distances(world: CollisionWorld, q: Array) -> Array:
    """Signed distances (pairs,) at one configuration, each asked for by itself."""
    data, placed = world.model.createData(), world.geometry.createData()
    pin.updateGeometryPlacements(world.model, data, world.geometry, placed, q)
    shapes = [body.geometry for body in world.geometry.geometryObjects]
    poses = [transform(T.homogeneous) for T in placed.oMg]
    return np.array(
        [
            signed_distance(shapes[i], poses[i], shapes[j], poses[j])
            for i, j in world.pairs.tolist()
        ]
    )


def point_distance(solids: list[coal.CollisionGeometry], point: Array) -> float:
    """The distance (m) of a point to the nearest of some solids, negative inside."""
    T, ball = np.eye(4), coal.Sphere(BALL)
    T[:3, 3] = point
    pose, origin = transform(T), transform(np.eye(4))
    return BALL + min(signed_distance(ball, pose, s, origin) for s in solids)


BALL = 1e-4  # m, radius of the ball by which points are felt for
