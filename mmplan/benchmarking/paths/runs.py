"""Doing one run of a path planner, and judging what it says."""

from __future__ import annotations

import platform
from datetime import datetime, timezone

from mmplan.benchmarking.paths.arena import Arena
from mmplan.benchmarking.paths.judge import collides_when_rechecked, judge, lengths
from mmplan.benchmarking.paths.records import PathJob, PathRecord, Prepared
from mmplan.shapes import Array


def run(job: PathJob, arena: Arena, planner: Prepared) -> PathRecord:
    """Do one run; the arena is for the judgement, which costs no time of it."""
    answer = planner.plan(job.seed)
    solved = answer.first is not None
    first = judge(arena, answer.first) if answer.first is not None else None
    last = judge(arena, answer.path) if answer.path is not None else first
    faults = [j.fault for j in (first, last) if j is not None and j.fault]
    first_length, first_way = _lengths(arena, answer.first)
    length, way = _lengths(arena, answer.path)
    return PathRecord(
        **job.key._asdict(),
        solved=solved,
        valid_first=first is not None and not first.fault,
        valid=solved and not faults,
        collides=answer.first is not None
        and collides_when_rechecked(arena, answer.first),
        fault=answer.message if not solved else "; ".join(dict.fromkeys(faults)),
        setup_seconds=planner.seconds,
        first_seconds=answer.first_seconds,
        seconds=answer.seconds,
        first_length=first_length,
        first_way=first_way,
        length=length,
        way=way,
        clearance=last.clearance if last is not None else None,
        states=answer.states,
        edges=answer.edges,
        step=answer.step,
        first=_listed(answer.first),
        path=_listed(answer.path),
        host=platform.node(),
        finished=datetime.now(timezone.utc).isoformat(timespec="seconds"),
    )


def _lengths(arena: Arena, path: Array | None) -> tuple[float | None, float | None]:
    return (None, None) if path is None else lengths(arena, path)


def _listed(path: Array | None) -> list[list[float]] | None:
    return None if path is None else path.tolist()
