"""What the verification of a plan found, as plain values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Fault:
    """One thing that a plan promises and does not hold.

    `kind` is one word for programs (docs/plan_format.md lists them), `message` is
    for people.
    """

    kind: str
    message: str

    def __str__(self) -> str:
        """The message."""
        return self.message


@dataclass(frozen=True)
class Clearance:
    """The smallest distance found between two things that must stay apart."""

    distance: float  # m, negative where they overlap
    task: int  # place of the task in the plan, from 0
    segment: str
    time: float  # s from the segment's start
    first: str  # names of links, obstacles or objects
    second: str


@dataclass(frozen=True)
class Peak:
    """The largest value of something that a rule limits.

    `largest` was measured at the time that it tells; `proven` is what it never exceeds,
    None where the limit is not kept, and of torques, which are looked at in places.
    """

    rule: str  # "tilt" (rad, where it counts), "tool_speed" (m/s), "torque" (share)
    limit: float
    largest: float
    proven: float | None
    task: int  # place of the task in the plan, from 0
    segment: str
    time: float  # s from the segment's start


@dataclass(frozen=True)
class VerificationReport:
    """The outcome of a verification; the same for the same plan and problem.

    `clearance` was measured at the time that it tells; nothing that must stay apart
    ever comes nearer than `proven` (m), which is 0 where there are faults. `queries`
    counts exact distance computations and `intervals` the stretches of time that
    the proof looked at. `peaks` has one for each rule beside collisions of each task.
    """

    faults: tuple[Fault, ...]
    clearance: Clearance | None
    proven: float
    queries: int
    intervals: int
    peaks: tuple[Peak, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the plan holds all that it promises."""
        return not self.faults

    def to_json(self) -> dict[str, Any]:
        """The report as the plan file has it."""
        clearance = self.clearance
        return {
            "ok": self.ok,
            "faults": [vars(fault) for fault in self.faults],
            "clearance": None if clearance is None else dict(vars(clearance)),
            "proven": self.proven,
            "queries": self.queries,
            "intervals": self.intervals,
            "peaks": [vars(peak) for peak in self.peaks],
        }
