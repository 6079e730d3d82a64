"""Convex pieces of link meshes whose hulls are not tight."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mmplan.collision.decomposition import Effort, decomposed
from mmplan.collision.mesh_files import read_triangles
from mmplan.collision.meshes import hull
from mmplan.collision.solids import Solid
from mmplan.collision.standoff import Standoff, standoff
from mmplan.shapes import Array

# A hull that stands off the mesh by no more is tight, m; on links of the hand, whose
# hollows are where things are held, by no more than half of that.
TIGHT = 0.04
# Pieces that leave more of the mesh uncovered are worse than a hull that is too big, m.
_MOST_UNCOVERED = 0.002
_EFFORT = Effort(concavity=0.1, iterations=20, pieces=8)


class Choice(NamedTuple):
    """Whether a link's hulls do, and the pieces (m, 3) in its frame to take if not.

    `standoff` is that of what was chosen; `reason` says why hulls stay nevertheless.
    """

    link: str
    hulls: Standoff
    pieces: tuple[Array, ...]
    standoff: Standoff
    reason: str = ""


def choose(
    meshes: Mapping[str, Sequence[Solid]], hand: Iterable[str], tight: float = TIGHT
) -> Iterator[Choice]:
    """Choose hulls or pieces for each link with meshes; `hand` are links of the hand.

    Nothing is cut where the extra `meshes` is not installed.
    """
    in_hand = set(hand)
    for link, surfaces in meshes.items():
        limit = tight / 2 if link in in_hand else tight
        yield _chosen(link, surfaces, limit)


def _chosen(link: str, surfaces: Sequence[Solid], limit: float) -> Choice:
    hulls = _standoff([_corners(s) for s in surfaces], surfaces)
    if hulls.largest <= limit:
        return Choice(link, hulls, (), hulls)
    if find_spec("coacd") is None:
        return Choice(link, hulls, (), hulls, "cutting needs 'mmplan[meshes]'")
    pieces = tuple(piece for s in surfaces for piece in _cut(s, limit))
    found = _standoff(pieces, surfaces)
    if found.uncovered > _MOST_UNCOVERED:
        uncovered = f"{found.uncovered * 1e3:.1f} mm"
        return Choice(link, hulls, (), hulls, f"pieces would leave {uncovered} bare")
    if found.largest > 0.7 * hulls.largest:
        return Choice(link, hulls, (), hulls, "pieces would hardly be tighter")
    return Choice(link, hulls, pieces, found)


def _cut(surface: Solid, limit: float) -> list[Array]:
    """The pieces of one mesh in the link's frame; one where its hull is tight."""
    corners = _corners(surface)
    if _standoff([corners], [surface]).largest <= limit:
        return [corners]
    triangles = read_triangles(surface.geometry)
    parts = decomposed(Path(surface.owner), triangles, _EFFORT)
    return [_placed(part, surface) for part in parts]


def _corners(surface: Solid) -> Array:
    return _placed(np.array(surface.geometry.vertices()), surface)


def _placed(points: Array, surface: Solid) -> Array:
    T = surface.placement
    placed: Array = points @ T[:3, :3].T + T[:3, 3]
    return placed


def _standoff(pieces: Sequence[Array], surfaces: Sequence[Solid]) -> Standoff:
    bodies = [Solid("", hull(piece), np.eye(4)) for piece in pieces]
    return standoff(bodies, surfaces)


def obj_text(piece: Array) -> str:
    """The hull of a piece (m, 3) as an OBJ file, in metres."""
    solid = hull(piece)
    faces = [solid.polygons(i) for i in range(solid.num_polygons)]
    corners = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in solid.points()]
    sides = [f"f {f[0] + 1} {f[1] + 1} {f[2] + 1}" for f in faces]
    return "\n".join([*corners, *sides, ""])
