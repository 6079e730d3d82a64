"""Forward kinematics and Jacobians of many configurations at once."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mmplan.shapes import Array


def joint_placements(model: pin.Model, q: Array) -> Array:
    """Poses T_world_joint (n, njoints, 4, 4) of all joints at q (n, nq).

    The same as Pinocchio's `forwardKinematics` and `data.oMi`, for models whose joints
    all have one degree of freedom, one call for all configurations.
    """
    placements = np.empty((len(q), model.njoints, 4, 4))
    placements[:, 0] = np.eye(4)
    for joint in range(1, model.njoints):
        fixed = model.jointPlacements[joint].homogeneous
        moved = _joint_motion(model, joint, q[:, model.joints[joint].idx_q])
        parent = placements[:, model.parents[joint]]
        placements[:, joint] = parent @ (fixed @ moved)
    return placements


def tool_jacobians(model: pin.Model, frame: int, q: Array, columns: Array) -> Array:
    """Jacobians (n, 6, k) of a frame, in its own axes, of the joints in `columns`."""
    data = model.createData()
    J = np.empty((len(q), 6, len(columns)))
    for i, configuration in enumerate(q):
        full = pin.computeFrameJacobian(model, data, configuration, frame)
        J[i] = full[:, columns]
    return J


def _joint_motion(model: pin.Model, joint: int, values: Array) -> Array:
    """The transforms (n, 4, 4) of one joint at its values (n,)."""
    linear, angular = np.split(motion_axis(model, joint), 2)
    T = np.zeros((len(values), 4, 4))
    T[:, 3, 3] = 1.0
    T[:, :3, 3] = values[:, None] * linear
    K = pin.skew(angular)
    sin, cos = np.sin(values)[:, None, None], np.cos(values)[:, None, None]
    T[:, :3, :3] = np.eye(3) + (sin * K + (1.0 - cos) * (K @ K) if K.any() else 0.0)
    return T


def motion_axis(model: pin.Model, joint: int) -> Array:
    """The twist (linear, angular) of a joint of one degree of freedom, (6,)."""
    data = model.joints[joint].createData()
    model.joints[joint].calc(data, np.zeros(model.nq))
    subspace: Array = np.asarray(data.S).reshape(6, -1)
    if subspace.shape[1] != 1:
        raise ValueError(f"joint {model.names[joint]} has more than one freedom")
    return subspace[:, 0]
