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
    for column, placed in enumerate(fingers):
        gaps = [thing.gaps(geometry, T) for geometry, T in placed]
        for row in np.flatnonzero(touches).tolist():
            patches = [
                patch
                for (geometry, T), gap in zip(placed, gaps, strict=True)
                for patch in _patches(thing, geometry, T[row], gap[row])
            ]
            if patches:
                _enter(contacts, (row, column), patches)
    return contacts


def _enter(contacts: Contacts, place: tuple[int, int], patches: list[_Patch]) -> None:
    """Put all patches together into the contacts."""
    nearest = min(patch.gap for patch in patches)
    flush = [patch for patch in patches if patch.gap <= nearest + _SAME_PLANE]
    normal = np.sum([patch.normal for patch in flush], axis=0)
    normal /= np.sqrt(normal @ normal)
    contacts.normals[place] = normal
    corners = np.concatenate([patch.corners for patch in flush])
    contacts.corners[place] = _four_of(corners, normal)


def _four_of(corners: Array, normal: Array) -> Array:
    """Four (4, 3) of the corners (c, 3) of a patch.

    Those farthest out between the two axes of the patch, the longer and the shorter,
    and at least as far out as those of a soft pad.
    """
    middle = corners.sum(axis=0) / len(corners)
    away = corners - middle
    along = np.linalg.eigh(away.T @ away)[1][:, -1]
    if abs(along @ normal) > _ACROSS:  # a point has no axes
        along = np.eye(3)[np.argmin(np.abs(normal))]
    along = along - (along @ normal) * normal
    along /= np.sqrt(along @ along)
    axes = np.array([along, np.cross(normal, along)])
    flat = away @ axes.T
    farthest = flat[np.argmax(_SIDES @ flat.T, axis=1)]
    four: Array = middle + _SIDES * np.maximum(_SIDES * farthest, _SOFT) @ axes
    return four


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
