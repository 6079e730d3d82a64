"""Co-evolution of start bases, goal bases and grasps (paper, section IV.B)."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.optimizers.archive import Archive, Triple, distinct
from mmplan.optimizers.optimizer import Queries, SearchSpace
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End
from mmplan.shapes import Array

# F_Grasp of a grasp that works at exactly one end (paper, section IV.B).
ONE_END_FITNESS = 1.0

_Search = Generator[Queries, Array, None]


class CoEvolution:
    """The paper's three populations, to the letter.

    One cycle evolves each base population for one generation and then the grasps. A
    generation evaluates its population, keeps the fittest half as parents and fills up
    with their children. Populations are kept sorted, fittest first, unevaluated
    children last. The evaluations asked for are those of eq. 3 and of F_Grasp; all are
    asked for anew in every generation.

    A base that stands still has no genes: its population is that one placement, which
    is not evolved, and a cycle is one generation of the grasps, whose fitness F_Grasp
    is of that placement at either end. The budget buys more such cycles.
    """

    def __init__(
        self,
        space: SearchSpace,
        settings: OptimizerSettings,
        rng: np.random.Generator,
    ) -> None:
        """Draw the first populations.

        Raises:
            NoPlanError: There is no room for the base around the object.
        """
        self._space = space
        self._settings = settings
        self._rng = rng
        self._bases = {end: self._first_bases(end) for end in End}
        self._grasps = space.grasps.sample(settings.grasps, rng)
        self._asked = 0
        self._search = self._cycle_forever()
        self._pending = next(self._search)

    @property
    def cycles(self) -> float:
        """How many cycles the evaluations told so far amount to."""
        k = self._settings.partners
        cycle = 0
        for end in End:
            bases, n = self._bases[end], len(self._bases[end])
            cycle += min(k, n) * len(self._grasps) + (n * k if bases.size else 0)
        return self._asked / cycle

    def ask(self, limit: int) -> Queries:
        """The current generation's evaluations; its head if the budget ends in it."""
        self._pending = self._pending.head(limit)
        return self._pending

    def tell(self, totals: Array) -> None:
        """Finish the generation."""
        self._asked += len(totals)
        self._pending = self._search.send(totals)

    def candidates(self, archive: Archive, most: int) -> list[Triple]:
        """The best grasps of the population with their best bases in the populations.

        Scores are those that the search came by; the first is the best joint candidate
        by the sum of its two scores.
        """
        bases = {
            row.tobytes()
            for end in End
            for row in self._space.bases[end].q_base(self._bases[end])
        }
        grasps = {row.tobytes() for row in self._grasps}
        triples = archive.triples(grasps, bases)
        return distinct(triples, self._space.grasps, most)

    def _first_bases(self, end: End) -> Array:
        placements = self._space.bases[end]
        n = self._settings.bases if len(placements.genes) else 1
        return placements.sample(n, self._rng)

    def _cycle_forever(self) -> _Search:
        while True:
            yield from self._evolve_bases()
            yield from self._evolve_grasps()

    def _evolve_bases(self) -> _Search:
        """A generation of both; F_Base is the best with the k fittest grasps (eq. 3).

        Neither counts for the other: the scores of both are asked for at once.
        """
        places = {end: self._space.bases[end] for end in End if self._bases[end].size}
        if not places:
            return
        q_base = {end: p.q_base(self._bases[end]) for end, p in places.items()}
        scores = yield from self._ask_all(q_base, self._fittest_grasps())
        for end, at_end in scores.items():
            fitness, genes = at_end.max(axis=1), places[end].genes
            self._bases[end] = self._next(self._bases[end], fitness, genes)

    def _evolve_grasps(self) -> _Search:
        """One generation; F_Grasp sums the scores with the k fittest bases."""
        k = self._settings.partners
        q_base = {e: self._space.bases[e].q_base(self._bases[e][:k]) for e in End}
        scores = yield from self._ask_all(q_base, self._grasps)
        if len(scores) == len(End):
            fitness = grasp_fitness(*(scores[end].sum(axis=0) for end in End))
            self._grasps = self._next(self._grasps, fitness, self._space.grasps)

    def _fittest_grasps(self) -> Array:
        return self._grasps[: self._settings.partners]

    def _ask_all(
        self, q_base: dict[End, Array], grasps: Array
    ) -> Generator[Queries, Array, dict[End, Array]]:
        """The scores (bases, grasps) of all pairs, of ends that the budget allows."""
        m = len(grasps)
        counts = [len(q) * m for q in q_base.values()]
        totals = yield Queries(
            np.repeat(np.array(list(q_base), np.int8), counts),
            np.concatenate([np.repeat(q, m, axis=0) for q in q_base.values()]),
            np.concatenate([np.tile(grasps, (len(q), 1)) for q in q_base.values()]),
        )
        ends = np.cumsum(counts)
        return {
            end: totals[last - count : last].reshape(-1, m)
            for end, count, last in zip(q_base, counts, ends, strict=True)
            if last <= len(totals)
        }

    def _next(self, population: Array, fitness: Array, genes: GeneSpace) -> Array:
        """The fittest half, fittest first, then as many children as are missing."""
        n = len(population)
        parents = population[np.argsort(-fitness, kind="stable")][: (n + 1) // 2]
        mutation = self._settings.mutation
        children = breed(parents, n - len(parents), genes, mutation, self._rng)
        return np.concatenate([parents, children])


def grasp_fitness(start: Array, goal: Array) -> Array:
    """F_Grasp (n,) from the sums of scores (n,) at either end.

    1.0 where exactly one of them is 0, so that grasps that work at one end survive
    without any advantage over other such grasps.
    """
    one_end = (start > 0.0) != (goal > 0.0)
    return np.where(one_end, ONE_END_FITNESS, start + goal)


def breed(
    parents: Array,
    n: int,
    genes: GeneSpace,
    mutation: float,
    rng: np.random.Generator,
) -> Array:
    """N children (n, d) by two-point crossover of two different parents and mutation.

    Each gene mutates with probability `mutation` by a uniform value of at most a
    quarter of its range either way.
    """
    d = len(genes)
    first = rng.integers(len(parents), size=n)
    second = (first + rng.integers(1, max(len(parents), 2), size=n)) % len(parents)
    cuts = np.sort(rng.integers(0, d + 1, (n, 2)), axis=1)
    place = np.arange(d)
    inside = (place >= cuts[:, :1]) & (place < cuts[:, 1:])
    children = np.where(inside, parents[second], parents[first])
    mutated = rng.random((n, d)) < mutation
    step = rng.uniform(-0.25, 0.25, (n, d)) * genes.range
    return genes.contain(children + np.where(mutated, step, 0.0))
