"""Benchmark logs in OMPL's plain-text format, with columns of our own.

`ompl_benchmark_statistics` turns them into the database that Planner Arena shows. OMPL
itself writes such logs only of queries that it was given and only with its own
columns, and a Python callback cannot add to them; here every run's query is what its
optimizer has found.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import Any, NamedTuple

from mmplan.benchmarking.contests import Contest
from mmplan.benchmarking.records import Record

# OMPL's own numbers for how a planner ended.
_STATUS = (
    "status|Unknown status|Invalid start|Invalid goal|Unrecognized goal type|Timeout|"
    "Approximate solution|Exact solution|Crash"
)
_TIMEOUT, _EXACT = 4, 6


class _Column(NamedTuple):
    name: str
    type: str
    of: Callable[[Record], Any]


def ompl_log(contest: Contest, software: str) -> str:
    """The log of a contest: its contenders are the planners of one experiment."""
    records = [r for runs in contest.contenders.values() for r in runs]
    lines = [
        f"mmplan version {version('mmplan')}",
        f"Experiment {_word(contest.problem.name)}_{contest.evaluations}",
        "2 experiment properties",
        f"evaluations INTEGER = {contest.evaluations}",
        f"best_score REAL = {contest.best!r}",
        f"Running on {_word(', '.join(sorted({r.host for r in records})))}",
        f"Starting at {_date(min(r.finished for r in records))}",
        "<<<|",
        f"scene {contest.problem.scene}",
        f"fingerprint {contest.problem.fingerprint}",
        software,
        "|>>>",
        f"{min(r.seed for r in records)} is the random seed",
        f"{max(_wall(r) for r in records)!r} seconds per run",
        "0 MB per run",
        f"{max(len(runs) for runs in contest.contenders.values())} runs per planner",
        f"{sum(_wall(r) for r in records)!r} seconds spent to collect the data",
        "1 enum type",
        _STATUS,
        f"{len(contest.contenders)} planners",
    ]
    for label, runs in contest.contenders.items():
        lines += _planner(label, runs, contest)
    return "\n".join(lines) + "\n"


def _planner(label: str, runs: Sequence[Record], contest: Contest) -> list[str]:
    columns = _columns(runs, contest)
    return [
        label,
        "3 common properties",
        f"optimizer = {runs[0].optimizer}",
        f"planner = {runs[0].planner or 'none'}",
        f"settings = {runs[0].settings}",
        f"{len(columns)} properties for each run",
        *(f"{column.name} {column.type}" for column in columns),
        f"{len(runs)} runs",
        *("".join(f"{_text(c.of(r))}; " for c in columns) for r in runs),
        "3 progress properties for each run",
        "time REAL",
        "evaluations INTEGER",
        "best score REAL",
        f"{len(runs)} runs",
        *(_progress(r) for r in runs),
        ".",
    ]


def _columns(runs: Sequence[Record], contest: Contest) -> list[_Column]:
    share = 100.0 / contest.best if contest.best > 0.0 else 0.0
    columns = [
        _Column("solved", "BOOLEAN", lambda r: r.solved),
        _Column("status", "ENUM", lambda r: _EXACT if r.solved else _TIMEOUT),
        _Column("time", "REAL", _wall),
        _Column("score", "REAL", lambda r: r.score),
        _Column("normalized score", "REAL", lambda r: share * r.score),
        _Column("feasible", "BOOLEAN", lambda r: r.success),
        _Column("evaluations", "INTEGER", lambda r: r.used),
        _Column("cycles", "REAL", lambda r: r.cycles),
        _Column("seed", "INTEGER", lambda r: r.seed),
    ]
    columns += [_end(end) for end in ("start", "goal")]
    columns += [_base(end, axis) for end in ("start", "goal") for axis in (0, 1)]
    columns += [_cpu(stage) for stage in sorted({s for r in runs for s in r.times})]
    if any(r.plan is not None for r in runs):
        columns += [
            _Column("motion time", "REAL", lambda r: (r.plan or {}).get("duration")),
            _Column("candidates tried", "INTEGER", lambda r: (r.plan or {})["tried"]),
            _Column("clearance", "REAL", _clearance),
        ]
    return columns


def _end(end: str) -> _Column:
    def score(r: Record) -> float:
        return float(sum(r.ends[end]["score"].values())) if r.ends else 0.0

    return _Column(f"score {end}", "REAL", score)


def _base(end: str, axis: int) -> _Column:
    def place(r: Record) -> float | None:
        return float(r.ends[end]["base"][axis]) if r.ends else None

    return _Column(f"base {end} {'xy'[axis]}", "REAL", place)


def _cpu(stage: str) -> _Column:
    def seconds(r: Record) -> float:
        return r.times.get(stage, {}).get("cpu", 0.0)

    return _Column(f"cpu {stage}", "REAL", seconds)


def _clearance(r: Record) -> float | None:
    verification = (r.plan or {}).get("verification") or {}
    clearance = verification.get("clearance")
    return None if clearance is None else float(clearance["distance"])


def _progress(r: Record) -> str:
    """What was known at each time; the format wants every time once."""
    known = dict(zip(r.seconds, r.history, strict=True))
    return "".join(f"{t!r},{int(n)},{best!r},;" for t, (n, best) in known.items())


def _wall(r: Record) -> float:
    return sum(stage["wall"] for stage in r.times.values())


def _text(value: Any) -> str:
    if value is None:
        return ""
    return str(int(value)) if isinstance(value, bool) else repr(value)


def _word(text: str) -> str:
    """The text as one word, as the format wants it."""
    return "_".join(text.replace(",", " ").split()) or "unknown"


def _date(text: str) -> str:
    """An ISO date as OMPL writes it."""
    return text[:19].replace("T", " ")
