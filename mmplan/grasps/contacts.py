"""Contacts between fingers and an object, and the wrenches that they transmit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array

# Edges of the pyramid that is put into a friction cone.
EDGES = 6


class Contacts(NamedTuple):
    """Where k fingers touch an object in n grasps, in the object's frame.

    `normals` point into the object. `arms` (m) times friction and normal force is the
    torque about the normal that a contact resists: a soft finger touches on an area.
    All are NaN where a finger does not touch.
    """

    points: Array  # (n, k, 3), m
    normals: Array  # (n, k, 3), unit
    arms: Array  # (n, k), m

    @property
    def complete(self) -> npt.NDArray[np.bool_]:
        """Whether all fingers touch, (n,)."""
        return np.asarray(np.isfinite(self.points).all(axis=(1, 2)))

    def about(self, centre: Array, size: float) -> Contacts:
        """The contacts from `centre` (3,) on, lengths in units of `size` (m).

        Wrenches of these do not depend on the unit of length, nor on where the frame
        of the object is.
        """
        return Contacts((self.points - centre) / size, self.normals, self.arms / size)


def soft_finger_wrenches(contacts: Contacts, friction: float) -> Array:
    """What each contact transmits at a normal force of 1: (n, k, EDGES + 2, 6).

    A soft finger resists sliding and turning about its normal together, within
    |f_t|² + (torque / arm)² <= friction² (Howe and Cutkosky 1996). Of that ellipsoid
    these are corners: pure friction in `EDGES` directions, and pure torsion either
    way. Force first, then torque about the origin.
    """
    n, k = contacts.arms.shape
    normal = contacts.normals[:, :, None, :]
    u, v = _tangents(contacts.normals)
    angle = 2.0 * np.pi * np.arange(EDGES) / EDGES
    slide = (
        np.cos(angle)[:, None] * u[:, :, None] + np.sin(angle)[:, None] * v[:, :, None]
    )
    force = np.concatenate(
        [normal + friction * slide, np.repeat(normal, 2, axis=2)], axis=2
    )
    torque = np.cross(contacts.points[:, :, None, :], force)
    twist = friction * contacts.arms[:, :, None] * contacts.normals
    torque[:, :, EDGES] += twist
    torque[:, :, EDGES + 1] -= twist
    return np.concatenate([force, torque], axis=-1).reshape(n, k, EDGES + 2, 6)


def _tangents(normals: Array) -> tuple[Array, Array]:
    """Two unit vectors across each normal (..., 3) and each other."""
    least = np.eye(3)[np.argmin(np.abs(np.nan_to_num(normals)), axis=-1)]
    u = np.cross(normals, least)
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    return u, np.cross(normals, u)
