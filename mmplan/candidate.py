"""A joint candidate, worked out: how the robot stands and holds the object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.optimizers import Triple
from mmplan.scoring import End, ScoreFunction
from mmplan.shapes import Array, read_only


@dataclass(frozen=True, eq=False)
class Candidate:
    """Start base, goal base and grasp with the configurations that belong to them."""

    triple: Triple
    q: tuple[Array, Array]  # (nq,) at start and goal, hand closed on the object
    T_object_tool: Array  # (4, 4)
    opened: Array  # (hand joints,) before grasping and after releasing
    closed: Array  # (hand joints,) on the object
    scores: tuple[dict[str, float], dict[str, float]]  # by term, at start and goal

    @classmethod
    def of_triple(cls, triple: Triple, score: ScoreFunction) -> Candidate:
        """Work out a triple that scores at both ends."""
        grasp = triple.grasp[None]
        ends = [score(end, triple.q_base[end][None], grasp) for end in End]
        hold = score.holds(grasp)
        terms = [dict(zip(score.terms, e.terms[0].tolist(), strict=True)) for e in ends]
        return cls(
            triple=triple,
            q=(read_only(ends[0].q[0]), read_only(ends[1].q[0])),
            T_object_tool=read_only(hold.T_object_tool[0]),
            opened=read_only(hold.opened[0]),
            closed=read_only(hold.closed[0]),
            scores=(terms[0], terms[1]),
        )

    @property
    def T_tool_object(self) -> Array:
        """The pose (4, 4) of the object in the hand."""
        inverse: Array = np.linalg.inv(self.T_object_tool).astype(np.float64)
        return inverse
