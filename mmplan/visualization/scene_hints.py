"""What a scene promises before it is solved: reach, and samples of its grasps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mmplan.collision import Scenery
from mmplan.problem import Object, Problem
from mmplan.shapes import Array
from mmplan.visualization.part import GRASPS, REACH, WORLD, Colour, Part, object_carrier
from mmplan.visualization.surface import Surface, joined, ring, tube

_START, _GOAL = Colour(0.16, 0.45, 0.84, 0.3), Colour(0.88, 0.42, 0.08, 0.3)
# Samples of one grasp family, and the size of the glyph that stands for a hand, m.
_SAMPLES = 24
_FINGER, _WIDTH, _WIRE = 0.05, 0.03, 0.0015
# The annuli of start and goal lie this high above the floor, lest they flicker, m.
_HEIGHTS = (0.015, 0.03)


def scene_hints(problem: Problem) -> Iterator[Part]:
    """Annuli in which the base reaches the objects, and hands about these."""
    yield from _annuli(problem)
    for item in problem.objects:
        yield from _grasps(item)


def _annuli(problem: Problem) -> Iterator[Part]:
    """Where the base can stand to reach each end of each task, if it can drive."""
    robot = problem.robot
    if len(robot.base) == 0:
        return
    scenery = Scenery.of_problem(problem)
    annulus = ring(robot.base_radius, robot.reach)
    for number, task in enumerate(problem.tasks):
        centre = scenery.centre_of_mass(task.object)
        T_world_start = problem.object(task.object).T_world_object
        ends = (("start", T_world_start, _START), ("goal", task.T_world_goal, _GOAL))
        for (end, T, colour), height in zip(ends, _HEIGHTS, strict=True):
            place = np.eye(4)
            place[:2, 3] = (T[:3, :3] @ centre + T[:3, 3])[:2]
            place[2, 3] = height
            name = f"reach about the {end} of task {number + 1}"
            yield Part(name, annulus.moved(place), colour, WORLD, REACH)


def _grasps(item: Object) -> Iterator[Part]:
    """Hands at samples of the object's grasp families."""
    rng = np.random.default_rng(0)
    for number, (name, family) in enumerate(item.grasps.items()):
        poses = family.tool_poses(family.genes.sample(_SAMPLES, rng))
        surface = joined([_HAND.moved(T) for T in poses])
        colour = _COLOURS[number % len(_COLOURS)]
        carrier = f"{item.name}, grasps '{name}'"
        yield Part(carrier, surface, colour, object_carrier(item.name), GRASPS)


def _hand() -> Surface:
    """Two fingers, the palm behind them and the wrist, in the tool's frame."""
    outline = [
        [[0.0, side * _WIDTH, 0.01], [0.0, side * _WIDTH, -_FINGER]]
        for side in (-1.0, 1.0)
    ]
    outline.append([[0.0, -_WIDTH, -_FINGER], [0.0, _WIDTH, -_FINGER]])
    outline.append([[0.0, 0.0, -_FINGER], [0.0, 0.0, -2.0 * _FINGER]])
    lines: list[Array] = [np.array(line) for line in outline]
    return joined([tube(line, _WIRE) for line in lines])


_HAND = _hand()
_COLOURS = (
    Colour(0.2, 0.6, 0.3),
    Colour(0.6, 0.2, 0.6),
    Colour(0.2, 0.4, 0.8),
    Colour(0.7, 0.5, 0.1),
)
