"""The Puma 560's inverse kinematics in closed form, all eight branches at once.

Standard Denavit-Hartenberg convention. The wrist is spherical, so the first three
joints follow from the position of its centre and the last three from the rotation
that remains. Derivation: R. P. Paul, H. Zhang, "Computationally efficient kinematics
for manipulators with spherical wrists based on the homogeneous transformation
representation", IJRR 1986. Here the branches are vectors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.exceptions import InputError
from mmplan.ik import Solutions
from mmplan.ik.windings import nearest_winding
from mmplan.shapes import Array, read_only

# The settings of the solver: lengths a2, a3, d3 and d4 of the table, m.
LENGTHS = ("a2", "a3", "d3", "d4")

# Branches nearer to each other than this (rad) are one.
_SAME = 1e-6
# Below this sine of joint 5 the axes of joints 4 and 6 are one.
_ALIGNED = 1e-10
# How far a pose may lie outside of the workspace by rounding, relative.
_ROUNDING = 1e-12
# How far the robot's model may differ from the solver's table, m and rad.
_MODEL_TOLERANCE = 1e-9


class _Position(NamedTuple):
    """Joints 1 to 3, branches (shoulder, elbow), for n poses."""

    q1: Array  # (2, 1, n)
    cos1: Array  # (2, 1, n)
    sin1: Array  # (2, 1, n)
    q2: Array  # (2, 2, n)
    q3: Array  # (1, 2, n)
    exists: npt.NDArray[np.bool_]  # (2, 2, n)


class _Wrist(NamedTuple):
    """Joints 4 to 6 with joint 5 positive, branches (shoulder, elbow), (2, 2, n)."""

    q4: Array
    q5: Array
    q6: Array
    aligned: npt.NDArray[np.bool_]  # joints 4 and 6 turn about one axis


@dataclass(frozen=True, eq=False)
class Puma:
    """A solver for the Puma 560 on any base and with any tool.

    Lengths are those of the Denavit-Hartenberg table (m), `lower` and `upper` (6,) the
    joint limits (rad). `T_shoulder_base` takes the base's frame to that of joint 1,
    raised to the height of the shoulder; `T_tool_wrist` is the pose of joint 6's frame
    in the tool's.
    """

    a2: float
    a3: float
    d3: float
    d4: float
    T_shoulder_base: Array  # (4, 4)
    T_tool_wrist: Array  # (4, 4)
    lower: Array  # (6,)
    upper: Array  # (6,)
    complete: bool = field(default=True, init=False)
    explanation: str = field(default="the Puma 560 in closed form", init=False)

    def solve(self, T_base_tool: Array) -> Solutions:
        """All solutions for tool poses (n, 4, 4) in the frame of the mobile base."""
        T = self.T_shoulder_base @ T_base_tool @ self.T_tool_wrist  # (n, 4, 4)
        R = np.ascontiguousarray(np.moveaxis(T[:, :3, :3], 0, -1))  # (3, 3, n)
        position = self._position(*T[:, :3, 3].T)
        wrist = _wrist(R, position, q4_aligned=0.5 * (self.lower[3] + self.upper[3]))
        q, exists = _all_branches(position, wrist)
        q = nearest_winding(q, self.lower, self.upper)
        within = exists & ((q >= self.lower) & (q <= self.upper)).all(axis=-1)
        q[~exists] = np.nan
        return Solutions(q=q, exists=exists, within=within)

    def _position(self, x: Array, y: Array, z: Array) -> _Position:
        """Joints 1 to 3 for a wrist at (x, y, z), each (n,), seen from the shoulder."""
        forearm = np.hypot(self.a3, self.d4)
        rho2 = x * x + y * y
        r2 = rho2 - self.d3**2
        r = np.sqrt(np.maximum(r2, 0.0)) * np.array([1.0, -1.0])[:, None]  # (2, n)
        q1 = np.arctan2(y, x) + np.arctan2(self.d3, r)

        reach2 = np.maximum(r2, 0.0) + z * z
        cosine = (reach2 - self.a2**2 - forearm**2) / (2 * self.a2 * forearm)
        bend = np.arccos(np.clip(cosine, -1.0, 1.0))  # (n,)
        lead = np.arctan2(forearm * np.sin(bend), self.a2 + forearm * np.cos(bend))
        sign = np.array([1.0, -1.0])[None, :, None]  # elbow
        q2 = np.arctan2(z, r)[:, None] - sign * lead
        q3 = sign * bend - np.arctan2(self.d4, self.a3)

        exists = np.empty((2, 2, len(x)), dtype=np.bool_)
        exists[:] = (r2 >= -_ROUNDING) & (np.abs(cosine) <= 1 + _ROUNDING)
        exists[1] &= 2 * np.arctan2(r[0], self.d3) > _SAME
        exists[:, 1] &= (bend > _SAME) & (bend < np.pi - _SAME)
        return _Position(
            q1[:, None], np.cos(q1)[:, None], np.sin(q1)[:, None], q2, q3, exists
        )


def _wrist(R: Array, position: _Position, q4_aligned: float) -> _Wrist:
    """Joints 4 to 6 from R (3, 3, n), the rotation of joint 6's frame.

    What remains for the wrist is R_3_6 = Rz(q4) Ry(-q5) Rz(q6). Where q5 is 0 only the
    sum of q4 and q6 matters: joint 4 stands at `q4_aligned` and joint 6 takes the rest.
    """
    cos23 = np.cos(position.q2 + position.q3)  # (2, 2, n)
    sin23 = np.sin(position.q2 + position.q3)
    along = [position.cos1 * R[0, j] + position.sin1 * R[1, j] for j in range(3)]
    row1 = [cos23 * along[j] + sin23 * R[2, j] for j in range(3)]
    row2 = [position.cos1 * R[1, j] - position.sin1 * R[0, j] for j in range(3)]
    cos5 = cos23 * R[2, 2] - sin23 * along[2]

    sin5 = np.hypot(row1[2], row2[2])
    aligned = sin5 < _ALIGNED
    divisor = np.where(aligned, 1.0, sin5)
    cos4 = np.where(aligned, np.cos(q4_aligned), -row1[2] / divisor)
    sin4 = np.where(aligned, np.sin(q4_aligned), -row2[2] / divisor)
    # From joint 4 and not from the third row of R, so that their sum stays exact
    # however small sin5 is.
    q6 = np.arctan2(cos4 * row2[0] - sin4 * row1[0], cos4 * row2[1] - sin4 * row1[1])
    return _Wrist(np.arctan2(sin4, cos4), np.arctan2(sin5, cos5), q6, aligned)


def _all_branches(
    position: _Position, wrist: _Wrist
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Joint values (n, 8, 6) of unknown winding, and which of them exist (n, 8).

    The wrist's second branch is the first turned over: (q4 + pi, -q5, q6 + pi).
    """
    n = position.q2.shape[-1]
    q = np.empty((6, 2, 2, 2, n))  # joint, wrist, shoulder, elbow, pose
    q[0], q[1], q[2] = position.q1, position.q2, position.q3
    q[3, 0], q[4, 0], q[5, 0] = wrist.q4, wrist.q5, wrist.q6
    q[3, 1], q[4, 1], q[5, 1] = wrist.q4 + np.pi, -wrist.q5, wrist.q6 + np.pi
    exists = np.stack([position.exists, position.exists & ~wrist.aligned])
    return q.reshape(6, 8, n).transpose(2, 1, 0), exists.reshape(8, n).T


def puma(
    model: pin.Model,
    joints: Sequence[str],
    tool_frame: int,
    settings: Mapping[str, float],
) -> Puma:
    """The solver for the arm `joints` of a model, its `settings` checked against it.

    Raises:
        InputError: A setting is missing, or the model is no Puma of these lengths.
    """
    missing = [name for name in LENGTHS if name not in settings]
    if missing:
        raise InputError(
            f"ik: the solver 'puma' needs {', '.join(LENGTHS)}; "
            f"missing: {', '.join(missing)}"
        )
    a2, a3, d3, d4 = (float(settings[name]) for name in LENGTHS)
    ids = [model.getJointId(name) for name in joints]
    _check_model(model, ids, _table(a2, a3, d3, d4))
    if model.frames[tool_frame].parentJoint != ids[-1]:
        raise InputError(
            f"ik: the tool '{model.frames[tool_frame].name}' is not moved by "
            f"the arm's last joint '{joints[-1]}'"
        )
    indices = [model.joints[i].idx_q for i in ids]
    T_shoulder = model.jointPlacements[ids[0]] * _raised(model.jointPlacements[ids[1]])
    T_wrist_tool = model.frames[tool_frame].placement
    return Puma(
        a2=a2,
        a3=a3,
        d3=d3,
        d4=d4,
        T_shoulder_base=read_only(T_shoulder.inverse().homogeneous),
        T_tool_wrist=read_only(T_wrist_tool.inverse().homogeneous),
        lower=read_only(model.lowerPositionLimit[indices]),
        upper=read_only(model.upperPositionLimit[indices]),
    )


def _raised(placement: pin.SE3) -> pin.SE3:
    """The part of joint 2's placement that lifts it above joint 1: d1 along z."""
    return pin.SE3(np.eye(3), np.array([0.0, 0.0, placement.translation[2]]))


def _table(
    a2: float, a3: float, d3: float, d4: float
) -> list[tuple[float, float, float | None]]:
    """Rows (alpha, a, d) of the table for joints 1 to 5; d1 may be any height."""
    quarter = np.pi / 2
    return [
        (quarter, 0.0, None),
        (0.0, a2, 0.0),
        (-quarter, a3, d3),
        (quarter, 0.0, d4),
        (-quarter, 0.0, 0.0),
    ]


def _check_model(
    model: pin.Model,
    ids: Sequence[int],
    table: Sequence[tuple[float, float, float | None]],
) -> None:
    """Raise an InputError where the model's joints do not follow the table."""
    if len(ids) != 6:
        raise InputError(f"ik: the solver 'puma' is for 6 joints, not {len(ids)}")
    for i in ids:
        if model.joints[i].shortname() != "JointModelRZ":
            raise InputError(f"ik: joint '{model.names[i]}' does not turn about its z")
    for (alpha, a, d), before, after in zip(table, ids, ids[1:], strict=False):
        found = model.jointPlacements[after]
        height = found.translation[2] if d is None else d
        expected = pin.SE3(pin.utils.rotate("x", alpha), np.array([a, 0.0, height]))
        parent_fits = model.parents[after] == before
        if not (parent_fits and found.isApprox(expected, _MODEL_TOLERANCE)):
            raise InputError(
                f"ik: joint '{model.names[after]}' is not where the solver 'puma' "
                f"expects it after '{model.names[before]}': "
                f"a = {a:g} m, d = {height:g} m, alpha = {np.degrees(alpha):g} degrees"
            )
