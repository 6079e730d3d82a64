"""An arm as a chain of screws: where its joint axes are, and where the tool is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.exceptions import InputError
from mmplan.ik.poses import Poses
from mmplan.ik.rotation import along, cross, rotate
from mmplan.kinematics import motion_axis
from mmplan.shapes import Array, read_only

# Limits beyond this (rad) are those of a joint that turns without end.
_ENDLESS = 1e6
# Components of unit vectors below this are rounding.
_ROUNDING = 5e-11


@dataclass(frozen=True, eq=False)
class Chain:
    """k joints of one degree of freedom, described where all of them are at 0.

    All in the frame of the last base joint: joint i turns about (or slides along) the
    unit vector `axes[i]`, through `points[i]`; `T_home` is the pose of the tool.
    """

    names: tuple[str, ...]
    axes: Array  # (k, 3)
    points: Array  # (k, 3), m
    prismatic: npt.NDArray[np.bool_]  # (k,)
    T_home: Array  # (4, 4)
    lower: Array  # (k,), rad or m, -inf for a joint that turns without end
    upper: Array  # (k,)

    def __len__(self) -> int:
        """The number of joints."""
        return len(self.names)

    def part(self, joints: Sequence[int]) -> Chain:
        """The chain of these of its joints alone, the others left at 0."""
        index = list(joints)
        return replace(
            self,
            names=tuple(self.names[i] for i in index),
            axes=self.axes[index],
            points=self.points[index],
            prismatic=self.prismatic[index],
            lower=self.lower[index],
            upper=self.upper[index],
        )

    @cached_property
    def ranges(self) -> tuple[Array, Array]:
        """The ends (k,) of each joint's range, of a turn at most where it turns."""
        limited = np.isfinite(self.upper)
        lower = np.where(limited, self.lower, -np.pi)
        upper = np.where(limited, self.upper, np.pi)
        middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
        half = np.where(self.prismatic, half, np.minimum(half, np.pi))
        return read_only(middle - half), read_only(middle + half)

    def forward(self, q: Array) -> Poses:
        """The poses of the tool at q (k, m)."""
        return self._run(q)[0]

    def jacobian(self, q: Array) -> tuple[Poses, Array]:
        """The poses of the tool at q (k, m) and J (6, k, m), linear part first.

        Both in the base's axes; the linear part is of the tool's origin.
        """
        poses, directions, origins = self._run(q)
        J = np.zeros((6, *q.shape))
        for i, (z, origin) in enumerate(zip(directions, origins, strict=True)):
            if self.prismatic[i]:
                J[:3, i] = z
            else:
                J[:3, i] = cross(z, poses.p - origin)
                J[3:, i] = z
        return poses, J

    def _run(self, q: Array) -> tuple[Poses, list[Array], list[Array]]:
        """The tool's poses, and each joint's directions and origins (3, m)."""
        R = np.eye(3)[:, :, None]
        p = np.zeros((3, q.shape[1]))
        directions, origins = [], []
        before = np.zeros(3)
        for i, (axis, point) in enumerate(zip(self.axes, self.points, strict=True)):
            p = p + along(point - before, R)
            before = point
            directions.append(along(axis, R))
            origins.append(p)
            if self.prismatic[i]:
                p = p + q[i] * directions[i]
            else:
                R = rotate(-axis, q[i], R)
        p = p + along(self.T_home[:3, 3] - before, R)
        home = self.T_home[:3, :3].T @ R.reshape(3, -1)
        return Poses(home.reshape(R.shape), p), directions, origins

    @cached_property
    def T_tool_home(self) -> Array:
        """The inverse of `T_home`."""
        return read_only(np.linalg.inv(self.T_home))


def arm_chain(model: pin.Model, joints: Sequence[str], tool_frame: int) -> Chain:
    """The chain of an arm's joints, in the frame of the joint that carries it.

    Raises:
        InputError: The joints are not the ones, in order, that move the tool.
    """
    ids = [int(model.getJointId(name)) for name in joints]
    tool = model.frames[tool_frame]
    base = int(model.parents[ids[0]])
    _check_path(model, ids, base, tool)
    placement = pin.SE3.Identity()
    axes, points, prismatic, limits = [], [], [], []
    for i in ids:
        placement = placement * model.jointPlacements[i]
        linear, angular = np.split(motion_axis(model, i), 2)
        slides = not angular.any()
        axis = linear if slides else angular
        axes.append(_clean(placement.rotation @ axis))
        points.append(placement.translation)
        prismatic.append(slides)
        limits.append(_limits(model, i))
    lower, upper = np.array(limits).T
    prismatic_mask = np.array(prismatic)
    prismatic_mask.setflags(write=False)
    return Chain(
        names=tuple(joints),
        axes=read_only(axes),
        points=read_only(points),
        prismatic=prismatic_mask,
        T_home=read_only((placement * tool.placement).homogeneous),
        lower=read_only(lower),
        upper=read_only(upper),
    )


def _check_path(
    model: pin.Model, ids: Sequence[int], base: int, tool: pin.Frame
) -> None:
    """Raise where the joints are not exactly those between the base and the tool."""
    path = [int(i) for i in model.supports[tool.parentJoint]]
    moving = path[path.index(base) + 1 :] if base in path else path[1:]
    if list(ids) != moving:
        raise InputError(
            f"ik: the tool '{tool.name}' is moved by the joints "
            f"{', '.join(model.names[i] for i in moving) or '(none)'}, which are not "
            f"the arm's: {', '.join(model.names[i] for i in ids)}"
        )


def _limits(model: pin.Model, joint: int) -> tuple[float, float]:
    """The limits of a joint, infinite where it turns without end."""
    if model.joints[joint].nq != 1:
        return -np.inf, np.inf
    index = model.joints[joint].idx_q
    lower = float(model.lowerPositionLimit[index])
    upper = float(model.upperPositionLimit[index])
    endless = not (lower > -_ENDLESS and upper < _ENDLESS)
    return (-np.inf, np.inf) if endless else (lower, upper)


def _clean(axis: Array) -> Array:
    """The unit vector along an axis, without what rounding added to it."""
    cleaned = np.where(np.abs(axis) < _ROUNDING, 0.0, axis)
    unit: Array = cleaned / np.linalg.norm(cleaned)
    return unit
