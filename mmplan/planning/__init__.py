"""Motion planning: paths by OMPL, short straight motions, timing by toppra."""

from mmplan.planning.checking import PathChecker
from mmplan.planning.joints import (
    MotionLimits,
    MovingJoints,
    motion_limits,
    standing_joints,
    transfer_joints,
    transit_joints,
)
from mmplan.planning.paths import PathOutcome, PathResult, plan_path
from mmplan.planning.planners import available_planners, require_planner
from mmplan.planning.straight import ShortMotion, hand_motion, straight_motion
from mmplan.planning.timing import TimedPath, TimingResult, TimingSettings, time_path
from mmplan.planning.world import PlanningWorld

__all__ = [
    "MotionLimits",
    "MovingJoints",
    "PathChecker",
    "PathOutcome",
    "PathResult",
    "PlanningWorld",
    "ShortMotion",
    "TimedPath",
    "TimingResult",
    "TimingSettings",
    "available_planners",
    "hand_motion",
    "motion_limits",
    "plan_path",
    "require_planner",
    "standing_joints",
    "straight_motion",
    "time_path",
    "transfer_joints",
    "transit_joints",
]
