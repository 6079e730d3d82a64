"""What the proof of a plan has come to so far."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

# How much of the smallest distance found is proven to be kept everywhere.
SHARPNESS = 0.8


@dataclass(frozen=True)
class Finding:
    """Two things at a moment: how far apart, and how deep they might overlap."""

    stage: int  # place of the segment in the whole plan
    first: str
    second: str
    time: float  # s, within the segment
    distance: float  # m, negative where they overlap
    allowed: float  # m
    region: bool = False  # whether one is a region that is forbidden, and no thing


@dataclass
class Ledger:
    """Counts, the smallest clearance, and what could not be proven.

    Of all findings about the same two things in the same segment one is kept, with
    the earliest time and the smallest distance.
    """

    nearest: Finding | None = None  # the smallest distance of what must stay apart
    proven: float = np.inf  # m, the lowest lower bound of what was proven apart
    queries: int = 0
    intervals: int = 0
    overlaps: dict[tuple[int, str, str], Finding] = field(default_factory=dict)
    undecided: dict[tuple[int, str, str], Finding] = field(default_factory=dict)

    @property
    def floor(self) -> float:
        """The separation (m) that has to be shown of what must stay apart."""
        if self.nearest is None:
            return np.inf
        return max(0.0, SHARPNESS * self.nearest.distance)

    def is_nearer(self, distance: float) -> bool:
        """Whether a distance (m) is smaller than all before it."""
        return self.nearest is None or distance < self.nearest.distance

    def note_overlap(self, finding: Finding) -> None:
        """Remember an overlap that is deeper than allowed."""
        _merge(self.overlaps, finding)

    def note_undecided(self, finding: Finding) -> None:
        """Remember two things too near each other to be proven apart."""
        _merge(self.undecided, finding)


def _merge(findings: dict[tuple[int, str, str], Finding], new: Finding) -> None:
    key = (new.stage, new.first, new.second)
    old = findings.get(key, new)
    findings[key] = replace(
        new,
        time=min(old.time, new.time),
        distance=min(old.distance, new.distance),
    )
