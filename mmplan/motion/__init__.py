"""The motion of one task: from where the robot is to the object delivered."""

from mmplan.motion.parts import Blocked
from mmplan.motion.task_motion import Outcome, TaskMotion

__all__ = ["Blocked", "Outcome", "TaskMotion"]
