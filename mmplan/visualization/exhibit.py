"""What there is to see of a plan or a scene, whatever draws it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mmplan.kinematics import joint_placements
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.shapes import Array
from mmplan.visualization.film import Film, film_of_plan, film_of_scene
from mmplan.visualization.part import PATHS, ROBOT, WORLD, Colour, Part
from mmplan.visualization.robot_parts import joint_poses, robot_parts
from mmplan.visualization.scenery_parts import object_parts, obstacle_parts
from mmplan.visualization.surface import Surface, tube

# Moments of a film a second.
RATE = 30.0

START_COLOUR = Colour(0.16, 0.45, 0.84)
GOAL_COLOUR = Colour(0.88, 0.42, 0.08)
_GHOST_OPACITY = 0.35
_PATH_RADIUS = 0.006  # m
_SWELL = 0.001  # m


@dataclass(frozen=True, eq=False)
class Exhibit:
    """Parts and the film that they move in.

    Where a `focus` is given, pictures look at these points from near by.
    """

    title: str
    subtitle: str
    problem: Problem
    plan: Plan | None
    parts: tuple[Part, ...]
    film: Film
    focus: Array | None = None  # (n, 3), m

    def robot_parts(self) -> tuple[Part, ...]:
        """The parts of the robot's links."""
        return tuple(p for p in self.parts if p.layer == ROBOT)


def exhibit_of_plan(problem: Problem, plan: Plan, rate: float = RATE) -> Exhibit:
    """A plan: its film, the paths of tool and base, where the object is to go."""
    film = film_of_plan(problem, plan, rate)
    parts = [*_world(problem), *_goals(problem), *_paths(film)]
    subtitle = f"{plan.robot}, seed {plan.seed}, {film.duration:.2f} s of motion"
    return Exhibit(plan.scene, subtitle, problem, plan, tuple(parts), film)


def exhibit_of_scene(problem: Problem) -> Exhibit:
    """A scene before any plan: where objects are to go, what is in reach, grasps."""
    # Grasp families and reach are for scenes alone.
    from mmplan.visualization.scene_hints import scene_hints

    parts = [*_world(problem), *_goals(problem), *scene_hints(problem)]
    film = film_of_scene(problem)
    subtitle = f"{problem.robot.name}, {len(problem.tasks)} tasks, not solved"
    return Exhibit(problem.name, subtitle, problem, None, tuple(parts), film)


def exhibit_of_moment(
    problem: Problem, q: Array, standing: Mapping[str, Array], more: Iterable[Part]
) -> Exhibit:
    """The robot at q (nq,), objects where they are `standing`, and some parts more."""
    parts = [*_world(problem), *_goals(problem), *more]
    objects = tuple(
        replace(o, T_world_object=standing[o.name]) for o in problem.objects
    )
    film = film_of_scene(replace(problem, q_start=q, objects=objects))
    return Exhibit(problem.name, problem.robot.name, problem, None, tuple(parts), film)


def robot_at(exhibit: Exhibit, q: Array, colour: Colour, name: str) -> Iterator[Part]:
    """The robot once more, as a ghost that stands still at q (nq,)."""
    robot = exhibit.problem.robot
    poses = joint_poses(robot, joint_placements(robot.model, q[None]))
    for number, part in enumerate(exhibit.robot_parts()):
        T = poses[part.carrier][0] if part.carrier in poses else np.eye(4)
        ghost = part.ghost(colour, WORLD, f"{name}/{number}")
        yield replace(ghost, surface=part.surface.moved(T))


def translucent(colour: Colour) -> Colour:
    """The colour of a ghost."""
    return colour._replace(opacity=_GHOST_OPACITY)


def _world(problem: Problem) -> Iterator[Part]:
    yield from robot_parts(problem.robot)
    for obstacle in problem.obstacles:
        yield from obstacle_parts(obstacle)
    for number, item in enumerate(problem.objects):
        yield from object_parts(item, number)


def _goals(problem: Problem) -> Iterator[Part]:
    """Ghosts of each object where it starts and where its tasks want it."""
    for number, item in enumerate(problem.objects):
        ends = [task for task in problem.tasks if task.object == item.name]
        if not ends:
            continue
        places = [("start", item.T_world_object, START_COLOUR)]
        places += [
            (f"goal {k + 1}", t.T_world_goal, GOAL_COLOUR) for k, t in enumerate(ends)
        ]
        for part in object_parts(item, number):
            for place, T, colour in places:
                ghost = part.ghost(
                    translucent(colour), WORLD, f"{part.name} at its {place}"
                )
                yield replace(ghost, surface=_swollen(part.surface).moved(T))


def _swollen(surface: Surface) -> Surface:
    """The surface a little outside of itself, to be seen about the object itself."""
    vertices = surface.vertices + _SWELL * surface.normals
    return Surface(vertices, surface.triangles)


def _paths(film: Film) -> Iterator[Part]:
    for name, path, colour in (
        ("path of the tool", film.tool_path, Colour(0.55, 0.1, 0.5)),
        ("path of the base", film.base_path, Colour(0.1, 0.1, 0.1)),
    ):
        points = _thinned(path + np.array([0.0, 0.0, _PATH_RADIUS]))
        if len(points) > 1:
            yield Part(name, tube(points, _PATH_RADIUS), colour, WORLD, PATHS)


def _thinned(path: Array) -> Array:
    """The points of a path (n, 3) that are at least 2 cm from those before."""
    kept = [path[0]]
    for point in path[1:]:
        if np.linalg.norm(point - kept[-1]) >= 0.02:
            kept.append(point)
    return np.array(kept)
