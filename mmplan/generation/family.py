"""What a family of problems is."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from mmplan.generation.difficulty import Difficulty
from mmplan.generation.draft import Draft


class Family(Protocol):
    """Draws scenes of one kind."""

    def __call__(
        self, rng: np.random.Generator, difficulty: Difficulty
    ) -> Draft | None:
        """A scene in which everything stands; None where there was no room for it."""
        ...
