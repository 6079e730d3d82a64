"""The nearest miss: what is missing in the pair of base and grasp that nearly works."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from mmplan.scoring import End
from mmplan.shapes import Array

_CENTIMETRES, _MILLIMETRES = 100.0, 1000.0

Point = tuple[float, float, float]


@dataclass(frozen=True)
class NearMiss:
    """What is missing in the best pair of base and grasp that fails at one end.

    Of a miss by

    - `overlap`, the link `first` overlaps `second` by `amount`, m;
    - `turn` or `slide`, the joint `first` is beyond its limit by `amount`, rad or m;
    - `reach`, the tool ends `amount` (m) short of the grasp, turned as that wants it.

    `q` is the configuration, in which `line` joins the two points (m, in the world)
    that should coincide or stay apart. If the grasp was chosen because it works at the
    other end, that is `works_at`.
    """

    end: End
    kind: Literal["overlap", "turn", "slide", "reach"]
    first: str
    second: str | None
    amount: float
    base: tuple[float, ...]
    grasp: tuple[float, ...]
    q: tuple[float, ...]
    line: tuple[Point, Point] | None = None
    works_at: End | None = None

    def __str__(self) -> str:
        """The miss in words."""
        at = f"at the {self.end.name.lower()}"
        if self.works_at is not None:
            other = self.works_at.name.lower()
            at = f"the grasp that gets furthest works at the {other}; {at}"
        place = f"({', '.join(f'{x:.3f}' for x in self.base)})"
        stands = f" with the base at {place}" if self.base else ""
        if self.kind == "overlap":
            depth = f"-{self.amount * _MILLIMETRES:.1f} mm"
            return f"{at} {self.first} misses {self.second} by {depth}{stands}"
        length = f"{self.amount * _CENTIMETRES:.1f} cm"
        if self.kind != "reach":
            turn = f"{np.degrees(self.amount):.1f} degrees"
            beyond = turn if self.kind == "turn" else length
            return f"{at} {self.first} is {beyond} beyond its limit{stands}"
        short = f"{length} short of the grasp"
        if not self.base:
            return f"{at} the arm leaves the tool {short}"
        return f"{at} the best base that is free, {place}, leaves the tool {short}"


def line_between(start: Array, end: Array) -> tuple[Point, Point]:
    """Two points (3,) as plain numbers."""
    (a, b, c), (d, e, f) = start.tolist(), end.tolist()
    return (a, b, c), (d, e, f)
