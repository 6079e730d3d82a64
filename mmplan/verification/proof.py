"""The proof that nothing touches at any time of a segment.

Adaptive bisection of time after F. Schwarzer, M. Saha and J.-C. Latombe, "Adaptive
dynamic collision checking for single and multiple articulated robots in complex
environments", IEEE Transactions on Robotics 21(3), 2005. In the middle of a stretch
of time the distance of a pair of bodies is d. Until either end of the stretch, no point
of the one body moves farther relative to the other than

    reach = Σ_j (largest speed of joint j · half of the stretch) · lever of joint j

over the joints between the two. A pair with d > reach stays apart all through the
stretch; where that is not so, the stretch is split, and only such pairs go on. A pair
that touches is found: the splitting ends with an overlap in the middle of a stretch or,
once the reach is below `SMALLEST_REACH`, with a pair too near to be proven apart. The
speeds are those of the cubic Hermite curve that is delivered.

Most pairs are settled by lower bounds of d from spheres and boxes, computed for all
stretches and pairs at once; only the rest are given to coal, nearest first. To learn
the smallest clearance as well, a pair counts as settled only if it is shown to stay
farther apart than a share of the smallest distance found so far (`Ledger.floor`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mmplan.hermite import HermiteCurve
from mmplan.shapes import Array
from mmplan.verification.bodies import Bodies, Indices, Mask
from mmplan.verification.ledger import Finding, Ledger
from mmplan.verification.moments import Moments
from mmplan.verification.touching import TouchRule

# The first stretches of time are at most this long, s.
FIRST_STRETCH = 0.25
# A stretch within which a pair cannot move farther than this is not split, m.
SMALLEST_REACH = 1e-5
# coal's distances are trusted down to this, m.
DISTANCE_ERROR = 1e-6
# Pairs times stretches that are looked at together.
_BATCH = 100_000


@dataclass(frozen=True, eq=False)
class _Open:
    """Pairs not settled yet, each over one of the stretches [start, end] of time."""

    start: Array  # (n,), s
    end: Array  # (n,), s
    stretch: Indices  # (k,), into start and end
    pair: Indices  # (k,)

    @property
    def middle(self) -> Array:
        """The middles of the stretches, (n,)."""
        return (self.start + self.end) / 2.0

    def middle_of(self, stretch: int) -> float:
        """The middle of one stretch."""
        return float(self.start[stretch] + self.end[stretch]) / 2.0

    def split(self, still: Mask) -> _Open:
        """Those that are `still` open, over both halves of their stretches."""
        used, stretch = np.unique(self.stretch[still], return_inverse=True)
        start, middle, end = self.start[used], self.middle[used], self.end[used]
        return _Open(
            start=np.concatenate([start, middle]),
            end=np.concatenate([middle, end]),
            stretch=np.concatenate([stretch, stretch + len(used)]),
            pair=np.tile(self.pair[still], 2),
        )


@dataclass(frozen=True, eq=False)
class _Margins:
    """What is known of k open pairs in the middles of their stretches, all (k,)."""

    distance: Array  # m, exact or a lower bound
    exact: Mask
    reach: Array  # m
    allowed: Array  # m of overlap, at any time of the stretch
    allowed_now: Array  # m of overlap, in the middle of the stretch

    @property
    def slack(self) -> Array:
        """How far the pairs keep at least from the overlap allowed, m."""
        return self.distance - DISTANCE_ERROR - self.reach + self.allowed


class SegmentProof:
    """The proof for one segment of a plan, written to a ledger."""

    def __init__(
        self,
        stage: int,
        curve: HermiteCurve,
        bodies: Bodies,
        rule: TouchRule,
        ledger: Ledger,
    ) -> None:
        """Prepare the proof of segment number `stage`, for the pairs of `bodies`."""
        self._stage = stage
        self._curve = curve
        self._bodies = bodies
        self._rule = rule
        self._ledger = ledger
        self._first, self._second = bodies.world.pairs.reshape(-1, 2).T
        self._levers = bodies.relative_levers(self._first, self._second)

    def run(self) -> None:
        """Go through the whole segment."""
        for pairs in self._batches():
            while len(pairs.pair):
                self._ledger.intervals += len(pairs.start)
                pairs = pairs.split(self._settle(pairs))

    def _batches(self) -> Iterator[_Open]:
        """All pairs over the first stretches."""
        duration = float(self._curve.times[-1])
        edges = np.linspace(0.0, duration, int(np.ceil(duration / FIRST_STRETCH)) + 1)
        count = len(self._first)
        step = max(1, _BATCH // max(1, count))
        for i in range(0, len(edges) - 1, step):
            start = edges[i : i + step + 1][:-1]
            yield _Open(
                start=start,
                end=edges[i + 1 : i + 1 + len(start)],
                stretch=np.repeat(np.arange(len(start)), count),
                pair=np.tile(np.arange(count), len(start)),
            )

    def _settle(self, pairs: _Open) -> Mask:
        """Which pairs must be looked at in both halves of their stretches, (k,)."""
        margins = self._margins(pairs)
        slack, ledger = margins.slack, self._ledger
        strict = margins.allowed == 0.0
        unsettled = slack <= np.where(strict, ledger.floor, 0.0)
        overlap = margins.exact & (margins.distance + margins.allowed_now <= 0.0)
        small = margins.reach <= SMALLEST_REACH
        undecided = unsettled & small & (slack <= 0.0) & ~overlap
        split = unsettled & ~small & ~overlap
        proven = slack[strict & ~(overlap | undecided | split)]
        ledger.proven = min(ledger.proven, float(np.min(proven, initial=np.inf)))
        for k in np.flatnonzero(overlap).tolist():
            ledger.note_overlap(self._finding(pairs, margins, k))
        for k in np.flatnonzero(undecided).tolist():
            ledger.note_undecided(self._finding(pairs, margins, k))
        return split

    def _margins(self, pairs: _Open) -> _Margins:
        moments = Moments(self._bodies, self._curve.positions(pairs.middle))
        speed = self._curve.velocity_extremes(pairs.start, pairs.end).magnitude
        reach = speed * ((pairs.end - pairs.start) / 2.0)[:, None]  # (n, nq)
        levers = self._levers[pairs.pair]
        allowed_now, allowed = self._rule.allowances(
            moments.T_world_joint, reach, pairs.stretch, pairs.pair
        )
        margins = _Margins(
            distance=moments.sphere_gaps(*self._bodies_of(pairs)),
            exact=np.zeros(len(pairs.pair), dtype=np.bool_),
            reach=np.einsum("kj,kj->k", reach[pairs.stretch], levers),
            allowed=allowed,
            allowed_now=allowed_now,
        )
        self._sharpen(pairs, moments, margins)
        return margins

    def _sharpen(self, pairs: _Open, moments: Moments, margins: _Margins) -> None:
        """Make distances as sharp as it takes to settle pairs, the nearest first."""
        ledger, strict = self._ledger, margins.allowed == 0.0
        if ledger.nearest is None:
            self._measure(pairs, moments, margins, np.argsort(margins.slack)[:1])
        rough = np.flatnonzero(~margins.exact & (margins.slack <= ledger.floor))
        boxes = moments.box_gaps(*self._bodies_of(pairs, rough))
        margins.distance[rough] = np.maximum(margins.distance[rough], boxes)
        slack = margins.slack
        rough = rough[slack[rough] <= np.where(strict[rough], ledger.floor, 0.0)]
        order = np.argsort(slack[rough], kind="stable")
        self._measure(pairs, moments, margins, rough[order])

    def _measure(
        self, pairs: _Open, moments: Moments, margins: _Margins, queue: Indices
    ) -> None:
        """Exact distances along a queue, until the rest of it is settled."""
        ledger = self._ledger
        floor = ledger.floor
        slack = margins.slack[queue].tolist()
        apart = (margins.allowed_now[queue] == 0.0).tolist()
        distances = moments.distances(*self._bodies_of(pairs, queue))
        for n, k in enumerate(queue.tolist()):
            if slack[n] > floor:
                break
            margins.distance[k] = distance = next(distances)
            margins.exact[k] = True
            ledger.queries += 1
            if apart[n] and ledger.is_nearer(distance):
                ledger.nearest = self._finding(pairs, margins, k)
                floor = ledger.floor

    def _bodies_of(
        self, pairs: _Open, which: Indices | None = None
    ) -> tuple[Indices, Indices, Indices]:
        """Stretch, first and second body of pairs, or of some of them."""
        chosen = slice(None) if which is None else which
        pair = pairs.pair[chosen]
        return pairs.stretch[chosen], self._first[pair], self._second[pair]

    def _finding(self, pairs: _Open, margins: _Margins, k: int) -> Finding:
        owners, pair = self._bodies.owners, pairs.pair[k]
        kinds = {self._bodies.kinds[i] for i in (self._first[pair], self._second[pair])}
        return Finding(
            stage=self._stage,
            first=owners[self._first[pair]],
            second=owners[self._second[pair]],
            time=pairs.middle_of(int(pairs.stretch[k])),
            distance=float(margins.distance[k]),
            allowed=float(margins.allowed_now[k]),
            region="region" in kinds,
        )
