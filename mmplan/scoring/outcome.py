"""How the evaluation of one base and one grasp can end."""

from __future__ import annotations

from enum import IntEnum


class End(IntEnum):
    """The two ends of a task: where the object stands and where it must go."""

    START = 0
    GOAL = 1


class Outcome(IntEnum):
    """Why a base and a grasp score 0, or that they score; tested in this order."""

    OUT_OF_BOUNDS = 0  # the base is outside of where it may go
    BASE_COLLISION = 1  # the base alone hits something
    NO_IK = 2  # the arm does not reach the grasp
    JOINT_LIMITS = 3  # it does, but only beyond its joint limits
    NO_CONTACT = 4  # the hand does not close on the object
    LOW_QUALITY = 5  # the grasp quality is below the threshold
    NOT_CARRIED = 6  # held so, the object cannot be upright where it must become so
    COLLISION = 7  # the robot hits something with the hand closed
    HAND_OPEN_COLLISION = 8  # only the opened hand does
    SCORED = 9

    @property
    def label(self) -> str:
        """What to call it in a report."""
        return _LABELS[self]


_LABELS = {
    Outcome.OUT_OF_BOUNDS: "base out of bounds or in a zone",
    Outcome.BASE_COLLISION: "base in collision",
    Outcome.NO_CONTACT: "hand does not close on the object",
    Outcome.LOW_QUALITY: "grasp quality too low",
    Outcome.NOT_CARRIED: "cannot be carried upright",
    Outcome.NO_IK: "out of the arm's reach",
    Outcome.JOINT_LIMITS: "beyond the joint limits",
    Outcome.COLLISION: "in collision",
    Outcome.HAND_OPEN_COLLISION: "opened hand in collision",
    Outcome.SCORED: "feasible",
}
