"""Forward kinematics and Jacobians of many configurations at once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.shapes import Array


class ForwardKinematics:
    """Poses of all joints for many configurations in one call.

    The same as Pinocchio's `forwardKinematics` and `data.oMi`, for models whose joints
    all have one degree of freedom. A joint's pose in its parent's frame is linear in
    (1, sin q, cos q, q), with four matrices for each joint that are made once.
    """

    def __init__(self, model: pin.Model) -> None:
        """Prepare for a model.

        Raises:
            ValueError: A joint has more than one degree of freedom.
        """
        joints = range(1, model.njoints)
        self._parents = [int(model.parents[j]) for j in joints]
        self._places = [int(model.joints[j].idx_q) for j in joints]
        bases = [_motion_basis(model, j) for j in joints]
        self._basis = np.array(bases).reshape(len(bases), 4, 16)

    @property
    def basis(self) -> Array:
        """The four matrices of each joint but for their last rows, (joints, 4, 3, 4).

        The factors of 1, sin q, cos q and q in its pose in its parent's frame.
        """
        return np.ascontiguousarray(self._basis.reshape(-1, 4, 4, 4)[:, :, :3])

    @property
    def tree(self) -> npt.NDArray[np.int64]:
        """Parent and place in q of each joint, (2, joints)."""
        return np.array([self._parents, self._places], dtype=np.int64).reshape(2, -1)

    def __call__(self, q: Array) -> Array:
        """Poses T_world_joint (n, njoints, 4, 4) at q (n, nq); joint 0 is the world."""
        values = q[:, self._places].T  # (joints, n)
        terms = np.stack(
            [np.ones_like(values), np.sin(values), np.cos(values), values], axis=2
        )
        relative = (terms @ self._basis).reshape(*values.shape, 4, 4)
        placements = np.empty((len(self._parents) + 1, len(q), 4, 4))
        placements[0] = np.eye(4)
        for joint, parent in enumerate(self._parents, start=1):
            np.matmul(placements[parent], relative[joint - 1], out=placements[joint])
        return placements.transpose(1, 0, 2, 3)


def joint_placements(model: pin.Model, q: Array) -> Array:
    """Poses T_world_joint (n, njoints, 4, 4) at q (n, nq), for a call now and then."""
    return ForwardKinematics(model)(q)


class FrameJacobians:
    """Jacobians of one frame for many configurations, from the poses of all joints."""

    def __init__(
        self, model: pin.Model, frame: int, columns: npt.NDArray[np.int_]
    ) -> None:
        """Prepare for a frame by its id and the joints at the places `columns` in v."""
        self._joint = int(model.frames[frame].parentJoint)
        self._offset = model.frames[frame].placement.translation
        joint_of = {int(model.joints[j].idx_v): j for j in range(1, model.njoints)}
        self._columns = [joint_of[column] for column in columns.tolist()]
        moving = np.isin(self._columns, list(model.supports[self._joint]))
        axes = [motion_axis(model, joint) for joint in self._columns]
        twists = np.array(axes).reshape(-1, 6) * moving[:, None]
        self._linear, self._angular = np.split(twists, 2, axis=1)

    def __call__(self, T_world_joint: Array) -> Array:
        """J (n, 6, k) at poses (n, njoints, 4, 4), linear above angular.

        It gives velocities of the frame's origin in the axes of the world.
        """
        T_frame = T_world_joint[:, self._joint]
        origin = T_frame[:, :3, :3] @ self._offset + T_frame[:, :3, 3]
        T = T_world_joint[:, self._columns]
        turned = T[..., :3, :3] @ np.stack([self._linear, self._angular], axis=2)
        arm = origin[:, None] - T[..., :3, 3]
        J = np.empty((len(T), 6, len(self._columns)))
        J[:, 3:] = turned[..., 1].transpose(0, 2, 1)
        x, y, z = arm.transpose(2, 0, 1)
        a, b, c = turned[..., 1].transpose(2, 0, 1)
        J[:, 0] = turned[..., 0, 0] + b * z - c * y
        J[:, 1] = turned[..., 1, 0] + c * x - a * z
        J[:, 2] = turned[..., 2, 0] + a * y - b * x
        return J


def motion_axes(model: pin.Model) -> Array:
    """The twists (linear, angular) of all joints in their frames, (njoints, 6)."""
    axes = np.zeros((model.njoints, 6))
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    for joint in range(1, model.njoints):
        J = pin.getJointJacobian(model, data, joint, pin.LOCAL)
        axes[joint] = J[:, model.joints[joint].idx_v]
    return axes


def motion_axis(model: pin.Model, joint: int) -> Array:
    """The twist (linear, angular) of a joint of one degree of freedom, (6,)."""
    data = model.joints[joint].createData()
    model.joints[joint].calc(data, np.zeros(model.nq))
    subspace: Array = np.asarray(data.S).reshape(6, -1)
    if subspace.shape[1] != 1:
        raise ValueError(f"joint {model.names[joint]} has more than one freedom")
    return subspace[:, 0]


def _motion_basis(model: pin.Model, joint: int) -> Array:
    """A (4, 4, 4): T_parent_joint = A[0] + A[1] sin q + A[2] cos q + A[3] q.

    For a turn about the unit axis with cross-product matrix K the rotation is
    (I + K K) + K sin q - K K cos q (Rodrigues).
    """
    linear, angular = np.split(motion_axis(model, joint), 2)
    K = pin.skew(angular)
    basis = np.zeros((4, 4, 4))
    basis[0, :3, :3] = np.eye(3) + K @ K
    basis[0, 3, 3] = 1.0
    basis[1, :3, :3] = K
    basis[2, :3, :3] = -K @ K
    basis[3, :3, 3] = linear
    fixed: Array = model.jointPlacements[joint].homogeneous
    return fixed @ basis


def turned(R: Array, vectors: Array) -> Array:
    """Products of matrices (..., 3, 3) and vectors (..., 3), broadcast.

    Three sums of many numbers take less time than many small matrix products, and a
    product does not depend on how many there are.
    """
    x, y, z = vectors[..., 0:1], vectors[..., 1:2], vectors[..., 2:3]
    products: Array = R[..., 0] * x + R[..., 1] * y + R[..., 2] * z
    return products
