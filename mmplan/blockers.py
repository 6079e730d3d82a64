"""What stands in the way where evaluations end in collision, by name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.collision import Contact
from mmplan.optimizers import Queries
from mmplan.scoring import End, Outcome, ScoreFunction

IN_COLLISION = (
    Outcome.BASE_COLLISION,
    Outcome.COLLISION,
    Outcome.HAND_OPEN_COLLISION,
)
_NAMED = 5


@dataclass(frozen=True, eq=False)
class Collisions:
    """Colliding evaluations that were looked at again, and what overlaps in each.

    `contacts` are those of the best configuration of each row of `queries`, see
    `ScoreFunction.contacts`.
    """

    queries: Queries
    contacts: tuple[tuple[Contact, ...], ...]

    def pairs(self) -> tuple[tuple[str, str, float], ...]:
        """The pairs that overlap most often: first, second, share of the rows."""
        counts: Counter[tuple[str, str]] = Counter()
        for found in self.contacts:
            counts.update({(c.first, c.second) for c in found})
        most = counts.most_common(_NAMED)
        return tuple((a, b, n / len(self.contacts)) for (a, b), n in most)

    def culprits(self) -> tuple[tuple[str, float], ...]:
        """What is hit, and its share of the blame, greatest first; shares add up to 1.

        The blame for each row is shared evenly by all that is hit in it.
        """
        blame: dict[str, float] = {}
        for found in self.contacts:
            hit = {c.second for c in found}
            for owner in hit:
                part = 1.0 / len(hit) / len(self.contacts)
                blame[owner] = blame.get(owner, 0.0) + part
        return tuple(sorted(blame.items(), key=lambda item: (-item[1], item[0])))


def collisions(
    score: ScoreFunction,
    end: End,
    queries: Queries,
    most: int,
    outcomes: Sequence[Outcome] = IN_COLLISION,
) -> Collisions:
    """Look again at no more than `most` queries of one end with such an outcome.

    They are spread evenly over all of them.
    """
    at_end = np.flatnonzero(queries.end == end)
    outcome = score(end, queries.q_base[at_end], queries.grasps[at_end]).outcome
    chosen = queries.take(spread(at_end[np.isin(outcome, outcomes)], most))
    contacts = [
        score.contacts(end, q_base, grasp)
        for q_base, grasp in zip(chosen.q_base, chosen.grasps, strict=True)
    ]
    return Collisions(chosen, tuple(contacts))


def spread(rows: npt.NDArray[np.int64], most: int) -> npt.NDArray[np.int64]:
    """At most `most` of the rows, at even distances."""
    return rows[:: max(1, len(rows) // most)][:most]
