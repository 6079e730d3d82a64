"""What a hand's size allows."""

from __future__ import annotations

from typing import NamedTuple

# What is left free between an object and the open fingers, m, both sides together.
PLAY = 0.002


class HandSize(NamedTuple):
    """The measures of a hand that decide what it can grasp, m.

    `opening` is the distance between the opened fingers at the tool frame, `reach`
    how far the tool frame lies before the palm, and `width` the fingers' extent
    across closing and approach.
    """

    opening: float
    reach: float
    width: float

    @property
    def widest(self) -> float:
        """The widest thing that the hand goes around."""
        return self.opening - PLAY

    @property
    def depth(self) -> tuple[float, float]:
        """How deep a target point may lie inside a surface that the hand comes to."""
        low = min(0.01, self.reach / 3)
        return (low, max(low, self.reach - 0.01))
