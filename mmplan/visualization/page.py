"""One page that shows an exhibit by itself: no server, no network, no libraries."""

from __future__ import annotations

import base64
import json
import re
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mmplan.atomic_file import write_whole
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.shapes import Array, Cylinder
from mmplan.visualization.camera import FIELD_OF_VIEW, best_camera, sun_of
from mmplan.visualization.clearance import ClearanceCurve
from mmplan.visualization.exhibit import Exhibit
from mmplan.visualization.part import ROBOT, SCENE, WORLD, Part, object_carrier
from mmplan.visualization.robot_parts import joint_poses
from mmplan.visualization.rotations import pose_numbers
from mmplan.visualization.search import CandidateEnd, Search, ShownCandidate
from mmplan.visualization.smoothing import with_edges
from mmplan.visualization.surface import Surface, Triangles, surface_of

_WEB = Path(__file__).parent / "web"
_FILES = ("page.css", "matrices.js", "drawing.js", "panel.js", "page.js")


def write_page(
    path: Path,
    exhibit: Exhibit,
    clearance: ClearanceCurve | None = None,
    searches: Sequence[Search] = (),
) -> None:
    """Write a page; it is there whole or not at all.

    Raises:
        InputError: The file cannot be written.
    """
    write_whole(path, page_text(exhibit, clearance, searches))


def page_text(
    exhibit: Exhibit,
    clearance: ClearanceCurve | None = None,
    searches: Sequence[Search] = (),
) -> str:
    """The page as text."""
    numbers = _Numbers()
    content = _content(exhibit, numbers)
    content["clearance"] = None if clearance is None else _clearance(clearance)
    content["searches"] = [_search(exhibit, search) for search in searches]
    pieces = {name: (_WEB / name).read_text(encoding="utf-8") for name in _FILES}
    # No text of the user's can end the element that it stands in.
    pieces["content"] = json.dumps(content, allow_nan=False).replace("<", "\\u003c")
    pieces["numbers"] = numbers.text()
    page = (_WEB / "page.html").read_text(encoding="utf-8")
    # All at once, as what is put in may look like a place to put something in.
    return re.sub(r"\{\{([\w.]+)\}\}", lambda place: pieces[place[1]], page)


class _Numbers:
    """Arrays in one block of bytes; places in it are offsets in bytes."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def add(self, array: Array | Triangles, kind: str) -> tuple[int, int]:
        """Append an array as numbers of a kind; its offset and how many they are."""
        offset = len(self._bytes)
        self._bytes += np.ascontiguousarray(array, dtype=kind).tobytes()
        self._bytes += bytes(-len(self._bytes) % 4)
        return offset, array.size

    def add_surface(self, surface: Surface) -> dict[str, tuple[int, int]]:
        """Append a surface; its normals have four bytes each."""
        normals = np.zeros((len(surface.vertices), 4))
        normals[:, :3] = np.round(surface.normals * 127.0)
        return {
            "vertices": self.add(surface.vertices, "<f4"),
            "normals": self.add(normals, "i1"),
            "triangles": self.add(surface.triangles, "<u4"),
        }

    def text(self) -> str:
        """All of it, compressed, in base64."""
        return base64.b64encode(zlib.compress(bytes(self._bytes), 9)).decode()


def _content(exhibit: Exhibit, numbers: _Numbers) -> dict[str, Any]:
    film, camera = exhibit.film, best_camera(exhibit)
    carriers = [WORLD, *film.poses]
    poses = np.stack([pose_numbers(T) for T in film.poses.values()], axis=1)
    return {
        "title": exhibit.title,
        "subtitle": exhibit.subtitle,
        "duration": film.duration,
        "moments": len(film.times),
        "times": numbers.add(film.times, "<f4")[0],
        "carriers": carriers,
        "poses": numbers.add(poses, "<f4")[0],
        "marks": [mark._asdict() for mark in film.marks],
        "layers": list(dict.fromkeys(part.layer for part in exhibit.parts)),
        "parts": [_part(part, carriers, numbers) for part in exhibit.parts],
        "pipe": numbers.add_surface(_up(Cylinder(1.0, 1.0))),
        "coin": numbers.add_surface(_up(Cylinder(1.0, 1.0))),
        "camera": {
            "target": camera.target.tolist(),
            "azimuth": camera.azimuth,
            "elevation": camera.elevation,
            "distance": camera.distance,
            "fov": FIELD_OF_VIEW,
            "sun": float(np.radians(sun_of(exhibit, camera).azimuth)),
        },
    }


def _part(part: Part, carriers: Sequence[str], numbers: _Numbers) -> dict[str, Any]:
    return {
        "name": part.name,
        "layer": part.layer,
        "carrier": carriers.index(part.carrier),
        "colour": part.colour,
        "solid": part.layer in (ROBOT, SCENE),
        **numbers.add_surface(part.surface),
    }


def _up(shape: Cylinder) -> Surface:
    """A cylinder from z = 0 on."""
    T = np.eye(4)
    T[2, 3] = shape.length / 2.0
    return with_edges(surface_of(shape)).moved(T)


def _clearance(curve: ClearanceCurve) -> dict[str, Any]:
    known = np.isfinite(curve.distances)
    return {
        "times": np.round(curve.times[known], 4).tolist(),
        "distances": np.round(curve.distances[known], 6).tolist(),
        "pairs": [p for p, k in zip(curve.pairs, known, strict=True) if k],
    }


def _search(exhibit: Exhibit, search: Search) -> dict[str, Any]:
    return {
        "candidates": [_candidate(exhibit, c) for c in search.candidates],
        "cycles": [
            {
                "label": cycle.label,
                "ends": [
                    {
                        "positions": np.round(end.positions, 4).tolist(),
                        "scores": np.round(end.scores, 3).tolist(),
                    }
                    for end in cycle.ends
                ],
            }
            for cycle in search.cycles
        ],
    }


def _candidate(exhibit: Exhibit, candidate: ShownCandidate) -> dict[str, Any]:
    return {
        "label": candidate.label,
        "total": candidate.total,
        "ends": [_end(exhibit, end, candidate.object) for end in candidate.ends],
    }


def _end(exhibit: Exhibit, end: CandidateEnd, item: str) -> dict[str, Any]:
    nearest = {n.link: n for n in end.nearest}
    links = []
    for link in end.breakdown.links:
        entry: dict[str, Any] = {"link": link.link, "points": link.points}
        entry["distance"] = link.distance if np.isfinite(link.distance) else None
        if near := nearest.get(link.link):
            entry["from"] = np.round(near.on_link, 5).tolist()
            entry["to"] = np.round(near.on_obstacle, 5).tolist()
        links.append(entry)
    return {
        "total": end.breakdown.total,
        "terms": end.breakdown.terms,
        "links": links,
        "poses": _poses(exhibit, end, item),
    }


def _poses(exhibit: Exhibit, end: CandidateEnd, item: str) -> Mapping[int, list[float]]:
    """The poses of the robot's joints and of the object, by the number of a carrier."""
    robot: Robot = exhibit.problem.robot
    carriers = [WORLD, *exhibit.film.poses]
    T_world_joint = joint_placements(robot.model, end.q[None])
    poses = {name: T[0] for name, T in joint_poses(robot, T_world_joint).items()}
    poses[object_carrier(item)] = end.T_world_object
    return {
        carriers.index(name): np.round(pose_numbers(T[None])[0], 6).tolist()
        for name, T in poses.items()
    }
