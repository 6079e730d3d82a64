"""Newton's method on the arm as it is, after a solution of the arm as it is meant.

The closed forms take axes as meeting or parallel that in the URDF do so to some
digits only, and near singular configurations they lose digits. What they find is
measured here, made exact where it is not, and dropped where that fails.
"""

from __future__ import annotations

import numpy as np

from mmplan.ik.branches import Candidates
from mmplan.ik.chain import Chain
from mmplan.ik.poses import Poses
from mmplan.ik.rotation import cross, dot
from mmplan.shapes import Array

# A pose missed by less (m and rad) is reached; steps go on until it is missed by less
# than the second.
REACHED = 1e-9
_EXACT = 1e-10
_STEPS = 8
# The least damping, relative to the matrix: above rounding, so that none is singular.
_REGULAR = 1e-15
# Solutions nearer to each other than this (rad or m) are one.
_SAME = 1e-6


def misses(found: Poses, wanted: Poses) -> Array:
    """The twists (6, m), linear part first, that take poses to the wanted ones.

    In the base's axes; the angular part is axis times angle.
    """
    (x, y, z), (a, b, c) = found.R, wanted.R
    sine2 = cross(x, a) + cross(y, b) + cross(z, c)  # 2 sin(angle) axis
    cosine2 = dot(x, a) + dot(y, b) + dot(z, c) - 1.0  # 2 cos(angle)
    length = np.sqrt(dot(sine2, sine2))
    angle = np.arctan2(length, cosine2)
    small = length < 1e-6
    factor = np.where(small, 0.5, angle / np.where(small, 1.0, length))
    return np.concatenate([wanted.p - found.p, factor * sine2])


def damped_steps(J: Array, miss: Array, damping: Array) -> Array:
    """Steps (k, m) from Jacobians (6, k, m) and misses (6, m), damped by (m,).

    The least squares of Levenberg and Marquardt, J^T (J J^T + damping I)^-1 miss, or
    the same as (J^T J + damping I)^-1 J^T miss where that is smaller.
    """
    J = J.transpose(2, 0, 1)  # (m, 6, k)
    Jt = J.transpose(0, 2, 1)
    wide = J.shape[2] >= 6
    square = J @ Jt if wide else Jt @ J
    diagonal = np.einsum("mii->mi", square)  # a view
    diagonal += (damping + _REGULAR * diagonal.sum(axis=1))[:, None]
    target = miss.T[:, :, None]
    if wide:
        steps = Jt @ np.linalg.solve(square, target)
    else:
        steps = np.linalg.solve(square, Jt @ target)
    columns: Array = steps[:, :, 0].T
    return columns


def polish(chain: Chain, candidates: Candidates, wanted: Poses) -> Candidates:
    """The candidates that reach their poses, all of them to `REACHED`.

    Of those that were moved and are now the same solution of a pose only one remains.
    """
    q = np.ascontiguousarray(candidates.q)
    target = wanted.take(candidates.pose)
    size = _sizes(chain, q, target)
    rows = np.flatnonzero(size > _EXACT)
    moved = rows.size > 0
    for _ in range(_STEPS):
        if rows.size == 0:
            break
        goal = target.take(rows)
        poses, J = chain.jacobian(q[:, rows])
        miss = misses(poses, goal)
        error = np.sqrt((miss**2).sum(axis=0))
        q[:, rows] += damped_steps(J, miss, error**2)
        size[rows] = _sizes(chain, q[:, rows], goal)
        rows = rows[size[rows] > _EXACT]
    kept = Candidates(candidates.pose, q).take(size <= REACHED)
    return distinct(chain, kept, _SAME) if moved else kept


def distinct(chain: Chain, candidates: Candidates, apart: float) -> Candidates:
    """Of the candidates of each pose, those that differ from all earlier ones.

    They differ if any joint does by more than `apart` (rad or m), turns aside.
    """
    order = np.argsort(candidates.pose, kind="stable")
    pose, q = candidates.pose[order], candidates.q[:, order]
    is_new = np.ones(len(pose), dtype=np.bool_)
    turning = ~chain.prismatic[:, None]
    for lag in range(1, len(pose)):
        same_pose = np.flatnonzero(pose[lag:] == pose[:-lag])
        if same_pose.size == 0:
            break
        difference = q[:, same_pose + lag] - q[:, same_pose]
        whole = 2 * np.pi * np.rint(difference / (2 * np.pi))
        difference -= np.where(turning, whole, 0.0)
        same = (np.abs(difference) <= apart).all(axis=0) & is_new[same_pose]
        is_new[same_pose[same] + lag] = False
    return Candidates(pose, q).take(is_new)


def _sizes(chain: Chain, q: Array, wanted: Poses) -> Array:
    """How far (m and rad, by the chord) configurations are from their poses, (m,)."""
    found = chain.forward(q)
    dR = (found.R - wanted.R).reshape(9, -1)
    dp = found.p - wanted.p
    sizes: Array = np.sqrt(
        0.5 * np.einsum("im,im->m", dR, dR) + np.einsum("im,im->m", dp, dp)
    )
    return sizes
