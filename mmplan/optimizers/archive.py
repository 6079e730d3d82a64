"""All scores above 0 that a search came by, and the joint candidates among them."""

from __future__ import annotations

from collections.abc import Container, Iterable
from dataclasses import dataclass

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.optimizers.bases import BASE_SCALES, base_ways
from mmplan.scoring import End
from mmplan.shapes import Array

# Candidates are distinct if a base is this far off (m, turns counted as by
# `BASE_SCALES`) or a grasp gene by this share of its range.
_BASE_APART = 0.05
_GRASP_APART = 0.05


@dataclass(frozen=True, eq=False)
class Triple:
    """A joint candidate: start base, goal base and one grasp that serves both."""

    q_base: tuple[Array, Array]  # at start and goal, (base joints,) each
    grasp: Array  # (genes,)
    scores: tuple[float, float]  # at start and goal

    @property
    def total(self) -> float:
        """The sum of both scores."""
        return sum(self.scores)


class Archive:
    """Scores by grasp, end and base; bases and grasps are known by their bytes."""

    def __init__(self) -> None:
        """Start empty."""
        self._scores: dict[bytes, tuple[dict[bytes, float], dict[bytes, float]]] = {}
        self.best = 0.0

    def add(self, end: End, q_base: Array, grasp: Array, total: float) -> None:
        """Keep one score above 0."""
        ends = self._scores.setdefault(grasp.tobytes(), ({}, {}))
        ends[end][q_base.tobytes()] = total
        if ends[1 - end] and total >= max(ends[end].values()):
            self.best = max(self.best, total + max(ends[1 - end].values()))

    def grasps_by_end(self) -> tuple[int, int, int]:
        """How many grasps work at the start only, at the goal only, and at both."""
        ends = [(bool(start), bool(goal)) for start, goal in self._scores.values()]
        kinds = ((True, False), (False, True), (True, True))
        start_only, goal_only, both = (ends.count(kind) for kind in kinds)
        return start_only, goal_only, both

    def triples(
        self,
        grasps: Container[bytes] | None = None,
        bases: Container[bytes] | None = None,
    ) -> list[Triple]:
        """For each grasp its best base at either end, best triple first.

        `grasps` and `bases` restrict what counts to those members, by their bytes.
        """
        triples = []
        for key, ends in self._scores.items():
            if grasps is not None and key not in grasps:
                continue
            found = [_best(scores, bases) for scores in ends]
            if found[0] is not None and found[1] is not None:
                (start, s), (goal, g) = found[0], found[1]
                triples.append(Triple((start, goal), np.frombuffer(key), (s, g)))
        return sorted(triples, key=lambda t: -t.total)


def distinct(triples: Iterable[Triple], grasps: GeneSpace, most: int) -> list[Triple]:
    """The first `most` triples that differ enough from all those before them."""
    kept: list[Triple] = []
    for triple in triples:
        if len(kept) == most:
            break
        if all(_apart(triple, other, grasps) for other in kept):
            kept.append(triple)
    return kept


def _best(
    scores: dict[bytes, float], bases: Container[bytes] | None
) -> tuple[Array, float] | None:
    known = {k: s for k, s in scores.items() if bases is None or k in bases}
    if not known:
        return None
    key = max(known, key=known.__getitem__)
    return np.frombuffer(key), known[key]


def _apart(a: Triple, b: Triple, grasps: GeneSpace) -> bool:
    ways = [base_ways(p, q) for p, q in zip(a.q_base, b.q_base, strict=True)]
    moved = max(float(np.linalg.norm(w / BASE_SCALES[: len(w)])) for w in ways)
    turned = np.max(grasps.apart(a.grasp, b.grasp))
    return moved > _BASE_APART or bool(turned > _GRASP_APART)
