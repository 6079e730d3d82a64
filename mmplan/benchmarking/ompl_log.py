"""Benchmark logs of optimizers in OMPL's format, with columns of our own.

Every run's query is what its optimizer has found.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from mmplan.benchmarking.contests import Contest
from mmplan.benchmarking.ompl_format import EXACT, TIMEOUT, Column, Experiment, Planner
from mmplan.benchmarking.records import Record

_Column: TypeAlias = Column[Record]


def ompl_log(contest: Contest, software: str) -> str:
    """The log of a contest: its contenders are the planners of one experiment."""
    records = [r for runs in contest.contenders.values() for r in runs]
    return Experiment(
        name=f"{contest.problem.name}_{contest.evaluations}",
        properties=(
            f"evaluations INTEGER = {contest.evaluations}",
            f"best_score REAL = {contest.best!r}",
        ),
        hosts=[r.host for r in records],
        finished=min(r.finished for r in records),
        setup=(
            f"scene {contest.problem.scene}",
            f"fingerprint {contest.problem.fingerprint}",
            software,
        ),
        seed=min(r.seed for r in records),
        time_limit=max(_wall(r) for r in records),
        seconds=sum(_wall(r) for r in records),
        planners=[
            _planner(label, runs, contest) for label, runs in contest.contenders.items()
        ],
    ).log()


def _planner(label: str, runs: Sequence[Record], contest: Contest) -> Planner[Record]:
    return Planner(
        label=label,
        common={
            "optimizer": runs[0].optimizer,
            "planner": runs[0].planner or "none",
            "settings": runs[0].settings,
        },
        columns=_columns(runs, contest),
        runs=runs,
        progress_columns=("time REAL", "evaluations INTEGER", "best score REAL"),
        progress=[_progress(r) for r in runs],
    )


def _columns(runs: Sequence[Record], contest: Contest) -> list[_Column]:
    share = 100.0 / contest.best if contest.best > 0.0 else 0.0
    columns = [
        _Column("solved", "BOOLEAN", lambda r: r.solved),
        _Column("status", "ENUM", lambda r: EXACT if r.solved else TIMEOUT),
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
