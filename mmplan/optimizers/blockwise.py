"""Blockwise search: given the grasp, either base is a search of its own."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.optimizers.archive import Archive, Triple, distinct
from mmplan.optimizers.bases import base_ways
from mmplan.optimizers.lineage import Lineage
from mmplan.optimizers.optimizer import Queries, SearchSpace
from mmplan.optimizers.successes import Successes
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End
from mmplan.shapes import Array

_SCOUTS = 24  # grasps tried at once in search of new triples
_ROUNDS = 3  # in which the second end of a grasp is tried before it is given up
_PROPOSALS = 16  # in a generation of refinement
_TRIES = 2  # bases for a grasp and end
_FEWEST_LINES, _MOST_LINES = 4, 30  # at first; their number shrinks to 1
_EVALUATIONS_A_LINE = 150  # of the budget; fewer lines where it is small
_MOVED_GRASPS = 0.65  # share of proposals that change the grasp as well
_SLACK = 0.1  # share of the sum that the first end may lose before the second is tried
_SCOUTING = 0.3  # share of generations that also look for new triples, at first

_Search = Generator[Queries, Array, None]
_Scored = Generator[Queries, Array, tuple[Array, Array]]


class Blockwise:
    """Refines a few joint candidates, bases and grasp in turn.

    The sum of both scores falls apart once the grasp is fixed: with the grasp, either
    base can be improved on its own. So every proposal tries several bases at either
    end and keeps the best of each. It looks first at the end where fewer evaluations
    have succeeded, and at the other only if the first leaves it a chance.

    Scouts find the first triples: grasps at random with bases at random or near those
    that have served similar grasps. Each triple founds a line of descent; better lines
    get more proposals, the more so the nearer the end of the budget, and converged
    ones give way to new scouts. No knowledge of the arm or the obstacles is used but
    that bases must be free of collision, as in the other optimizers' first draws.

    A base that stands still is tried once for a grasp: then only grasps are searched.
    """

    cycles = None

    def __init__(
        self,
        space: SearchSpace,
        settings: OptimizerSettings,
        rng: np.random.Generator,
    ) -> None:
        """Draw the first scouts; of the settings the budget counts.

        Raises:
            NoPlanError: There is no room for the base around the object.
        """
        self._space = space
        self._rng = rng
        self._budget = settings.evaluations
        self._spent = 0
        self._lines: list[Lineage] = []
        self._converged: list[Triple] = []
        self._successes = {
            end: Successes(space.bases[end], space.grasps, rng) for end in End
        }
        # Trying a base again is of no use where there is but one.
        varied = any(len(placements.genes) for placements in space.bases.values())
        self._tries = _TRIES if varied else 1
        self._rounds = _ROUNDS if varied else 1
        self._search = self._forever()
        self._pending = next(self._search)

    def ask(self, limit: int) -> Queries:
        """The evaluations of the current step; its head if the budget ends in it."""
        self._pending = self._pending.head(limit)
        return self._pending

    def tell(self, totals: Array) -> None:
        """Go on to the next step."""
        self._spent += len(totals)
        self._pending = self._search.send(totals)

    def candidates(self, archive: Archive, most: int) -> list[Triple]:
        """The best triples of all that was evaluated."""
        return distinct(archive.triples(), self._space.grasps, most)

    @property
    def _progress(self) -> float:
        return min(1.0, self._spent / self._budget)

    @property
    def _wanted(self) -> int:
        """How many lines there should be now, at least 1."""
        lines = self._budget / _EVALUATIONS_A_LINE
        at_first = min(max(lines, _FEWEST_LINES), _MOST_LINES)
        return max(1, int(np.ceil(at_first * (1.0 - self._progress))))

    @property
    def _ends(self) -> tuple[End, End]:
        """The end where evaluations succeed more rarely, then the other."""
        first = min(End, key=lambda end: self._successes[end].rate)
        return first, End(1 - first)

    def _forever(self) -> _Search:
        while True:
            more = self._rng.random() < _SCOUTING * (1.0 - self._progress)
            if len(self._lines) < self._wanted or more:
                yield from self._scout()
            if self._lines:
                yield from self._refine()
            self._select()

    def _scout(self) -> _Search:
        """Find grasps that work at one end and then, for these, bases at the other."""
        first, second = self._ends
        grasps = self._successes[first].grasps(_SCOUTS)
        bases = self._successes[first].bases(grasps, 1)
        q_first, s_first = yield from self._evaluate(first, bases, grasps)
        open_ = s_first > 0.0
        for _ in range(self._rounds):
            rows = np.flatnonzero(open_)
            if len(rows) == 0:
                return
            bases = self._successes[second].bases(grasps[rows], self._tries)
            q, s = yield from self._evaluate(second, bases, grasps[rows])
            for row, q_second, s_second in zip(rows, q, s.tolist(), strict=True):
                if s_second > 0.0:
                    open_[row] = False
                    ends = {first: (q_first[row], float(s_first[row]))}
                    ends[second] = (q_second, s_second)
                    self._lines.append(Lineage.of(_triple(ends, grasps[row])))

    def _refine(self) -> _Search:
        """One generation of proposals, shared out among the lines."""
        parents = self._parents()
        old = np.array([p.triple.grasp for p in parents])
        moved = self._rng.random(len(parents)) < _MOVED_GRASPS
        steps = np.array([p.grasp_step(self._rng) for p in parents]) * moved[:, None]
        genes = self._space.grasps
        grasps = np.where(moved[:, None], genes.contain(old + steps * genes.range), old)
        q = np.array([p.triple.q_base for p in parents])  # (n, 2, base joints)
        before = np.array([p.triple.scores for p in parents])  # (n, 2)
        after = np.where(moved[:, None], 0.0, before)
        rows = np.arange(len(parents))  # those that are still worth trying
        for end in self._ends:
            bases = self._bases_about(end, [parents[i] for i in rows], steps[rows])
            found, scores = yield from self._evaluate(end, bases, grasps[rows])
            better = scores > after[rows, end]
            after[rows[better], end] = scores[better]
            q[rows[better], end] = found[better]
            least = before[rows, end] - _SLACK * before[rows].sum(axis=1)
            rows = rows[after[rows, end] > np.maximum(least, 0.0)]
            if len(rows) == 0:
                break
        for parent, bases, grasp, scores in zip(parents, q, grasps, after, strict=True):
            start, goal = scores.tolist()
            self._judge(parent, Triple((bases[0], bases[1]), grasp, (start, goal)))

    def _bases_about(self, end: End, parents: list[Lineage], steps: Array) -> Array:
        """Bases (n, m, b) about those of n parents, given the steps of the grasps."""
        q = np.array([p.triple.q_base[end] for p in parents])
        origin = np.repeat(q[:, None], self._tries, axis=1)
        drawn = [
            p.base_steps(end, step, self._tries, self._rng)
            for p, step in zip(parents, steps, strict=True)
        ]
        return self._successes[end].contained(origin + np.array(drawn), origin)

    def _judge(self, parent: Lineage, child: Triple) -> None:
        """Let a child that is better take its parent's place."""
        if min(child.scores) > 0.0 and child.total > parent.triple.total:
            parent.succeed(child, _step(parent.triple, child, self._space.grasps))
        else:
            parent.fail()

    def _parents(self) -> list[Lineage]:
        """Lines for the proposals of a generation, better ones more often."""
        rank = np.arange(len(self._lines))
        promise = np.exp(-rank / len(rank) * (1.0 + 3.0 * self._progress))
        chosen = self._rng.choice(rank, _PROPOSALS, p=promise / promise.sum())
        return [self._lines[i] for i in chosen]

    def _select(self) -> None:
        """Keep the best lines that are going on and differ from each other."""
        self._converged += [x.triple for x in self._lines if x.converged]
        lines = {id(x.triple): x for x in self._lines if not x.converged}
        triples = [*self._converged, *(x.triple for x in lines.values())]
        triples.sort(key=lambda t: -t.total)
        kept = distinct(triples, self._space.grasps, len(triples))
        self._lines = [lines[id(t)] for t in kept if id(t) in lines][: self._wanted]

    def _evaluate(self, end: End, bases: Array, grasps: Array) -> _Scored:
        """Of bases (n, m, b) for each of n grasps the best (n, b), and scores (n,).

        What the budget cuts off scores 0.
        """
        n, m, joints = bases.shape
        queries = Queries(
            np.full(n * m, end, np.int8),
            bases.reshape(n * m, joints),
            np.repeat(grasps, m, axis=0),
        )
        told = yield queries
        totals = np.zeros(n * m)
        totals[: len(told)] = told
        self._successes[end].add(queries, totals)
        totals = totals.reshape(n, m)
        best, rows = totals.argmax(axis=1), np.arange(n)
        return bases[rows, best], totals[rows, best]


def _triple(ends: dict[End, tuple[Array, float]], grasp: Array) -> Triple:
    (start, s), (goal, g) = ends[End.START], ends[End.GOAL]
    return Triple((start, goal), grasp, (s, g))


def _step(before: Triple, after: Triple, genes: GeneSpace) -> Array:
    """The way from one triple to another, (d,), the short way round for angles."""
    width = np.where(genes.range > 0.0, genes.range, 1.0)
    grasp = (after.grasp - before.grasp) / width
    turned = np.mod(grasp + 0.5, 1.0) - 0.5
    bases = map(base_ways, before.q_base, after.q_base)
    return np.concatenate([*bases, np.where(genes.periodic, turned, grasp)])
