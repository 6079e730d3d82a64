"""Inverse kinematics of arms: one solver a file, all solutions, in batches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Solutions:
    """All inverse-kinematics solutions of n poses, b branches each.

    `q` is (n, b, k), each joint at that of its windings that lies within the limits
    and nearest to their middle (nearest to them where none does). `exists` (n, b) says
    which branches are solutions at all, `within` (n, b) which are also within the
    joint limits. Rows of `q` that do not exist are NaN. At a singularity a branch that
    repeats an earlier one does not exist. A joint without limits is at its winding
    nearest 0.
    """

    q: Array
    exists: npt.NDArray[np.bool_]
    within: npt.NDArray[np.bool_]


class InverseKinematics(Protocol):
    """A solver for one arm.

    It is `complete` if it finds all solutions there are, so that a pose without one is
    proven out of reach. `explanation` says in one line how it solves this arm, and why.
    """

    @property
    def complete(self) -> bool: ...  # noqa: D102

    @property
    def explanation(self) -> str: ...  # noqa: D102

    def solve(self, T_base_tool: Array) -> Solutions:
        """All solutions for tool poses (n, 4, 4) in the frame of the mobile base."""
        ...
