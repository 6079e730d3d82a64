"""Where a picture is taken from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mmplan.exceptions import InputError
from mmplan.shapes import Array
from mmplan.visualization.exhibit import Exhibit
from mmplan.visualization.part import SCENE, WORLD
from mmplan.visualization.surface import joined

FIELD_OF_VIEW = 40.0  # degrees, from the upper to the lower border
_NAMES = "auto, top, start or goal"
_FORM = "AZIMUTH,ELEVATION[,DISTANCE[,X,Y,Z]] in degrees and metres"

# Directions that are tried, degrees.
_AZIMUTHS, _ELEVATIONS = range(0, 360, 15), (22.0, 38.0, 55.0)
# Of the light, beside the camera, degrees; of equals the first is taken.
_SUNS = (50.0, -50.0, 20.0, -20.0)
_SMALL = 0.004  # m², the size of triangles that hide nothing
_ROOM = 0.45  # m about the points that matter, for the robot itself
_CLOSE = 1.3  # m, from the object in the pictures of start and goal


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera that looks at a point from a direction.

    `azimuth` is that of the camera as seen from the target, about z from x;
    `elevation` is its height above the target; both in degrees.
    """

    target: Array  # (3,), m
    azimuth: float
    elevation: float
    distance: float  # m

    @property
    def eye(self) -> Array:
        """Where the camera is, (3,), m."""
        return self.target + self.distance * _direction(self.azimuth, self.elevation)


def camera_of(exhibit: Exhibit, text: str, aspect: float = 1.6) -> Camera:
    """The camera that a text asks for: a name, or numbers; see `docs/viewing.md`.

    `aspect` is the width of the picture by its height.

    Raises:
        InputError: The text is neither.
    """
    best = best_camera(exhibit, aspect)
    if text == "auto":
        return best
    if text == "top":
        return Camera(best.target, best.azimuth, 89.0, best.distance)
    if text in ("start", "goal"):
        return _close_up(exhibit, text == "goal")
    return _numbers(text, best)


def best_camera(exhibit: Exhibit, aspect: float = 1.6) -> Camera:
    """The direction from which most of what matters is in sight, all of it in view."""
    if exhibit.focus is not None:
        return _near(exhibit, exhibit.focus)
    points = _points_of_interest(exhibit)
    target = (points.min(axis=0) + points.max(axis=0)) / 2.0
    radius = float(np.linalg.norm(np.ptp(points, axis=0)) / 2.0) + _ROOM
    half = np.radians(FIELD_OF_VIEW / 2.0) * min(1.0, aspect)
    return _most_seen(exhibit, points, target, 0.9 * radius / float(np.sin(half)))


def sun_of(exhibit: Exhibit, camera: Camera) -> Camera:
    """Where the light comes from: high beside the camera, where it reaches most."""
    points, blockers = _points_of_interest(exhibit), _blockers(exhibit)
    low, high = points.min(axis=0) - 2.0 * _ROOM, points.max(axis=0) + 2.0 * _ROOM
    x, y = np.meshgrid(*np.linspace(low[:2], high[:2], 5).T)
    floor = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.01)], axis=1)
    points = np.concatenate([points, floor])
    suns = [
        replace(camera, azimuth=camera.azimuth + turn, elevation=55.0, distance=6.0)
        for turn in _SUNS
    ]
    return max(suns, key=lambda sun: _seen(sun.eye, points, blockers))


def _close_up(exhibit: Exhibit, goal: bool) -> Camera:
    task = exhibit.problem.tasks[0]
    T = exhibit.problem.object(task.object).T_world_object
    target = (task.T_world_goal if goal else T)[:3, 3]
    return _near(exhibit, target[None])


def _near(exhibit: Exhibit, places: Array) -> Camera:
    """A camera near places (n, 3), from where what is about them is in sight."""
    about = 0.1 * np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
    points = (places[:, None] + about).reshape(-1, 3)
    away = _CLOSE + float(np.linalg.norm(np.ptp(places, axis=0)))
    return _most_seen(exhibit, points, places.mean(axis=0), away)


def _numbers(text: str, best: Camera) -> Camera:
    """The camera of two, three or six numbers."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3, 6) or not np.isfinite(numbers).all():
        raise InputError(f"--camera: expected {_NAMES}, or {_FORM}; got '{text}'")
    azimuth, elevation, *rest = numbers
    if rest and rest[0] <= 0.0:
        raise InputError(f"--camera: the distance must be above 0; got {rest[0]:g}")
    target = np.array(rest[1:]) if len(rest) > 1 else best.target
    return Camera(target, azimuth, elevation, rest[0] if rest else best.distance)


def _points_of_interest(exhibit: Exhibit) -> Array:
    """Places (n, 3) of tool, base and objects all along, and where they are to go."""
    film, problem = exhibit.film, exhibit.problem
    some = np.linspace(0, len(film.times) - 1, 8).round().astype(int)
    ends = [problem.object(t.object).T_world_object[:3, 3] for t in problem.tasks]
    ends += [task.T_world_goal[:3, 3] for task in problem.tasks]
    return np.concatenate([film.tool_path[some], film.base_path[some], ends])


def _most_seen(
    exhibit: Exhibit, points: Array, target: Array, distance: float
) -> Camera:
    """The camera that sees most of the points; of equals, the one on the free side."""
    blockers = _blockers(exhibit)
    heavy = blockers.reshape(-1, 3).mean(axis=0) if len(blockers) else target
    away = target[:2] - heavy[:2]
    free_side = np.degrees(np.arctan2(away[1], away[0]))
    best, most = Camera(target, 0.0, 30.0, distance), -np.inf
    for elevation in _ELEVATIONS:
        for azimuth in _AZIMUTHS:
            camera = Camera(target, float(azimuth), elevation, distance)
            # From beside the free side, so that depth shows.
            turn = np.radians(abs(azimuth - free_side) - 40.0)
            seen = _seen(camera.eye, points, blockers) + 0.1 * np.cos(turn)
            if seen > most + 1e-9:
                best, most = camera, seen
    return best


def _seen(eye: Array, points: Array, triangles: Array) -> float:
    """The share of the points (n, 3) that no triangle (m, 3, 3) hides from the eye.

    A line meets a triangle where its barycentric coordinates are not negative (Möller
    and Trumbore, 1997).
    """
    a, u, v = triangles[:, 0], *(triangles[:, i] - triangles[:, 0] for i in (1, 2))
    way = (points - eye)[:, None]  # (n, 1, 3)
    cross = np.cross(way, v)
    volume = np.einsum("nmi,mi->nm", cross, u)
    scale = 1.0 / np.where(np.abs(volume) > 1e-12, volume, np.inf)
    s = np.einsum("nmi,mi->nm", cross, eye - a) * scale
    turned = np.cross(eye - a, u)
    t = np.einsum("nki,mi->nm", way, turned) * scale
    depth = np.einsum("mi,mi->m", v, turned) * scale
    inside = (s >= 0.0) & (t >= 0.0) & (s + t <= 1.0) & (scale != 0.0)
    hidden = inside & (depth > 0.0) & (depth < 0.97)
    return float(1.0 - hidden.any(axis=1).mean()) if len(triangles) else 1.0


def _blockers(exhibit: Exhibit) -> Array:
    """The triangles (m, 3, 3) that hide things: large ones of what stands still."""
    parts = [p for p in exhibit.parts if (p.carrier, p.layer) == (WORLD, SCENE)]
    surface = joined([p.surface for p in parts])
    corners: Array = surface.vertices[surface.triangles]
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    large: Array = corners[np.linalg.norm(sides, axis=1) > 2.0 * _SMALL]
    return large


def _direction(azimuth: float, elevation: float) -> Array:
    a, e = np.radians([azimuth, elevation])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
