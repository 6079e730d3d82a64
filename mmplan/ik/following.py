"""One motion of an arm along given tool poses, for arms with many or unknown branches.

Where a solver lists all of the few solutions there are, the nearest one to the last is
the next. Where it lists some out of a continuum, the next may not be among them, and
is found from the last by iteration.
"""

from __future__ import annotations

import numpy as np

from mmplan.ik.branches import Candidates
from mmplan.ik.chain import Chain
from mmplan.ik.numeric import descend
from mmplan.ik.poses import components
from mmplan.shapes import Array

# So many poses in a row are found from the last one before them, all at once.
_BLOCK = 8
# Steps to a pose, and how many that gain little are put up with.
_STEPS = 15
_PATIENCE = 5
# A joint nearer to its limit (rad or m) has come up against it.
_AT_LIMIT = 0.01


def follow(chain: Chain, q_start: Array, T_base_tool: Array) -> tuple[Array, str]:
    """Configurations (m', k) for the first m' of tool poses (m, 4, 4), within limits.

    The first pose is that of `q_start` (k,), and the others lie close to each other.
    The second value says why there are less than m configurations; it is empty where
    there are not.
    """
    wanted = components(T_base_tool)
    path = q_start[None]
    while len(path) < len(T_base_tool):
        rows = np.arange(len(path), min(len(path) + _BLOCK, len(T_base_tool)))
        start = Candidates(rows, np.repeat(path[-1][:, None], len(rows), axis=1))
        found = descend(chain, start, wanted, _STEPS, _PATIENCE)
        unbroken = found.pose == rows[: len(found.pose)]
        path = np.concatenate([path, found.q.T[np.logical_and.accumulate(unbroken)]])
        if len(path) <= rows[-1]:
            return path, _reason(chain, path[-1])
    return path, ""


def _reason(chain: Chain, q: Array) -> str:
    margin = np.minimum(q - chain.lower, chain.upper - q)
    if margin.min() > _AT_LIMIT:
        return "out of reach"
    return f"{chain.names[int(margin.argmin())]} is at its limit"
