"""Table I of Berenson, Kuffner and Choset, ICRA 2008: 200 runs of two problems."""

from __future__ import annotations

from typing import NamedTuple

EVALUATIONS = 6940
CAVEAT = (
    "The paper's scenes and models are not published; ours are rebuilt from its "
    "figures, and its score leaves scales and weights open. So the numbers are not "
    "comparable, only which optimizer is ahead and, roughly, by how much. Both columns "
    "are normalized to 100 by the best score ever found for the problem, in the paper "
    "over its runs and here over all runs in these results. Mean and standard "
    "deviation are over the successful runs: with the two failures of the wineglass "
    "problem counted as 0, the paper's deviations could not be that small."
)


class Row(NamedTuple):
    """One row of the table."""

    success: float  # percent
    mean: float  # 100 the best
    deviation: float


# By the names of mmplan's scenes and optimizers.
TABLE_I = {
    ("wineglass", "coevolution"): Row(99.0, 91.74, 3.77),
    ("wineglass", "random"): Row(99.0, 72.57, 6.13),
    ("plate", "coevolution"): Row(100.0, 90.18, 3.94),
    ("plate", "random"): Row(100.0, 78.06, 4.52),
}
