"""Contacts between fingers and an object, and the wrenches that they transmit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array

# Forces that stand for what a contact transmits: two at each corner of its patch.
FORCES = 8
# The least share of their distance by which contacts are aside of each other's normal
# for that side to be a direction.
_ASIDE = 1e-3


class Contacts(NamedTuple):
    """Where k fingers touch an object in n grasps, in the object's frame.

    Each touches on a patch with four `corners`, in order around it; `normals` point
    into the object. All are NaN where a finger does not touch.
    """

    corners: Array  # (n, k, 4, 3), m
    normals: Array  # (n, k, 3), unit

    @property
    def points(self) -> Array:
        """The middles of the patches, (n, k, 3), m."""
        middles: Array = self.corners.mean(axis=2)
        return middles

    @property
    def complete(self) -> npt.NDArray[np.bool_]:
        """Whether all fingers touch, (n,)."""
        return np.asarray(np.isfinite(self.normals).all(axis=(1, 2)))

    def about(self, centre: Array, size: float) -> Contacts:
        """The contacts from `centre` (3,) on, lengths in units of `size` (m).

        Wrenches of these do not depend on the unit of length, nor on where the frame
        of the object is.
        """
        return Contacts((self.corners - centre) / size, self.normals)


def contact_wrenches(contacts: Contacts, friction: float) -> Array:
    """What each contact transmits at a normal force of 1: (n, k, FORCES, 6).

    By Coulomb's law a corner of a patch transmits any force within its friction cone,
    and a patch any mean of what its corners do. Of these cones two edges each are
    taken, opposite to each other, in one direction for two opposite corners and across
    it for the other two. The mean of all is a pyramid of four edges at the middle; a
    patch also resists turning about its normal, by friction on its sides, and tilting,
    by the normal forces of its sides. Force first, then torque about the origin.
    """
    slide = friction * _directions(contacts)  # (n, k, 4, 3)
    normal = contacts.normals[:, :, None, :]
    force = np.concatenate([normal + slide, normal - slide], axis=2)
    torque = np.cross(np.concatenate([contacts.corners] * 2, axis=2), force)
    return np.concatenate([force, torque], axis=-1)


def _directions(contacts: Contacts) -> Array:
    """The direction of friction at each corner, (n, k, 4, 3), unit.

    One of the two directions lies in the plane of the normal and the middle of all
    contacts, as this is where the contacts need friction against each other. Which
    corners have it is chosen so that the patch resists the most torsion.
    """
    points, normals = contacts.points, contacts.normals
    first = _aside(points.mean(axis=1, keepdims=True) - points, normals)
    second = np.cross(normals, first)
    away = contacts.corners - points[:, :, None]

    def torsion(a: Array, b: Array) -> Array:
        turn = np.cross(away[:, :, :2], np.stack([a, b], axis=2))
        found: Array = np.abs(np.einsum("nkci,nki->nkc", turn, normals)).sum(axis=2)
        return found

    swap = (torsion(second, first) > torsion(first, second))[..., None]
    even = np.where(swap, second, first)
    odd = np.where(swap, first, second)
    return np.stack([even, odd, even, odd], axis=2)


def _aside(inward: Array, normals: Array) -> Array:
    """Unit directions (..., 3) of what is across the normals in `inward` (..., 3).

    Any direction across the normal where that is next to nothing.
    """
    ahead = np.einsum("...i,...i->...", inward, normals)[..., None]
    across = inward - ahead * normals
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    least = np.eye(3)[np.argmin(np.abs(np.nan_to_num(normals)), axis=-1)]
    instead = np.cross(normals, least)
    instead /= np.linalg.norm(instead, axis=-1, keepdims=True)
    aside = length > _ASIDE * np.linalg.norm(inward, axis=-1, keepdims=True)
    return np.where(aside, across / np.where(aside, length, 1.0), instead)
