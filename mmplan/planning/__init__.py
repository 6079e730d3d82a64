"""Motion planning: paths by OMPL, short straight motions, timing by toppra."""

from mmplan.planning.checking import PathChecker
from mmplan.planning.drive import Drive, time_drive
from mmplan.planning.drive_search import plan_drive
from mmplan.planning.joints import (
    MotionLimits,
    MovingJoints,
    motion_limits,
    standing_joints,
    transfer_joints,
    transit_joints,
)
from mmplan.planning.path_limit import PathLimit
from mmplan.planning.paths import PathOutcome, PathResult, plan_path
from mmplan.planning.planners import available_planners, require_planner
from mmplan.planning.reeds_shepp import ReedsShepp
from mmplan.planning.rolling import Steering, TurnInPlace
from mmplan.planning.straight import ShortMotion, hand_motion, straight_motion
from mmplan.planning.timing import (
    TimedPath,
    TimingResult,
    TimingSettings,
    joined,
    time_path,
)
from mmplan.planning.tool_speed import ToolSpeed
from mmplan.planning.torque import TorqueLimit
from mmplan.planning.upright import UprightRule, UprightWorld
from mmplan.planning.world import PlanningWorld

__all__ = [
    "Drive",
    "MotionLimits",
    "MovingJoints",
    "PathChecker",
    "PathLimit",
    "PathOutcome",
    "PathResult",
    "PlanningWorld",
    "ReedsShepp",
    "ShortMotion",
    "Steering",
    "TimedPath",
    "TimingResult",
    "TimingSettings",
    "ToolSpeed",
    "TorqueLimit",
    "TurnInPlace",
    "UprightRule",
    "UprightWorld",
    "available_planners",
    "hand_motion",
    "joined",
    "motion_limits",
    "plan_drive",
    "plan_path",
    "require_planner",
    "standing_joints",
    "straight_motion",
    "time_drive",
    "time_path",
    "transfer_joints",
    "transit_joints",
]
