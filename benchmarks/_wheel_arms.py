"""Arms of the example-robot-data wheel, as its URDF files describe them.

They are here to measure and test inverse kinematics on; robots to plan with are in
robots/. Joints that are not the arm's stand where Pinocchio's neutral configuration
has them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from mmplan.assets import example_robots
from mmplan.shapes import Array


@dataclass(frozen=True)
class WheelArm:
    """An arm by its URDF in the wheel, its joints in order, and the link it moves."""

    urdf: str
    joints: tuple[str, ...]
    tip: str


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm of a model, with forward kinematics by Pinocchio alone."""

    model: pin.Model
    joints: tuple[str, ...]
    frame: int

    @cached_property
    def limits(self) -> tuple[Array, Array]:
        """Lower and upper limits (k,), a whole turn for joints without limits."""
        lower, upper = [], []
        for joint in self._of_arm:
            endless = joint.nq == 2
            lower.append(-np.pi if endless else self._limit("lower", joint))
            upper.append(np.pi if endless else self._limit("upper", joint))
        return np.array(lower), np.array(upper)

    def draw(self, n: int, seed: int) -> Array:
        """Random configurations (n, k) within the limits."""
        lower, upper = self.limits
        return np.random.default_rng(seed).uniform(lower, upper, (n, len(lower)))

    def tool_poses(self, q: Array) -> Array:
        """Poses (n, 4, 4) of the tool at q (n, k), seen from what carries the arm."""
        data = self.model.createData()
        base = int(self.model.parents[self.model.getJointId(self.joints[0])])
        T = np.empty((len(q), 4, 4))
        for i, row in enumerate(q):
            full = pin.neutral(self.model)
            for joint, value in zip(self._of_arm, row, strict=True):
                turn = (np.cos(value), np.sin(value))
                full[joint.idx_q : joint.idx_q + joint.nq] = (
                    turn if joint.nq == 2 else value
                )
            pin.framesForwardKinematics(self.model, data, full)
            tool = data.oMi[base].inverse() * data.oMf[self.frame]
            T[i] = tool.homogeneous
        return T

    @cached_property
    def _of_arm(self) -> list[pin.JointModel]:
        return [self.model.joints[self.model.getJointId(j)] for j in self.joints]

    def _limit(self, which: str, joint: pin.JointModel) -> float:
        limits = getattr(self.model, f"{which}PositionLimit")
        limit = float(limits[joint.idx_q])
        return limit if np.isfinite(limit) else np.copysign(np.pi, limit)


def load_arm(name: str) -> Arm:
    """The arm of a name in ARMS.

    Raises:
        FileNotFoundError: The wheel is not installed, or has no such URDF.
    """
    arm = ARMS[name]
    share = example_robots()
    files = sorted(share.rglob(f"robots/**/{arm.urdf}")) if share else []
    if not files:
        raise FileNotFoundError(f"{arm.urdf}: pip install 'mmplan[robots]'")
    model = pin.buildModelFromUrdf(str(files[0]))
    return Arm(model, arm.joints, model.getFrameId(arm.tip, pin.FrameType.BODY))


def _numbered(pattern: str, first: int, last: int) -> tuple[str, ...]:
    return tuple(pattern.format(i) for i in range(first, last + 1))


_UR = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
_UR_JOINTS = tuple(f"{name}_joint" for name in _UR)
_PR2 = ("shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex")
_PR2_WRIST = ("forearm_roll", "wrist_flex", "wrist_roll")
_PR2_JOINTS = tuple(f"r_{name}_joint" for name in (*_PR2, *_PR2_WRIST))
_ROMEO = ("LShoulderPitch", "LShoulderYaw", "LElbowRoll", "LElbowYaw")
_ROMEO_WRIST = ("LWristRoll", "LWristYaw", "LWristPitch")
_ICUB = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow")
_ICUB_WRIST = ("wrist_prosup", "wrist_pitch", "wrist_yaw")
_SO = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll")

ARMS: dict[str, WheelArm] = {
    "ur3": WheelArm("ur3_robot.urdf", _UR_JOINTS, "tool0"),
    "ur5": WheelArm("ur5_robot.urdf", _UR_JOINTS, "tool0"),
    "ur10": WheelArm("ur10_robot.urdf", _UR_JOINTS, "tool0"),
    "kinova": WheelArm(
        "kinova.urdf", _numbered("j2s6s200_joint_{}", 1, 6), "j2s6s200_end_effector"
    ),
    "z1": WheelArm("z1.urdf", _numbered("joint{}", 1, 6), "link06"),
    "talos_left_arm": WheelArm(
        "talos_left_arm.urdf", _numbered("arm_left_{}_joint", 2, 7), "arm_left_7_link"
    ),
    "centauro": WheelArm("centauro.urdf", _numbered("j_arm1_{}", 1, 6), "arm1_6"),
    "panda": WheelArm("panda.urdf", _numbered("panda_joint{}", 1, 7), "panda_hand"),
    "xarm7": WheelArm("xarm7.urdf", _numbered("joint{}", 1, 7), "link7"),
    "pr2": WheelArm("pr2.urdf", _PR2_JOINTS, "r_gripper_tool_frame"),
    "pr2_torso": WheelArm(
        "pr2.urdf", ("torso_lift_joint", *_PR2_JOINTS), "r_gripper_tool_frame"
    ),
    "tiago": WheelArm(
        "tiago_no_hand.urdf", _numbered("arm_{}_joint", 1, 7), "arm_7_link"
    ),
    "tiago_torso": WheelArm(
        "tiago_no_hand.urdf",
        ("torso_lift_joint", *_numbered("arm_{}_joint", 1, 7)),
        "arm_7_link",
    ),
    "talos": WheelArm(
        "talos_reduced.urdf", _numbered("arm_left_{}_joint", 1, 7), "arm_left_7_link"
    ),
    "icub": WheelArm(
        "icub.urdf", tuple(f"l_{name}" for name in (*_ICUB, *_ICUB_WRIST)), "l_hand"
    ),
    "romeo": WheelArm("romeo_small.urdf", (*_ROMEO, *_ROMEO_WRIST), "l_wrist"),
    "baxter": WheelArm(
        "baxter.urdf",
        tuple(f"left_{name}" for name in ("s0", "s1", "e0", "e1", "w0", "w1", "w2")),
        "left_gripper",
    ),
    "tiago_pro": WheelArm(
        "tiago_pro.urdf", _numbered("arm_left_{}_joint", 1, 7), "arm_left_tool_link"
    ),
    "so101": WheelArm("so101.urdf", _SO, "gripper_frame_link"),
}
