"""What a curve is that a robot can be timed along."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array


class Curve(Protocol):
    """A curve q(s), s in [0, length], with continuous q'(s)."""

    @property
    def length(self) -> float:
        """Where it ends."""
        ...

    @property
    def starts(self) -> Array:
        """Where its pieces begin, (k,)."""
        ...

    @property
    def moving(self) -> npt.NDArray[np.int64]:
        """The joints that move along it, by their places in q."""
        ...

    def __call__(self, s: Array, order: int = 0) -> Array:
        """Its derivative of that order (0, 1 or 2) at s (n,), (n, nq)."""
        ...

    def corners(self, turn: float) -> Array:
        """Places (n,) at which its curvature jumps about turns above `turn` (rad)."""
        ...
