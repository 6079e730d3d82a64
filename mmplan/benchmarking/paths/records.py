"""One run of a path planner: what is to be done, and what came of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeAlias

from mmplan.benchmarking.paths.arena import Arena
from mmplan.benchmarking.paths.problems import PathProblem
from mmplan.benchmarking.records import digest
from mmplan.benchmarking.run_store import Layout, RunStore
from mmplan.shapes import Array

STORE_FILE = "paths.sqlite"
FORMAT = 1


class PathKey(NamedTuple):
    """What tells one run from every other in the same store."""

    problems: str  # name of the file
    family: str
    number: int  # of the problem in its family
    planner: str
    settings: str  # JSON
    seed: int

    @property
    def digest(self) -> str:
        """The key as a number in hexadecimal digits."""
        return digest(self)


@dataclass(frozen=True, eq=False)
class Answer:
    """What a planner says: paths, and the CPU seconds until it had them.

    A planner that does not shorten paths has no `path` beside the first. Counts are
    None where a planner does not tell them.
    """

    first: Array | None = None  # (n, nq)
    first_seconds: float = 0.0  # all that were spent where there is no path
    path: Array | None = None
    seconds: float | None = None
    states: int | None = None  # checked
    edges: int | None = None
    step: float | None = None  # rad, the longest between two checks
    message: str = ""


class PathPlanner(Protocol):
    """Plans in one arena."""

    def __call__(self, seed: int) -> Answer:
        """A path from the arena's start to its goal."""


class Prepared(NamedTuple):
    """A planner that knows its arena, and the CPU time (s) that it took to tell it."""

    plan: PathPlanner
    seconds: float


# Prepares a planner for an arena of its own.
PlannerFactory: TypeAlias = Callable[[Arena], Prepared]


@dataclass(frozen=True, eq=False)
class PathJob:
    """A run that is to be done."""

    problems: str
    problem: PathProblem
    planner: str
    settings: str
    seed: int

    @property
    def key(self) -> PathKey:
        """What tells this run from every other."""
        where = self.problem.family, self.problem.number
        return PathKey(self.problems, *where, self.planner, self.settings, self.seed)


@dataclass(frozen=True)
class PathRecord:
    """What came of a run.

    Lengths are joint-space Euclidean (rad, m for prismatic joints) or weighted by the
    joints' lever arms (m). A planner that does not shorten has no numbers for that.
    """

    problems: str
    family: str
    number: int
    planner: str
    settings: str
    seed: int
    solved: bool
    valid_first: bool  # proven free of collision at all times
    valid: bool  # the shortened path too, where there is one
    collides: bool  # the first path, when checked again at steps of 1/64 rad
    fault: str  # why it is not solved or not valid
    setup_seconds: float  # CPU
    first_seconds: float  # CPU
    seconds: float | None  # CPU, until the path was short
    first_length: float | None  # rad
    first_way: float | None  # m
    length: float | None
    way: float | None
    clearance: float | None  # m, the smallest along the last path
    states: int | None
    edges: int | None
    step: float | None  # rad
    first: list[list[float]] | None
    path: list[list[float]] | None
    host: str
    finished: str

    @property
    def key(self) -> PathKey:
        """What tells this run from every other."""
        return PathKey(*(getattr(self, name) for name in PathKey._fields))


_REALS = (
    "setup_seconds",
    "first_seconds",
    "seconds",
    "first_length",
    "first_way",
    "length",
    "way",
    "clearance",
    "step",
)
_TRUTHS = ("solved", "valid_first", "valid", "collides")


class PathStore(RunStore[PathJob, PathRecord]):
    """The results in one folder. A process opens a folder once at a time."""

    layout = Layout(
        file=STORE_FILE,
        format=FORMAT,
        record=PathRecord,
        key=PathKey,
        json=frozenset({"first", "path"}),
        numbers={
            **dict.fromkeys(_REALS, "REAL"),
            **dict.fromkeys((*_TRUTHS, "number", "seed", "states", "edges"), "INTEGER"),
        },
        truths=frozenset(_TRUTHS),
    )
