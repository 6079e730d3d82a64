"""The difficulty dial."""

from __future__ import annotations

import math
from dataclasses import dataclass

from mmplan.exceptions import InputError


@dataclass(frozen=True)
class Difficulty:
    """How hard a problem is to be made: 0 easy, 1 hard."""

    value: float = 0.5

    def __post_init__(self) -> None:
        """Refuse what is not on the dial."""
        if not (math.isfinite(self.value) and 0.0 <= self.value <= 1.0):
            raise InputError(f"difficulty: expected 0 to 1, got {self.value:g}")

    def between(self, easy: float, hard: float) -> float:
        """The length at this difficulty, to the millimetre."""
        return round(easy + self.value * (hard - easy), 3)

    def count(self, easy: int, hard: int) -> int:
        """The number of things at this difficulty."""
        return round(easy + self.value * (hard - easy))
