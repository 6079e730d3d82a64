"""All that was looked at to explain a task: random pairs, a search, its candidates."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mmplan.blockers import IN_COLLISION, Collisions, collisions
from mmplan.candidate import Candidate
from mmplan.exceptions import NoPlanError
from mmplan.explanation.search import blocked_line, search
from mmplan.explanation.survey import Survey, is_reached, survey
from mmplan.motion import Blocked
from mmplan.optimizers import (
    Optimization,
    Queries,
    SearchSpace,
    Triple,
    search_space,
)
from mmplan.scoring import End, Outcome, ScoreFunction

_PAIRS = 1000  # of base and grasp, drawn at each end
_EVALUATIONS = 500  # of the search for candidates
_CANDIDATES = 5
_WAYPOINTS = 15  # at which a straight way is looked at
_COLLISIONS = 40  # that are looked at again, at each end


@dataclass(frozen=True, eq=False)
class Evidence:
    """What was seen of one task.

    `found` is None where there was nothing to search for, as from nowhere that the base
    may stand the arm reaches a grasp.
    """

    score: ScoreFunction
    space: SearchSpace
    surveys: dict[End, Survey]
    found: Optimization | None

    @classmethod
    def gather(cls, score: ScoreFunction, rng: np.random.Generator) -> Evidence:
        """Draw pairs at both ends, then search."""
        space = search_space(score)
        surveys = {end: survey(score, end, space, _PAIRS, rng) for end in End}
        found = None
        if all(is_reached(score, end, space, _PAIRS, rng) for end in End):
            with suppress(NoPlanError):
                found = search(score, _EVALUATIONS, rng, _CANDIDATES)
        return cls(score, space, surveys, found)

    @property
    def evaluations(self) -> int:
        """Of the search."""
        return 0 if self.found is None else self.found.evaluations

    @property
    def grasps_by_end(self) -> tuple[int, int, int]:
        """How many grasps the search found to work at the start, the goal, at both."""
        return (0, 0, 0) if self.found is None else self.found.grasps_by_end

    def outcomes(self, end: End) -> frozenset[Outcome]:
        """All outcomes that were seen at an end."""
        outcomes = np.unique(self.surveys[end].outcome).tolist()
        if self.found is not None:
            outcomes += np.flatnonzero(self.found.outcomes[end]).tolist()
        return frozenset(Outcome(o) for o in outcomes)

    def feasible(self, end: End) -> int:
        """How many pairs of the search are feasible at an end."""
        return 0 if self.found is None else int(self.found.outcomes[end, -1])

    def collisions(
        self, end: End, outcomes: Sequence[Outcome] = IN_COLLISION
    ) -> Collisions:
        """Some of the pairs with such an outcome and what they hit."""
        return collisions(self.score, end, self.queries, _COLLISIONS, outcomes)

    def base_collisions(self, end: End) -> Collisions:
        """What the base hits where the arm would reach from."""
        seen = self.surveys[end]
        rows = (seen.reach == Outcome.SCORED) & (seen.base == Outcome.BASE_COLLISION)
        chosen = seen.queries.take(rows)
        outcomes = (Outcome.BASE_COLLISION,)
        return collisions(self.score, end, chosen, _COLLISIONS, outcomes)

    def in_the_way(self, segment: str) -> Collisions:
        """What is hit on the straight way through the joints' space, by candidate.

        `segment` is transit or transfer.
        """
        contacts = []
        for triple in self.triples:
            candidate = Candidate.of_triple(triple, self.score)
            world = self.score.worlds[End.START]
            q_from, q_to = self.score.problem.q_start, candidate.q[End.START]
            if segment == "transfer":
                world = world.attach(self.score.task.object, candidate.T_tool_object)
                q_from, q_to = candidate.q
            way = np.linspace(q_from, q_to, _WAYPOINTS)[1:-1]
            contacts += [world.contacts(q) for q in way]
        return Collisions(self.queries.head(0), tuple(c for c in contacts if c))

    @property
    def triples(self) -> tuple[Triple, ...]:
        """The candidates, as many as the scene lets the planner try."""
        if self.found is None:
            return ()
        return self.found.candidates[: self.score.problem.planner.candidates]

    @cached_property
    def queries(self) -> Queries:
        """All pairs, drawn and searched."""
        parts = [s.queries for s in self.surveys.values()]
        if self.found is not None:
            parts.append(self.found.evaluated)
        return Queries(*(np.concatenate(p) for p in zip(*parts, strict=True)))

    @cached_property
    def blocked(self) -> tuple[Blocked | None, ...]:
        """What stands in the way of each candidate's straight motions.

        It ends at the first of which they are free.
        """
        blocked: list[Blocked | None] = []
        for triple in self.triples:
            blocked.append(blocked_line(self.score, triple))
            if blocked[-1] is None:
                break
        return tuple(blocked)
