"""The account of a task without a plan: what all the candidates died of."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from mmplan.blockers import collisions
from mmplan.motion import Blocked
from mmplan.optimizers import Optimization
from mmplan.scoring import End, Outcome, ScoreFunction

# How many colliding evaluations of each end are looked at again for names.
_SAMPLE = 300


@dataclass(frozen=True)
class Attempt:
    """One candidate that was tried: its score and what its motion failed at."""

    score: float
    blocked: Blocked


@dataclass(frozen=True)
class EndReport:
    """What became of the evaluations at one end of the task.

    `collisions` holds the pairs that overlap most often, as (first, second, share):
    the share of those evaluations in collision that were looked at again.
    """

    outcomes: dict[str, int]  # label of the outcome -> evaluations
    collisions: tuple[tuple[str, str, float], ...]


@dataclass(frozen=True)
class FailureReport:
    """Why there is no plan for a task."""

    task: int  # place in the scene, from 0
    object: str
    reason: str
    evaluations: int
    ends: tuple[EndReport, EndReport]  # start, goal
    grasps_by_end: tuple[int, int, int]  # at start only, at goal only, at both
    attempts: tuple[Attempt, ...]

    def to_json(self) -> dict[str, Any]:
        """The report as plain JSON values."""
        start_only, goal_only, both = self.grasps_by_end
        return {
            "task": self.task,
            "object": self.object,
            "reason": self.reason,
            "evaluations": self.evaluations,
            "ends": {
                end.name.lower(): {
                    "outcomes": self.ends[end].outcomes,
                    "collisions": [
                        {"first": a, "second": b, "share": share}
                        for a, b, share in self.ends[end].collisions
                    ],
                }
                for end in End
            },
            "grasps": {"start_only": start_only, "goal_only": goal_only, "both": both},
            "attempts": [
                {
                    "score": attempt.score,
                    "segment": attempt.blocked.segment,
                    "message": attempt.blocked.message,
                }
                for attempt in self.attempts
            ],
        }

    def lines(self) -> Iterator[str]:
        """The report for people, line by line."""
        yield f"task {self.task + 1} ({self.object}): {self.reason}"
        evaluations = f"of {self.evaluations} evaluations"
        yield f"{evaluations:<28}{'at the start':>16}{'at the goal':>14}"
        for label in self.ends[0].outcomes:
            start, goal = (end.outcomes[label] for end in self.ends)
            if start or goal:
                yield f"  {label:<34}{start:>8}{goal:>14}"
        for end in End:
            pairs = [f"{a} / {b} ({s:.0%})" for a, b, s in self.ends[end].collisions]
            if pairs:
                yield f"most frequent collisions at the {end.name.lower()}:"
                yield from (f"  {pair}" for pair in pairs)
        start_only, goal_only, both = self.grasps_by_end
        yield (
            f"grasps that work: {start_only} at the start only, {goal_only} at the "
            f"goal only, {both} at both"
        )
        for number, attempt in enumerate(self.attempts, start=1):
            yield (
                f"candidate {number} (score {attempt.score:.1f}): "
                f"{attempt.blocked.segment}: {attempt.blocked.message}"
            )


def failure_report(
    number: int,
    score: ScoreFunction,
    found: Optimization,
    attempts: tuple[Attempt, ...],
) -> FailureReport:
    """Account for a search without a plan; what collided is looked at again."""
    start, goal = (_end_report(End(end), score, found) for end in End)
    return FailureReport(
        task=number,
        object=score.task.object,
        reason=_reason(found, attempts),
        evaluations=found.evaluations,
        ends=(start, goal),
        grasps_by_end=found.grasps_by_end,
        attempts=attempts,
    )


def _reason(found: Optimization, attempts: tuple[Attempt, ...]) -> str:
    if attempts:
        segments = Counter(attempt.blocked.segment for attempt in attempts)
        named = ", ".join(f"{name} ({n})" for name, n in segments.most_common())
        return f"all {len(attempts)} candidates failed on the way: {named}"
    start_only, goal_only, both = found.grasps_by_end
    if both:
        return "no grasp of the last population works at both ends"
    if not start_only and not goal_only:
        return "no grasp works at either end"
    if not start_only or not goal_only:
        end = "goal" if start_only else "start"
        return f"no grasp works at the {end}"
    return "no single grasp works at both ends"


def _end_report(end: End, score: ScoreFunction, found: Optimization) -> EndReport:
    counts = {o.label: int(found.outcomes[end, o]) for o in Outcome}
    return EndReport(counts, collisions(score, end, found.evaluated, _SAMPLE).pairs())
