"""The tables of a benchmark of path planners."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from mmplan.benchmarking.paths.records import PathRecord
from mmplan.benchmarking.table import Table

ALL = "all"
_NOTE = (
    "Solved: runs that ended with a path. First valid: the verifier proved that the "
    "first path touches nothing at any time; valid: nor does the shortened one. Times: "
    "CPU ms to the first path and until it was short, median / 95th percentile; a run "
    "that found none counts with the time that it spent. Lengths: medians, in joint "
    "space (rad; prismatic joints in m) and weighted by the joints' lever arms (m). "
    "Colliding: first paths that collide when checked again at steps of 1/64 rad."
)
_EFFORT_NOTE = (
    "Medians of what was checked, where the planner tells; the longest step (rad) "
    "between two checks of any first path; the median CPU ms of preparing a world, "
    "which no other time includes."
)


def path_tables(records: Sequence[PathRecord]) -> list[Table]:
    """The tables of all runs: how planners did overall and by family, and the effort.

    Planners come in the order of their median times.
    """
    families = list(dict.fromkeys(r.family for r in records))
    rows = [
        _row(family, planner, runs)
        for family in (ALL, *families)
        for planner, runs in _by_planner(_of_family(records, family))
    ]
    header = (
        "family",
        "contender",
        "solved",
        "first valid",
        "valid",
        "runs",
        "first path, ms",
        "shortened, ms",
        "first, rad",
        "shortened, rad",
        "first, m",
        "shortened, m",
        "colliding",
    )
    efforts = [_effort(planner, runs) for planner, runs in _by_planner(records)]
    effort_header = (
        "contender",
        "states",
        "edges",
        "longest step, rad",
        "preparing, ms",
    )
    return [
        Table("Paths", _NOTE, header, tuple(rows)),
        Table("Effort", _EFFORT_NOTE, effort_header, tuple(efforts)),
    ]


def _of_family(records: Iterable[PathRecord], family: str) -> list[PathRecord]:
    return [r for r in records if family in (ALL, r.family)]


def _by_planner(
    records: Sequence[PathRecord],
) -> list[tuple[str, list[PathRecord]]]:
    groups: dict[tuple[str, str], list[PathRecord]] = {}
    for r in records:
        groups.setdefault((r.planner, r.settings), []).append(r)
    labels = contender_labels(groups)
    named = [(labels[key], runs) for key, runs in groups.items()]
    return sorted(
        named, key=lambda g: float(np.median([r.first_seconds for r in g[1]]))
    )


def contender_labels(keys: Iterable[tuple[str, str]]) -> dict[tuple[str, str], str]:
    """Names of planners with settings (JSON), which are told where they differ."""
    settings: dict[str, list[dict[str, object]]] = {}
    keys = list(keys)
    for planner, text in keys:
        settings.setdefault(planner, []).append(json.loads(text))
    labels = {}
    for planner, text in keys:
        mine, all_of_them = json.loads(text), settings[planner]
        told = [
            f"{name} {value}"
            for name, value in mine.items()
            if any(other.get(name) != value for other in all_of_them)
        ]
        labels[planner, text] = f"{planner} ({', '.join(told)})" if told else planner
    return labels


def _row(family: str, planner: str, runs: Sequence[PathRecord]) -> tuple[str, ...]:
    return (
        family,
        planner,
        str(sum(r.solved for r in runs)),
        str(sum(r.valid_first for r in runs)),
        str(sum(r.valid for r in runs)),
        str(len(runs)),
        _times([r.first_seconds for r in runs]),
        _times([_until_short(r) for r in runs if r.seconds is not None]),
        _median(runs, lambda r: r.first_length),
        _median(runs, lambda r: r.length),
        _median(runs, lambda r: r.first_way),
        _median(runs, lambda r: r.way),
        str(sum(r.collides for r in runs)),
    )


def _until_short(record: PathRecord) -> float:
    assert record.seconds is not None
    return record.seconds


def _effort(planner: str, runs: Sequence[PathRecord]) -> tuple[str, ...]:
    steps = [r.step for r in runs if r.step is not None]
    return (
        planner,
        _median(runs, lambda r: r.states, digits=0),
        _median(runs, lambda r: r.edges, digits=0),
        f"{max(steps):.3f}" if steps else "",
        _median(runs, lambda r: 1e3 * r.setup_seconds, digits=1),
    )


def _times(seconds: Sequence[float]) -> str:
    """Median and 95th percentile in ms."""
    if not seconds:
        return ""
    half, most = 1e3 * np.percentile(seconds, [50.0, 95.0])
    return f"{half:.1f} / {most:.1f}"


def _median(
    runs: Sequence[PathRecord],
    of: Callable[[PathRecord], float | None],
    digits: int = 2,
) -> str:
    values = [value for r in runs if (value := of(r)) is not None]
    return f"{np.median(values):.{digits}f}" if values else ""
