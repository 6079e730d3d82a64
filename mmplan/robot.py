"""The robot: kinematics, collision bodies, and its groups base, arm and hand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.ik import InverseKinematics
from mmplan.kinematics import joint_placements
from mmplan.shapes import Array, read_only

BaseType: TypeAlias = Literal["xy", "planar", "diff_drive", "reeds_shepp", "fixed"]


class Follower(NamedTuple):
    """A joint that mimics another: q[follower] = multiplier * q[leader] + offset."""

    follower: int  # its place in q
    leader: int  # its place in q
    multiplier: float
    offset: float


@dataclass(frozen=True, eq=False)
class JointGroup:
    """Joints that belong together; `indices` are their places in q (and in v).

    A joint that `wraps` turns without end: its position counts modulo 2 pi, and its
    limits are infinite. `followers` are joints of the group that mimic others of it.
    """

    names: tuple[str, ...]
    indices: npt.NDArray[np.int_]  # (k,)
    lower: Array  # (k,)
    upper: Array  # (k,)
    velocity: Array  # (k,), limits in m/s or rad/s
    acceleration: Array  # (k,), limits in m/s^2 or rad/s^2
    wraps: npt.NDArray[np.bool_]  # (k,)
    followers: tuple[Follower, ...] = ()

    def __len__(self) -> int:
        """The number of joints."""
        return len(self.names)

    @cached_property
    def leads(self) -> npt.NDArray[np.bool_]:
        """Which joints (k,) move by themselves, following no others."""
        return ~np.isin(self.indices, [f.follower for f in self.followers])


@dataclass(frozen=True, eq=False)
class Robot:
    """A mobile manipulator, ready to compute with. Treat `model` as read-only.

    `geometry` has the robot's collision bodies and the pairs among them that are
    checked, nothing of the scene. `tool_frame` is the id of the tool frame in `model`:
    between the finger pads, z the approach direction, y the closing direction.
    """

    name: str
    description: str
    model: pin.Model
    geometry: pin.GeometryModel
    base: JointGroup
    arm: JointGroup
    hand: JointGroup
    base_type: BaseType
    turning_radius: float  # m, of a reeds_shepp base, else 0
    base_radius: float  # m
    reach: float  # m, horizontal, from the base's centre to the tool, arm stretched
    tool_frame: int
    hand_open: Array  # (hand joints,)
    hand_closed: Array  # (hand joints,)
    ik: InverseKinematics
    ik_solver: str  # its name
    configurations: dict[str, Array]  # name -> (arm joints,)
    score_scales: ScoreScales
    path: Path  # its robot.yaml

    @cached_property
    def base_joint(self) -> int:
        """The id of the last joint of the base; 0, the world, of a fixed base."""
        return int(self.model.getJointId(self.base.names[-1])) if len(self.base) else 0

    @cached_property
    def tool_joint(self) -> int:
        """The id of the joint that moves the tool frame."""
        return int(self.model.frames[self.tool_frame].parentJoint)

    @cached_property
    def T_joint_tool(self) -> Array:
        """The pose (4, 4) of the tool frame in the frame of its joint."""
        return read_only(self.model.frames[self.tool_frame].placement.homogeneous)

    @cached_property
    def q_neutral(self) -> Array:
        """A configuration (nq,): base at the origin, hand open.

        Each joint of the arm is at 0, or at its limit nearest to that.
        """
        q = np.zeros(self.model.nq)
        q[self.arm.indices] = np.clip(0.0, self.arm.lower, self.arm.upper)
        q[self.hand.indices] = self.hand_open
        return read_only(q)

    def base_poses(self, q_base: Array) -> Array:
        """The poses T_world_base (n, 4, 4) of the base's frame at (n, base joints)."""
        q = np.tile(self.q_neutral, (len(q_base), 1))
        q[:, self.base.indices] = q_base
        return joint_placements(self.model, q)[:, self.base_joint]

    def with_followers(self, q: Array) -> Array:
        """Configurations (..., nq) with joints that mimic others where they belong."""
        q = q.copy()
        for follower, leader, multiplier, offset in self.hand.followers:
            q[..., follower] = multiplier * q[..., leader] + offset
        return q

    def tool_pose(self, q: Array) -> Array:
        """The pose T_world_tool (4, 4) at a configuration (nq,)."""
        data = self.model.createData()
        pin.forwardKinematics(self.model, data, q)
        joint: Array = data.oMi[self.tool_joint].homogeneous
        return joint @ self.T_joint_tool

    def link_of(self, body: pin.GeometryObject) -> str:
        """The name of the link that a collision body belongs to."""
        return str(self.model.frames[body.parentFrame].name)

    def kind_of(self, body: pin.GeometryObject) -> Literal["base", "arm", "finger"]:
        """Whether a collision body moves with the base alone, the arm, or a finger."""
        joints = set(self.model.supports[body.parentJoint]) - {0}
        if joints <= self._joint_ids(self.base):
            return "base"
        return "finger" if joints & self._joint_ids(self.hand) else "arm"

    def _joint_ids(self, group: JointGroup) -> set[int]:
        return {int(self.model.getJointId(name)) for name in group.names}


@dataclass(frozen=True)
class ScoreScales:
    """Constants of the robot that bring the score's terms to one scale.

    A term at its scale counts 50: `manipulability` is a value of M (paper, eq. 1) and
    `clutter` one of C (paper, eq. 2) that is rarely exceeded.
    """

    manipulability: float
    clutter: float
