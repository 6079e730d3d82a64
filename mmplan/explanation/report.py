"""An explanation for people, line by line, and as plain JSON values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from mmplan.explanation.causes import Cause
from mmplan.explanation.explaining import Explanation
from mmplan.scoring import End

_MOST_FAILED = 4  # changes that did not help, told by name


def explanation_lines(found: Explanation) -> Iterator[str]:
    """What there is to say of one task."""
    verdict = "solvable" if found.solvable else "no solution found"
    yield f"task {found.task + 1} ({found.object}): {verdict}{_hardness(found)}"
    for number, cause in enumerate(found.causes):
        yield f"{'also' if number else 'cause'}: {cause}"
    if found.near_miss is not None:
        yield f"nearest miss: {found.near_miss}"
    yield from _relaxation_lines(found)
    yield ""
    yield from _funnel_lines(found)
    yield from _search_lines(found)
    for end in End:
        pairs = [f"{a} / {b} ({share:.0%})" for a, b, share in found.pairs[end]]
        if pairs:
            yield f"most frequent collisions at the {end.name.lower()}:"
            yield from (f"  {pair}" for pair in pairs)


def explanation_json(found: Explanation) -> dict[str, Any]:
    """The same for programs."""
    start_only, goal_only, both = found.grasps_by_end
    return {
        "task": found.task,
        "object": found.object,
        "solvable": found.solvable,
        "causes": [_cause_json(cause) for cause in found.causes],
        "near_miss": _near_miss_json(found),
        "relaxations": [asdict(r) for r in found.relaxations],
        "stages": [
            {"label": s.label, "start": s.left[0], "goal": s.left[1]}
            for s in found.stages
        ],
        "search": {
            "evaluations": found.evaluations,
            "feasible": {"start": found.feasible[0], "goal": found.feasible[1]},
            "grasps": {"start_only": start_only, "goal_only": goal_only, "both": both},
            "candidates": found.candidates,
            "first_with_free_motions": found.first_free,
        },
        "collisions": {
            end.name.lower(): [
                {"first": a, "second": b, "share": share}
                for a, b, share in found.pairs[end]
            ]
            for end in End
        },
        "planned": found.planned,
    }


def _hardness(found: Explanation) -> str:
    """How often a pair drawn at random is feasible."""
    if not found.solvable:
        return ""
    tried, feasible = found.stages[0].left, found.stages[-1].left
    shares = [
        f"{n / m:.2%} at the {end.name.lower()}"
        for n, m, end in zip(feasible, tried, End, strict=True)
    ]
    planned = ", and a verified plan was found" if found.planned else ""
    return f"; of pairs drawn at random {' and '.join(shares)} are feasible{planned}"


def _relaxation_lines(found: Explanation) -> Iterator[str]:
    helps = [r.text for r in found.relaxations if r.solvable]
    fails = [r.text for r in found.relaxations if not r.solvable]
    if helps:
        yield "solvable, smallest change first (each was tried):"
        yield from (f"  {text}" for text in helps)
    if fails and not helps:
        named = "; ".join(fails[:_MOST_FAILED])
        more = f"; and {len(fails) - _MOST_FAILED} more"
        yield f"not solvable {named}{more if len(fails) > _MOST_FAILED else ''}"


def _funnel_lines(found: Explanation) -> Iterator[str]:
    yield f"{'pairs of base and grasp':<34}{'at the start':>16}{'at the goal':>16}"
    tried = found.stages[0].left
    for stage in found.stages:
        columns = [
            f"{n:>9} {n / max(m, 1):>6.1%}"
            for n, m in zip(stage.left, tried, strict=True)
        ]
        yield f"  {stage.label:<32}{''.join(columns)}"


def _search_lines(found: Explanation) -> Iterator[str]:
    start, goal = found.feasible
    start_only, goal_only, both = found.grasps_by_end
    yield (
        f"a search of {found.evaluations} evaluations: {start} feasible at the start, "
        f"{goal} at the goal"
    )
    yield (
        f"  grasps that work: {start_only} at the start only, {goal_only} at the goal "
        f"only, {both} at both"
    )
    if found.candidates:
        free = f"number {found.first_free}" if found.first_free else "none"
        yield (
            f"  of {found.candidates} candidates the first one with free straight "
            f"motions is {free}"
        )


def _cause_json(cause: Cause) -> dict[str, Any]:
    return {
        "kind": cause.kind,
        "end": None if cause.end is None else cause.end.name.lower(),
        "text": str(cause),
        "culprits": [{"name": n, "alone": share} for n, share in cause.culprits],
    }


def _near_miss_json(found: Explanation) -> dict[str, Any] | None:
    miss = found.near_miss
    if miss is None:
        return None
    works_at = None if miss.works_at is None else miss.works_at.name.lower()
    return {
        **asdict(miss),
        "end": miss.end.name.lower(),
        "works_at": works_at,
        "text": str(miss),
    }
