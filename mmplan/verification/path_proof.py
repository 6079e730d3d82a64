"""The proof that nothing touches along a path of straight lines in joint space."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from mmplan.collision import CollisionWorld
from mmplan.hermite import HermiteCurve
from mmplan.shapes import Array
from mmplan.verification.bodies import Bodies
from mmplan.verification.ledger import Ledger
from mmplan.verification.proof import SegmentProof
from mmplan.verification.touching import TouchRule


def prove_path(world: CollisionWorld, path: Array) -> Ledger:
    """What can be proven of a path (n, nq), which must not touch anything.

    A stage of the ledger is an edge of the path, and its times run from 0 to 1. The
    path is free if there are neither overlaps nor anything undecided.
    """
    bodies = Bodies(world, np.abs(path).max(axis=0))
    rule = TouchRule(np.zeros(len(world.pairs)), ())
    ledger = Ledger()
    for edge, (q_from, q_to) in enumerate(pairwise(path)):
        velocity = q_to - q_from
        line = HermiteCurve(
            np.array([0.0, 1.0]), np.stack([q_from, q_to]), np.stack([velocity] * 2)
        )
        SegmentProof(edge, line, bodies, rule, ledger).run()
    return ledger
