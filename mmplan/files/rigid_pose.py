"""Poses in plain numbers, for URDFs that are put together before numpy is there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

Vector: TypeAlias = tuple[float, float, float]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

# Below this cosine of the pitch, roll and yaw turn about one axis.
_LOCKED = 1e-9


class RigidPose(NamedTuple):
    """A pose: position `xyz` (m) and rotation matrix `R`, by rows."""

    xyz: Vector = (0.0, 0.0, 0.0)
    R: Matrix = IDENTITY

    def __matmul__(self, other: RigidPose) -> RigidPose:
        """T_a_c from T_a_b and T_b_c."""
        moved = _applied(self.R, other.xyz)
        x, y, z = (a + b for a, b in zip(self.xyz, moved, strict=True))
        return RigidPose((x, y, z), _product(self.R, other.R))

    @property
    def rpy(self) -> Vector:
        """Angles (rad) about the fixed axes x, y, z that give this rotation."""
        (r00, _, _), (r10, r11, r12), (r20, r21, r22) = self.R
        cos_pitch = math.hypot(r00, r10)
        pitch = math.atan2(-r20, cos_pitch)
        if cos_pitch < _LOCKED:
            return (math.atan2(-r12, r11), pitch, 0.0)
        return (math.atan2(r21, r22), pitch, math.atan2(r10, r00))


def from_rpy(xyz: Vector, rpy: Vector) -> RigidPose:
    """The pose with a rotation about the fixed axes x, then y, then z (rad)."""
    R = IDENTITY
    for axis, angle in zip(IDENTITY, rpy, strict=True):
        R = _product(about(axis, angle).R, R)
    return RigidPose(xyz, R)


def from_quaternion(xyz: Vector, quat: tuple[float, float, float, float]) -> RigidPose:
    """The pose with the rotation of a unit quaternion [x, y, z, w]."""
    x, y, z, w = quat
    sine = math.hypot(x, y, z)
    if sine == 0.0:
        return RigidPose(xyz)
    turn = about((x, y, z), 2.0 * math.atan2(sine, w))
    return RigidPose(xyz, turn.R)


def about(axis: Vector, angle: float) -> RigidPose:
    """A turn by `angle` (rad) about an axis of any length (Rodrigues)."""
    x, y, z = _unit(axis)
    s, c = math.sin(angle), math.cos(angle)
    k = 1.0 - c
    return RigidPose(
        R=(
            (c + k * x * x, k * x * y - s * z, k * x * z + s * y),
            (k * x * y + s * z, c + k * y * y, k * y * z - s * x),
            (k * x * z - s * y, k * y * z + s * x, c + k * z * z),
        )
    )


def along(axis: Vector, way: float) -> RigidPose:
    """A shift by `way` (m) along an axis of any length."""
    x, y, z = _unit(axis)
    return RigidPose((way * x, way * y, way * z))


def _unit(axis: Vector) -> Vector:
    length = math.hypot(*axis)
    x, y, z = (component / length for component in axis)
    return (x, y, z)


def _applied(R: Matrix, v: Sequence[float]) -> Vector:
    x, y, z = (sum(a * b for a, b in zip(row, v, strict=True)) for row in R)
    return (x, y, z)


def _product(A: Matrix, B: Matrix) -> Matrix:
    x, y, z = (_applied(A, column) for column in zip(*B, strict=True))
    first, second, third = zip(x, y, z, strict=True)
    return (first, second, third)
