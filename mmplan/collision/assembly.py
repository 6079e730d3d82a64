"""One Pinocchio geometry model of robot, obstacles and objects, with its pairs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.carry import Region
from mmplan.collision.bounds import local_bounds, touching_depth
from mmplan.collision.regions import solid_of_region
from mmplan.collision.scenery import Scenery
from mmplan.collision.solids import Solid
from mmplan.robot import Robot
from mmplan.shapes import Array


class Body(NamedTuple):
    """One convex body of a geometry model."""

    owner: str  # the link, obstacle (or fixture/link) or object it belongs to
    kind: str  # base, arm, finger, ground, obstacle, standing, attached or region
    joint: int  # the joint that moves it, 0 for none


class TouchRules(NamedTuple):
    """Who may touch whom.

    `fingers` are the objects that the finger links may touch; `supports` maps
    (object, obstacle) to the depth (m) down to which the one may press into the other,
    which thin bodies may not use in full, see `touching_depth`.
    """

    fingers: frozenset[str] = frozenset()
    supports: Mapping[tuple[str, str], float] = {}


class Clearance(NamedTuple):
    """The distance to keep (m), but not between the pairs of owners in `spared`."""

    distance: float = 0.0
    spared: frozenset[frozenset[str]] = frozenset()


class Assembly(NamedTuple):
    """The geometry model with what is known of its bodies and pairs."""

    geometry: pin.GeometryModel
    bodies: tuple[Body, ...]
    pairs: npt.NDArray[np.int64]  # (p, 2), indices into bodies
    allowed_depth: Array  # (p,), m, negative where a distance must be kept


def assemble(
    robot: Robot,
    scenery: Scenery,
    standing: Mapping[str, Array],
    attached: Mapping[str, Array],
    touch: TouchRules,
    pair_filter: Callable[[Body, Body], bool] | None,
    clearance: Clearance,
    regions: Sequence[Region] = (),
) -> Assembly:
    """Put the world together; see `CollisionWorld` for which pairs are checked.

    Where there is a `pair_filter`, only the pairs that it accepts are. Pairs with the
    scene and with what is carried must keep the `clearance`. What is carried must keep
    out of the `regions`.
    """
    geometry, bodies = _among_obstacles(robot, scenery)
    geometry, bodies = geometry.clone(), bodies.copy()
    for region in regions:
        _add(geometry, bodies, solid_of_region(region), "region", 0, np.eye(4))
    for name, T_world_object in standing.items():
        for solid in scenery.objects[name]:
            _add(geometry, bodies, solid, "standing", 0, T_world_object)
    for name, T_tool_object in attached.items():
        T_joint_object = robot.T_joint_tool @ T_tool_object
        for solid in scenery.objects[name]:
            _add(geometry, bodies, solid, "attached", robot.tool_joint, T_joint_object)
    pairs = _own_pairs(robot) + _scene_pairs(bodies, touch)
    if pair_filter is not None:
        pairs = [(i, j) for i, j in pairs if pair_filter(bodies[i], bodies[j])]
    _set_pairs(geometry, pairs)
    depths = {
        (a, b): _allowed_depth(a, b, touch, clearance)
        for a, b in {(bodies[i], bodies[j]) for i, j in pairs}
    }
    depth = [_limited(geometry, i, j, depths[bodies[i], bodies[j]]) for i, j in pairs]
    return Assembly(
        geometry,
        tuple(bodies),
        np.array(pairs, dtype=np.int64).reshape(-1, 2),
        np.array(depth),
    )


@lru_cache(maxsize=4)
def _among_obstacles(
    robot: Robot, scenery: Scenery
) -> tuple[pin.GeometryModel, list[Body]]:
    """The bodies of robot and obstacles, for worlds to begin with copies of.

    Pinocchio takes a time for each body that rises with the number of bodies.
    """
    geometry = robot.geometry.clone()
    bodies = [
        Body(robot.link_of(g), robot.kind_of(g), int(g.parentJoint))
        for g in geometry.geometryObjects
    ]
    for solid in scenery.obstacles:
        kind = "ground" if scenery.is_ground(solid.owner) else "obstacle"
        _add(geometry, bodies, solid, kind, 0, np.eye(4))
    return geometry, bodies


def _add(
    geometry: pin.GeometryModel,
    bodies: list[Body],
    solid: Solid,
    kind: str,
    joint: int,
    T_joint_owner: Array,
) -> None:
    placement = pin.SE3(T_joint_owner @ solid.placement)
    name = f"{solid.owner}#{len(bodies)}"
    geometry.addGeometryObject(
        pin.GeometryObject(name, joint, placement, solid.geometry)
    )
    bodies.append(Body(solid.owner, kind, joint))


def _own_pairs(robot: Robot) -> list[tuple[int, int]]:
    return [(int(p.first), int(p.second)) for p in robot.geometry.collisionPairs]


def _scene_pairs(bodies: list[Body], touch: TouchRules) -> list[tuple[int, int]]:
    """Pairs of the moving bodies with the scene's, and of carried with the robot's.

    Regions are there for what is carried alone, which comes last.
    """
    moving = ("base", "arm", "finger", "attached")
    movers = [i for i, body in enumerate(bodies) if body.kind in moving]
    return [
        (i, j)
        for j, scene in enumerate(bodies)
        if scene.kind not in (*moving[:3], "region")
        for i in (range(j) if scene.kind == "attached" else movers)
        if i < j and bodies[i].joint != scene.joint
        if not _may_touch(bodies[i], scene, touch)
    ]


def _may_touch(mover: Body, scene: Body, touch: TouchRules) -> bool:
    """Whether a pair is left out: base and ground, fingers and what they hold."""
    if mover.kind == "base":
        return scene.kind == "ground"
    return mover.kind == "finger" and scene.owner in touch.fingers


def _allowed_depth(a: Body, b: Body, touch: TouchRules, clearance: Clearance) -> float:
    for pair in ((a.owner, b.owner), (b.owner, a.owner)):
        if pair in touch.supports:
            return touch.supports[pair]
    robot = ("base", "arm", "finger")
    own = a.kind in robot and b.kind in robot
    if own or frozenset((a.owner, b.owner)) in clearance.spared:
        return 0.0
    return -clearance.distance


def _limited(geometry: pin.GeometryModel, i: int, j: int, depth: float) -> float:
    """What of a depth thin bodies may use; less than none stays as it is."""
    if depth <= 0.0:
        return depth
    first, second = (local_bounds(geometry.geometryObjects[k].geometry) for k in (i, j))
    return touching_depth(first, second, depth)


def _set_pairs(geometry: pin.GeometryModel, pairs: list[tuple[int, int]]) -> None:
    geometry.removeAllCollisionPairs()
    for i, j in pairs:
        geometry.addCollisionPair(pin.CollisionPair(i, j))
