"""The limit of how fast the tool may move."""

from __future__ import annotations

import numpy as np

from mmplan.hermite import HermiteCurve
from mmplan.kinematics import ForwardKinematics, FrameJacobians
from mmplan.planning.path_limit import Rows
from mmplan.robot import Robot
from mmplan.shapes import Array

# The share of the limit that is made use of, so that what passes between two places
# that are looked at stays within it.
SHARE = 0.99
# So many places are looked at from one sample of a motion to the next.
_PLACES = 4


class ToolSpeed:
    """The speed of the tool frame's origin, m/s: |J q'(s)| ds/dt is limited."""

    def __init__(self, robot: Robot, limit: float) -> None:
        """Limit the speed of a robot's tool."""
        model = robot.model
        self._limit = SHARE * limit
        self._kinematics = ForwardKinematics(model)
        every = np.arange(model.nv)
        self._jacobians = FrameJacobians(model, robot.tool_frame, every)

    def rows(self, q: Array, dq: Array, _ddq: Array, /) -> Rows:
        """The limit at n places of a curve, one row."""
        way = self._speeds(q, dq)[:, None]  # m for each unit of s
        nothing = np.zeros_like(way)
        return Rows(a=nothing, b=(way / self._limit) ** 2, c=nothing)

    def stretch(self, curve: HermiteCurve) -> float:
        """By how much a motion must be slowed down."""
        steps = np.diff(curve.times)[:, None] * np.arange(_PLACES) / _PLACES
        t = (curve.times[:-1, None] + steps).ravel()
        speeds = self._speeds(curve.positions(t), curve.velocities(t))
        return float(speeds.max()) / self._limit

    def _speeds(self, q: Array, q_dot: Array) -> Array:
        """How fast the tool moves (n,) where joints move at q_dot (n, nq)."""
        J = self._jacobians(self._kinematics(q))[:, :3]
        speeds: Array = np.linalg.norm(np.einsum("nij,nj->ni", J, q_dot), axis=1)
        return speeds
