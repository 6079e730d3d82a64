"""The cause: the test that nothing passes at one end, told by what would pass it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from mmplan.explanation.evidence import Evidence
from mmplan.explanation.survey import Survey
from mmplan.failure import Attempt
from mmplan.motion import Blocked
from mmplan.scoring import End, Outcome

Kind = Literal[
    "hand",
    "grasp quality",
    "carry",
    "reach",
    "joint limits",
    "base bounds",
    "base",
    "collision",
    "hand opened",
    "common grasp",
    "approach",
    "grasp",
    "lift",
    "lower",
    "release",
    "retreat",
    "transit",
    "transfer",
    "verification",
]
_NAMED = 5
# Straight motions of the tool.
STRAIGHT: tuple[Kind, ...] = ("approach", "lift", "lower", "retreat")
# Segments that are planned.
PATHS: tuple[Kind, ...] = ("transit", "transfer")
# From the first test that can fail to the last.
_AT_AN_END: tuple[Kind, ...] = (
    "hand",
    "grasp quality",
    "carry",
    "reach",
    "joint limits",
    "base bounds",
    "base",
    "collision",
    "hand opened",
)
_FURTHEST: Mapping[Outcome, Kind] = {
    Outcome.NO_CONTACT: "hand",
    Outcome.LOW_QUALITY: "grasp quality",
    Outcome.NOT_CARRIED: "carry",
    Outcome.COLLISION: "collision",
    Outcome.HAND_OPEN_COLLISION: "hand opened",
}
_TEXTS: Mapping[Kind, str] = {
    "hand": "the hand closes on the object in none of the grasps",
    "grasp quality": "no grasp is of the quality that the scene wants",
    "carry": "no grasp lets the arm hold the object upright where it must become so",
    "reach": "the arm reaches no grasp from anywhere",
    "joint limits": "the arm reaches grasps only beyond its joint limits",
    "base bounds": "the arm reaches grasps only from where the base may not go",
    "base": "wherever the arm reaches a grasp from, the base is in collision",
    "collision": "the robot is in collision in every configuration that reaches",
    "hand opened": "there is no room for the opened hand around the object",
}


@dataclass(frozen=True)
class Cause:
    """What stands in the way first.

    `end` is None where it is no matter of one end. `culprits` are what is hit, by
    name, with the share of the blame for all collisions.
    """

    kind: Kind
    end: End | None
    text: str
    culprits: tuple[tuple[str, float], ...] = ()

    def blaming(self, names: Sequence[str]) -> Cause:
        """The cause whose first culprits are those whose removal was seen to help."""
        order = sorted(self.culprits, key=lambda culprit: culprit[0] not in names)
        return replace(self, culprits=tuple(order))

    def __str__(self) -> str:
        """The cause in a line."""
        where = "" if self.end is None else f"at the {self.end.name.lower()} "
        text = f"{where}{self.text}"
        if not self.culprits:
            return text
        named = ", ".join(f"{name} ({part:.0%})" for name, part in self.culprits[:3])
        return f"{text}: {named}"


def kind_at(survey: Survey, outcomes: frozenset[Outcome]) -> Kind:
    """Which test nothing passes at an end where nothing is feasible.

    Every test is judged by the pairs that would pass all others before it: whether an
    arm could reach is asked of bases in collision, too. `outcomes` are all that were
    seen at this end.
    """
    if not np.any(survey.holds == Outcome.SCORED):
        seen = (Outcome(value) for value in np.unique(survey.holds))
        best = max(seen, default=Outcome.NO_CONTACT)
        return _FURTHEST.get(best, "hand")
    furthest = max(outcomes)
    if furthest in _FURTHEST:
        return _FURTHEST[furthest]
    reaches = survey.reach == Outcome.SCORED
    if not reaches.any():
        return "joint limits" if Outcome.JOINT_LIMITS in survey.reach else "reach"
    inside = survey.base != Outcome.OUT_OF_BOUNDS
    return "base" if np.any(reaches & inside) else "base bounds"


def causes_of(evidence: Evidence) -> tuple[Cause, ...]:
    """What is in the way, the first of all tests first; nothing if there is nothing."""
    failing = [end for end in End if Outcome.SCORED not in evidence.outcomes(end)]
    if failing:
        causes = [_cause_at(end, evidence) for end in failing]
        causes.sort(key=lambda c: _AT_AN_END.index(c.kind))
        return tuple(causes[:1] if causes[0].end is None else causes)
    if not evidence.grasps_by_end[2]:
        return (_no_common_grasp(evidence),)
    if None in evidence.blocked:
        return ()
    return (_blocked([b for b in evidence.blocked if b is not None]),)


def cause_on_the_way(evidence: Evidence, attempts: Sequence[Attempt]) -> Cause:
    """The segment at which most candidates fail that have no straight motion blocked.

    What is hit on the straight way through the joints' space is named as the culprit.
    """
    cause = _blocked([attempt.blocked for attempt in attempts])
    if cause.kind not in PATHS:
        return cause
    return replace(cause, culprits=evidence.in_the_way(cause.kind).culprits()[:_NAMED])


def _blocked(blocked: Sequence[Blocked]) -> Cause:
    """The segment that fails for most candidates, with what is said of the first."""
    (segment, count), *_ = Counter(b.segment for b in blocked).most_common(1)
    message = next(b.message for b in blocked if b.segment == segment)
    kind = next(k for k in get_args(Kind) if k == segment)
    text = f"{segment} fails for {count} of {len(blocked)} candidates: {message}"
    return Cause(kind, None, text)


def _cause_at(end: End, evidence: Evidence) -> Cause:
    """The cause at an end; a hand that never closes is no matter of one end."""
    kind = kind_at(evidence.surveys[end], evidence.outcomes(end))
    if kind in ("hand", "grasp quality", "carry"):
        return Cause(kind, None, _TEXTS[kind])
    found = None
    if kind == "base":
        found = evidence.base_collisions(end)
    if kind == "collision":
        found = evidence.collisions(end, (Outcome.COLLISION,))
    if kind == "hand opened":
        found = evidence.collisions(end, (Outcome.HAND_OPEN_COLLISION,))
    culprits = () if found is None else found.culprits()[:_NAMED]
    return Cause(kind, end, _TEXTS[kind], culprits)


def _no_common_grasp(evidence: Evidence) -> Cause:
    start, goal, _ = evidence.grasps_by_end
    text = (
        "no single grasp works at both ends; of those that were tried, "
        f"{start} work at the start only, {goal} at the goal only"
    )
    end = End.START if not start else End.GOAL
    found = evidence.collisions(end, (Outcome.COLLISION, Outcome.HAND_OPEN_COLLISION))
    return Cause("common grasp", None, text, found.culprits()[:_NAMED])
