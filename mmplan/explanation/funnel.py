"""The funnel: how many pairs of base and grasp are left after each test."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.explanation.survey import Survey
from mmplan.scoring import Outcome

# What has passed where an outcome is not the end of a pair.
_PASSED = {
    Outcome.OUT_OF_BOUNDS: "base within its bounds",
    Outcome.BASE_COLLISION: "base free of collision",
    Outcome.NO_IK: "arm reaches the grasp",
    Outcome.JOINT_LIMITS: "within the joint limits",
    Outcome.NO_CONTACT: "hand closes on the object",
    Outcome.LOW_QUALITY: "grasp quality high enough",
    Outcome.NOT_CARRIED: "can be carried upright",
    Outcome.COLLISION: "free of collision, hand closed",
    Outcome.HAND_OPEN_COLLISION: "free of collision, hand opened",
}
TRIED, NEAR = "tried", "grasp within the arm's length"


@dataclass(frozen=True)
class Stage:
    """One stage: how many pairs are left at the start and at the goal."""

    label: str
    left: tuple[int, int]


def funnel(start: Survey, goal: Survey) -> tuple[Stage, ...]:
    """The stages in the order of the tests."""
    pairs = zip(_counts(start), _counts(goal), strict=True)
    return tuple(Stage(label, (a, b)) for (label, a), (_, b) in pairs)


def _counts(survey: Survey) -> Iterator[tuple[str, int]]:
    yield TRIED, len(survey)
    for outcome in Outcome:
        if outcome == Outcome.SCORED:
            return
        passed = survey.outcome > outcome
        if outcome == Outcome.NO_IK:
            left = (survey.outcome >= outcome) & (survey.near | passed)
            yield NEAR, _count(left)
        label = _PASSED.get(outcome, f"not {outcome.label}")
        yield label, _count(passed)


def _count(mask: npt.NDArray[np.bool_]) -> int:
    return int(np.count_nonzero(mask))
