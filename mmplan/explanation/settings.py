"""A problem with one task, its world, and changes of both."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from mmplan.collision import (
    TOUCH_TOLERANCE,
    Bounds,
    CollisionWorld,
    Scenery,
    local_bounds,
    moved_bounds,
    overlaps,
)
from mmplan.collision.solids import Solid
from mmplan.explanation.slimming import slimmed
from mmplan.problem import Problem, Task
from mmplan.scoring import End
from mmplan.shapes import Array
from mmplan.zones import Zone


class Setting(NamedTuple):
    """A problem with one task, in its world before that task."""

    problem: Problem
    world: CollisionWorld

    @property
    def task(self) -> Task:
        """The only task."""
        return self.problem.tasks[0]

    def with_task(self, task: Task) -> Setting:
        """The same with another task."""
        return self._replace(problem=replace(self.problem, tasks=(task,)))


@dataclass(frozen=True)
class Change:
    """A change of a setting: in words, how large (m), and what comes of it.

    `apply` gives None where the change is not possible. `removed` names what is taken
    away.
    """

    text: str
    size: float
    apply: Callable[[Setting], Setting | None]
    removed: tuple[str, ...] = ()


def without(setting: Setting, *names: str) -> Change:
    """Obstacles (or links of fixtures) or objects are taken away.

    The size is the sum of their longest edges: about how far they must be moved.
    """
    scenery = setting.world.scenery
    size = sum(_longest_edge(scenery, name) for name in names)
    kinds = ["object" if n in scenery.objects else "obstacle" for n in names]
    named = " and ".join(f"{k} `{n}`" for k, n in zip(kinds, names, strict=True))

    def apply(setting: Setting) -> Setting:
        world = setting.world
        kept = tuple(s for s in world.scenery.obstacles if s.owner not in names)
        world = replace(world, scenery=replace(world.scenery, obstacles=kept))
        for name in set(names) & set(world.standing):
            world = world.without(name)
        return setting._replace(world=world)

    return Change(f"with {named} removed", size, apply, names)


def shifted(end: End, direction: tuple[int, int, int], distance: float) -> Change:
    """The object's pose at one end moves along an axis of the world, m.

    Not possible where the object would stand in something.
    """
    words = {(0, 0, 1): "higher", (0, 0, -1): "lower"}
    axis = "xyz"[int(np.flatnonzero(direction)[0])]
    sign = "-" if sum(direction) < 0 else "+"
    way = words.get(direction, f"towards {sign}{axis}")
    offset = distance * np.array(direction, dtype=np.float64)

    def apply(setting: Setting) -> Setting | None:
        task, world = setting.task, setting.world
        goal = end == End.GOAL
        T = (task.T_world_goal if goal else world.standing[task.object]).copy()
        T[:3, 3] += offset
        if overlaps(world.scenery, task.object, T, TOUCH_TOLERANCE, world.standing):
            return None
        if goal:
            return setting.with_task(replace(task, T_world_goal=T))
        return setting._replace(world=world.place(task.object, T))

    text = f"with the {end.name.lower()} {centimetres(distance)} {way}"
    return Change(text, distance, apply)


def slimmer_object(setting: Setting, by: float) -> Change:
    """The object is scaled across its z so that it is narrower by a length, m."""
    name = setting.task.object
    box = _bounds(setting.world.scenery.objects[name])
    factor = 1.0 - by / float(np.min(2.0 * box.half[:2]))

    def apply(setting: Setting) -> Setting | None:
        if factor <= 0.0:
            return None
        problem, world = setting
        item = problem.object(name)
        item = replace(item, shape=slimmed(item.shape, factor))
        objects = tuple(item if o.name == name else o for o in problem.objects)
        solids = {**world.scenery.objects, name: Scenery.solids_of_object(item)}
        scenery = replace(world.scenery, objects=solids)
        problem = replace(problem, objects=objects)
        return Setting(problem, replace(world, scenery=scenery))

    return Change(f"with the {name} {centimetres(by)} slimmer", by, apply)


def wider_bounds(by: float) -> Change:
    """The base may go farther on all sides, as far as its joints let it, m."""

    def apply(setting: Setting) -> Setting:
        problem, base = setting.problem, setting.problem.robot.base
        bounds = problem.base_bounds.copy()
        bounds[:2] += (-by, by)
        limits = np.stack([base.lower, base.upper], axis=1)
        bounds = np.clip(bounds, limits[:, :1], limits[:, 1:])
        return setting._replace(problem=replace(problem, base_bounds=bounds))

    text = f"with the base allowed {centimetres(by)} beyond its bounds"
    return Change(text, by, apply)


def without_zone(zone: Zone) -> Change:
    """A zone that the base must keep out of is opened to it.

    The size is its longest extent.
    """
    size = float(np.max(np.ptp(zone.corners, axis=0)))

    def apply(setting: Setting) -> Setting:
        problem = setting.problem
        kept = tuple(z for z in problem.forbidden if z.name != zone.name)
        return setting._replace(problem=replace(problem, forbidden=kept))

    return Change(f"with the base allowed in zone `{zone.name}`", size, apply)


def shorter_line(task: Task, segment: str, length: float) -> Change:
    """A straight motion that the scene insists on is shorter, m."""
    wanted: float = getattr(task, segment)
    left = centimetres(length) if length else "nothing"
    text = f"with {left} of {segment} instead of {centimetres(wanted)}"

    def apply(setting: Setting) -> Setting:
        shorter: dict[str, Any] = {segment: length}
        return setting.with_task(replace(setting.task, **shorter))

    return Change(text, wanted - length, apply)


def any_quality(setting: Setting) -> Change:
    """Grasps of low quality are good enough."""
    least = setting.problem.score.min_quality

    def apply(setting: Setting) -> Setting:
        settings = replace(setting.problem.score, min_quality=0.0)
        return setting._replace(problem=replace(setting.problem, score=settings))

    return Change(f"with a min_quality below {least:g}", 0.0, apply)


def _longest_edge(scenery: Scenery, name: str) -> float:
    """The longest edge (m) of the box around all solids of an obstacle or object."""
    solids = scenery.objects.get(name) or tuple(
        s for s in scenery.obstacles if s.owner == name
    )
    return float(np.max(2.0 * _bounds(solids).half))


def _bounds(solids: Sequence[Solid]) -> Bounds:
    """The bounds of all solids in the frame of what they belong to."""
    boxes = [moved_bounds(local_bounds(s.geometry), s.placement[None]) for s in solids]
    lower: Array = np.min([b.centre[0] - b.half[0] for b in boxes], axis=0)
    upper: Array = np.max([b.centre[0] + b.half[0] for b in boxes], axis=0)
    return Bounds((lower + upper) / 2, (upper - lower) / 2)


def centimetres(length: float) -> str:
    """A length (m) in words."""
    return f"{100.0 * length:.3g} cm"
