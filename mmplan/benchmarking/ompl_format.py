"""Benchmark logs in OMPL's plain-text format.

`ompl_benchmark_statistics` turns them into the database that Planner Arena shows. OMPL
itself writes such logs only of queries that it was given and only with its own
columns, and a Python callback cannot add to them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any, Generic, TypeVar

# OMPL's own numbers for how a planner ended.
STATUS = (
    "status|Unknown status|Invalid start|Invalid goal|Unrecognized goal type|Timeout|"
    "Approximate solution|Exact solution|Crash"
)
TIMEOUT, EXACT = 4, 6

R = TypeVar("R")


@dataclass(frozen=True)
class Column(Generic[R]):
    """A property of each run."""

    name: str
    type: str  # BOOLEAN, ENUM, INTEGER or REAL
    of: Callable[[R], Any]


@dataclass(frozen=True)
class Planner(Generic[R]):
    """A planner of an experiment and its runs; `progress` are lines, one a run."""

    label: str
    common: Mapping[str, str]
    columns: Sequence[Column[R]]
    runs: Sequence[R]
    progress_columns: Sequence[str] = ()
    progress: Sequence[str] = ()

    def lines(self) -> list[str]:
        """Its part of the log."""
        lines = [
            self.label,
            f"{len(self.common)} common properties",
            *(f"{name} = {value}" for name, value in self.common.items()),
            f"{len(self.columns)} properties for each run",
            *(f"{column.name} {column.type}" for column in self.columns),
            f"{len(self.runs)} runs",
            *("".join(f"{_text(c.of(r))}; " for c in self.columns) for r in self.runs),
        ]
        if self.progress_columns:
            lines += [
                f"{len(self.progress_columns)} progress properties for each run",
                *self.progress_columns,
                f"{len(self.progress)} runs",
                *self.progress,
            ]
        return [*lines, "."]


@dataclass(frozen=True)
class Experiment(Generic[R]):
    """Planners on one question, and what is to be said of them all."""

    name: str
    properties: Sequence[str]  # `name TYPE = value`
    hosts: Sequence[str]
    finished: str  # ISO 8601, of the first run
    setup: Sequence[str]
    seed: int
    time_limit: float  # s
    seconds: float  # s, of all runs
    planners: Sequence[Planner[R]]

    def log(self) -> str:
        """The log."""
        count = len(self.properties)
        lines = [
            f"mmplan version {version('mmplan')}",
            f"Experiment {_word(self.name)}",
            *([f"{count} experiment properties", *self.properties] if count else []),
            f"Running on {_word(', '.join(sorted(set(self.hosts))))}",
            f"Starting at {_date(self.finished)}",
            "<<<|",
            *self.setup,
            "|>>>",
            f"{self.seed} is the random seed",
            f"{self.time_limit!r} seconds per run",
            "0 MB per run",
            f"{max(len(p.runs) for p in self.planners)} runs per planner",
            f"{self.seconds!r} seconds spent to collect the data",
            "1 enum type",
            STATUS,
            f"{len(self.planners)} planners",
        ]
        for planner in self.planners:
            lines += planner.lines()
        return "\n".join(lines) + "\n"


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
