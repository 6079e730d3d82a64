"""Where fingers touch an object: patches of contact as coal computes them."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import coal
import numpy as np
import numpy.typing as npt

from mmplan.collision.fingers import ObjectSolids
from mmplan.collision.requests import collision_request
from mmplan.collision.separation import transform
from mmplan.grasps.contacts import Contacts
from mmplan.shapes import Array

Placed: TypeAlias = list[tuple[coal.CollisionGeometry, Array]]

# A body touches what it is nearer to than this, m.
_NEAR = 1.2e-3
# Of several touching pieces those count that are this near to the nearest, m.
_SAME_PLANE = 3e-4
# A soft pad touches on a disc of this radius even where a hard one touches at a point,
# m. If the disc is pressed evenly, friction acts at 2/3 of its radius: the corners of
# its patch are so far from the middle.
_SOFT_RADIUS = 0.005
_SOFT = 2.0 / 3.0 * _SOFT_RADIUS / np.sqrt(2.0)
# On which sides of the middle the four corners of a patch are, around it.
_SIDES = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
# An axis of a patch is across its normal, by the cosine of their angle.
_ACROSS = 0.5


class _Patch(NamedTuple):
    """The corners (c, 3) of one patch, its normal into the object and its gap (m)."""

    corners: Array
    normal: Array
    gap: float


def contacts_of(
    thing: ObjectSolids, fingers: list[Placed], touches: npt.NDArray[np.bool_]
) -> Contacts:
    """The contacts of k fingers in n grasps; NaN where a grasp does not touch (n,)."""
    shape = (len(touches), len(fingers))
    contacts = Contacts(
        np.full((*shape, len(_SIDES), 3), np.nan),
        np.full((*shape, 3), np.nan),
    )
    found: list[tuple[int, int, _Patch]] = []
    for column, placed in enumerate(fingers):
        gaps = [thing.gaps(geometry, T) for geometry, T in placed]
        for row in np.flatnonzero(touches).tolist():
            patches = [
                patch
                for (geometry, T), gap in zip(placed, gaps, strict=True)
                for patch in _patches(thing, geometry, T[row], gap[row])
            ]
            if patches:
                found.append((row, column, _together(patches)))
    if found:
        rows, columns, whole = zip(*found, strict=True)
        normals = np.array([patch.normal for patch in whole])
        contacts.normals[rows, columns] = normals
        corners = [patch.corners for patch in whole]
        contacts.corners[rows, columns] = _four_of(corners, normals)
    return contacts


def _together(patches: list[_Patch]) -> _Patch:
    """Those of some patches that are flush with the nearest, as one."""
    nearest = min(patch.gap for patch in patches)
    flush = [patch for patch in patches if patch.gap <= nearest + _SAME_PLANE]
    normal = flush[0].normal
    if len(flush) > 1:
        normal = np.sum([patch.normal for patch in flush], axis=0)
        normal /= np.sqrt(normal @ normal)
    return _Patch(np.concatenate([p.corners for p in flush]), normal, nearest)


def _four_of(patches: list[Array], normals: Array) -> Array:
    """Four (n, 4, 3) of the corners (c, 3) of each patch, with normals (n, 3).

    Those farthest out between the two axes of the patch, the longer and the shorter,
    and at least as far out as those of a soft pad.
    """
    counts = np.array([len(corners) for corners in patches])
    starts = np.cumsum(counts) - counts
    corners = np.concatenate(patches)
    middles = np.add.reduceat(corners, starts) / counts[:, None]
    away = corners - np.repeat(middles, counts, axis=0)
    spread = np.add.reduceat(away[:, :, None] * away[:, None, :], starts)
    axes = _axes(spread, normals)
    # All patches with as many corners as the largest: the last of them once more.
    each = np.minimum(np.arange(counts.max()), counts[:, None] - 1) + starts[:, None]
    flat = np.einsum("nci,nai->nca", away[each], axes)
    outermost = np.argmax(flat @ _SIDES.T, axis=1)
    farthest = np.take_along_axis(flat, outermost[:, :, None], axis=1)
    four = middles[:, None] + _SIDES * np.maximum(_SIDES * farthest, _SOFT) @ axes
    return np.asarray(four)


def _axes(spread: Array, normals: Array) -> Array:
    """The longer and the shorter axis (n, 2, 3) of patches, by their spread (n, 3, 3).

    They are across the normals (n, 3). A point has no axes and gets any.
    """
    along = np.linalg.eigh(spread)[1][:, :, -1]
    ahead = np.einsum("ni,ni->n", along, normals)
    least = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    along = np.where(np.abs(ahead)[:, None] > _ACROSS, least, along)
    along = along - np.einsum("ni,ni->n", along, normals)[:, None] * normals
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    return np.stack([along, np.cross(normals, along)], axis=1)


def _patches(
    thing: ObjectSolids, geometry: coal.CollisionGeometry, T: Array, gaps: Array
) -> list[_Patch]:
    """The patches of one body at a pose (4, 4) on the solids that it touches."""
    pose = transform(T)
    found = []
    for j in np.flatnonzero(gaps <= _NEAR):
        result = coal.CollisionResult()
        pair = (geometry, pose, thing.geometries[j], thing.transforms[j])
        coal.collide(*pair, _REQUEST, result)
        if not result.isCollision():
            continue
        patches = coal.ContactPatchResult(_PATCHES)
        coal.computeContactPatch(*pair, result, _PATCHES, patches)
        gap = -float(result.getContact(0).penetration_depth)
        for i in range(patches.numContactPatches()):
            patch = patches.getContactPatch(i)
            corners = [patch.getPoint(c) for c in range(patch.size())]
            if corners:
                found.append(
                    _Patch(np.array(corners), np.array(patch.getNormal()), gap)
                )
    return found


def _request() -> coal.CollisionRequest:
    request = collision_request(-_NEAR)
    request.enable_contact = True
    request.num_max_contacts = 1
    return request


_REQUEST = _request()
_PATCHES = coal.ContactPatchRequest()
