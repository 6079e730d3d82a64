"""Antipodal grasps of triangle meshes: two opposite places of the surface."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.array_cache import cached
from mmplan.collision.hand_room import HandRoom
from mmplan.collision.hand_size import hand_size
from mmplan.collision.mesh_files import (
    TriangleMesh,
    content_key,
    read_surface,
    surface_tree,
)
from mmplan.exceptions import InputError
from mmplan.grasps.family import poses_from
from mmplan.grasps.hand import HandSize
from mmplan.robot import Robot
from mmplan.shapes import Array, Mesh

if TYPE_CHECKING:
    import trimesh

# Rounds of sampling before fewer grasps than wanted are taken for all there are.
_MOST_ROUNDS = 12
# How many candidates are tried for each grasp that is wanted, each round.
_TRIES = 2.0
# A new number for each change of the sampling: what caches hold is then made anew.
_METHOD = 4
# The thinnest thing between the fingers that is not noise of the mesh, m.
_THINNEST = 1e-3
# Rays begin this far inside the surface, as a share of the hand's opening.
_INSET = 1e-4


class Pairs(NamedTuple):
    """Two places on the surface that pads can press together, n of them.

    `closing` is the direction in which the pads come together, from the first place to
    the second: that in which flat pads are as flush with both as they can be.
    """

    first: Array  # (n, 3), m
    second: Array  # (n, 3), m
    closing: Array  # (n, 3), unit


def antipodal_poses(
    mesh: Mesh, robot: Robot, friction: float, samples: int, seed: int
) -> Array:
    """Tool poses (n, 4, 4) of at most `samples` grasps, hand free of the object.

    Points are drawn by area, and a ray goes from each into the object, at random
    within half of the friction cone about the inner normal. Where it comes out, the
    two are a pair if they are at most as far apart as the hand opens, and the line
    between them is in the friction cones of both. The tool stands in the middle and
    closes along the mean of the two normals, turned about that at random; where the
    palm or an opened finger meets the surface, the grasp is left out. The same seed
    gives the same grasps, and they are kept in the user's cache folder under the hash
    of mesh, hand and settings.

    Raises:
        InputError: The mesh cannot be read, or the extra `meshes` is not installed.
    """
    room = HandRoom(robot)
    hand_key = hashlib.sha256(room.signature()).hexdigest()
    settings = (_METHOD, friction, samples, seed, _TRIES)

    def sample() -> list[Array]:
        triangles = read_surface(mesh)
        surface = _surface(mesh, triangles)
        tree = surface_tree(triangles)
        hand = hand_size(robot)
        rng = np.random.default_rng(seed)
        found = np.empty((0, 4, 4))
        n = tried = int(_TRIES * samples) + 1
        for _ in range(_MOST_ROUNDS):
            pairs = antipodal_pairs(surface, hand, friction, n, rng)
            T = _poses(pairs, hand, rng)
            apart = pairs.second - pairs.first
            widths = np.einsum("ni,ni->n", apart, pairs.closing)
            found = np.concatenate([found, T[room.is_free(tree, T, widths)]])
            missing = samples - len(found)
            if missing <= 0:
                break
            # As many more as should do, by those so far, and some.
            enough = 2 * missing * tried // max(1, len(found))
            n = min(int(_TRIES * samples), enough) + 1
            tried += n
        return [found[:samples]]

    (poses,) = cached("grasps", content_key(mesh, hand_key, *settings), sample)
    return poses


def antipodal_pairs(
    surface: trimesh.Trimesh,
    hand: HandSize,
    friction: float,
    n: int,
    rng: np.random.Generator,
) -> Pairs:
    """The pairs found from n points of the surface."""
    first, face = _points_by_area(surface, n, rng)
    normals = surface.face_normals
    cone = np.arctan(friction)
    inward = _aslant(-normals[face], 0.5 * cone, rng)
    start = first + _INSET * hand.opening * inward
    hits, ray, hit_face = surface.ray.intersects_location(start, inward)
    apart = np.einsum("ij,ij->i", hits - first[ray], inward[ray])
    comes_out = np.einsum("ij,ij->i", normals[hit_face], inward[ray])
    good = (apart >= _THINNEST) & (apart <= hand.widest) & (comes_out >= np.cos(cone))
    # Of several ways out of the object one is taken, any.
    order = rng.permutation(len(ray))
    order = order[good[order]]
    _, chosen = np.unique(ray[order], return_index=True)
    rows = order[chosen]
    closing = normals[hit_face[rows]] - normals[face[ray[rows]]]
    closing /= np.linalg.norm(closing, axis=1, keepdims=True)
    return Pairs(first[ray[rows]], hits[rows], closing)


def _surface(mesh: Mesh, triangles: TriangleMesh) -> trimesh.Trimesh:
    try:
        import trimesh
    except ImportError as error:
        raise InputError(
            f"{mesh.path}: grasps of a mesh are sampled with an extra: "
            "pip install 'mmplan[meshes]'; or give the object 'grasps'"
        ) from error
    return trimesh.Trimesh(*triangles, process=False)


def _points_by_area(
    surface: trimesh.Trimesh, n: int, rng: np.random.Generator
) -> tuple[Array, npt.NDArray[np.int64]]:
    """Points (n, 3) drawn evenly from the surface, and their triangles (n,)."""
    area = surface.area_faces
    face = rng.choice(len(area), n, p=area / area.sum())
    a, b = np.sort(rng.random((2, n)), axis=0)
    corners = surface.triangles[face]
    weights = np.stack([a, b - a, 1.0 - b], axis=1)
    return np.einsum("nc,nci->ni", weights, corners), face


def _aslant(directions: Array, most: float, rng: np.random.Generator) -> Array:
    """Directions (n, 3) turned at random by at most an angle (rad)."""
    other = rng.normal(size=directions.shape)
    across = np.cross(directions, other)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    angle = most * np.sqrt(rng.random((len(directions), 1)))
    return np.cos(angle) * directions + np.sin(angle) * across


def _poses(pairs: Pairs, hand: HandSize, rng: np.random.Generator) -> Array:
    """Tool poses (n, 4, 4) in the middle of pairs, turned about their closing.

    The pads are long: the tool stands up to a third of a finger's width off.
    """
    first, second, closing = pairs
    approach = np.cross(closing, rng.normal(size=closing.shape))
    approach /= np.linalg.norm(approach, axis=1, keepdims=True)
    off = hand.width / 3.0 * rng.uniform(-1.0, 1.0, (len(closing), 1))
    return poses_from(approach, closing, (first + second) / 2.0 + off * approach)
