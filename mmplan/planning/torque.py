"""The limits of the arm's torques, by inverse dynamics.

The torques τ = M(q) q̈ + C(q, q̇) q̇ + g(q) are those of the whole robot, base and hand
moving as well, with what it carries; friction and the motors' own inertias are left
out, as URDFs seldom have them.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mmplan.hermite import HermiteCurve
from mmplan.planning.path_limit import Rows
from mmplan.robot import Robot
from mmplan.shapes import Array

# The share of a limit that is made use of, so that what passes between two places that
# are looked at stays within it.
SHARE = 0.98
# So many places are looked at from one sample of a motion to the next, both ends among
# them: the acceleration jumps at samples.
_PLACES = 5
# A torque that is this small against its limit does not change a motion.
_TINY = 1e-9


class TorqueLimit:
    """The torques of the arm's joints."""

    def __init__(self, robot: Robot, carried: pin.Inertia | None = None) -> None:
        """Limit a robot's torques; `carried` is what it holds, in the tool frame."""
        model = robot.model.copy()
        if carried is not None:
            placement = pin.SE3(robot.T_joint_tool)
            model.appendBodyToJoint(robot.tool_joint, carried, placement)
        self._model = model
        self._data = model.createData()
        self._arm = robot.arm.indices
        self._names = robot.arm.names
        self._limits = SHARE * model.upperEffortLimit[self._arm]

    def rows(self, q: Array, dq: Array, ddq: Array, /) -> Rows:
        """The limits at n places of a curve, a row a joint."""
        still = np.zeros_like(q)
        c = self._shares(q, still, still)
        return Rows(
            a=self._shares(q, still, dq) - c, b=self._shares(q, dq, ddq) - c, c=c
        )

    def stretch(self, curve: HermiteCurve) -> float:
        """By how much a motion must be slowed down; infinite where its weight is."""
        step = np.diff(curve.times)[:, None]
        inner = np.linspace(1e-9, 1.0 - 1e-9, _PLACES)  # both belong to the piece
        t = (curve.times[:-1, None] + step * inner).ravel()
        q, v, a = curve.positions(t), curve.velocities(t), curve.accelerations(t)
        still = np.zeros_like(q)
        weight = self._shares(q, still, still)
        if np.abs(weight).max() >= 1.0:
            return np.inf
        moved = self._shares(q, v, a) - weight  # shrinks with the square of the time
        room = np.where(moved > 0.0, 1.0 - weight, 1.0 + weight)
        return float(np.sqrt(np.maximum(np.abs(moved) / room, _TINY).max()))

    def too_weak(self, q: Array) -> str | None:
        """What cannot stand still at a configuration (nq,), in words."""
        still = np.zeros_like(q)[None]
        shares = np.abs(self._shares(q[None], still, still)[0]) * SHARE
        worst = int(shares.argmax())
        if shares[worst] < SHARE:
            return None
        name = self._names[worst]
        return f"{name} needs {shares[worst]:.0%} of its effort limit to stand still"

    def _shares(self, q: Array, v: Array, a: Array) -> Array:
        """Torques of the arm as shares (n, k) of their limits."""
        model, data = self._model, self._data
        torques = [pin.rnea(model, data, *row) for row in zip(q, v, a, strict=True)]
        shares: Array = np.array(torques)[:, self._arm] / self._limits
        return shares
