"""The archive knows the best of all that it was told, however it was told."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mmplan.genes import GeneSpace
from mmplan.optimizers import Archive, Triple
from mmplan.optimizers.archive import distinct
from mmplan.scoring import End


class Entry(NamedTuple):
    end: End
    base: int
    grasp: int
    total: float


def row(number: int) -> np.ndarray:
    return np.array([float(number), 0.5])


def entries(numbers: st.SearchStrategy[int]) -> st.SearchStrategy[list[Entry]]:
    totals = st.floats(0.01, 100.0)
    entry = st.builds(Entry, st.sampled_from(list(End)), numbers, numbers, totals)
    return st.lists(entry, max_size=25, unique_by=lambda e: e[:3])


def filled(told: list[Entry]) -> Archive:
    archive = Archive()
    for end, base, grasp, total in told:
        archive.add(end, row(base), row(grasp), total)
    return archive


ENTRIES = entries(st.integers(0, 3))


@given(ENTRIES)
def test_the_best_sum_is_that_of_the_best_triple(told: list[Entry]) -> None:
    archive = filled(told)
    sums = [
        a.total + b.total
        for a in told
        for b in told
        if (a.end, b.end) == (End.START, End.GOAL) and a.grasp == b.grasp
    ]
    assert archive.best == max(sums, default=0.0)
    triples = archive.triples()
    assert max((t.total for t in triples), default=0.0) == archive.best
    assert [t.total for t in triples] == sorted(
        (t.total for t in triples), reverse=True
    )


@given(ENTRIES, st.sets(st.integers(0, 3)), st.sets(st.integers(0, 3)))
def test_triples_are_entries_of_those_asked_for(
    told: list[Entry], grasps: set[int], bases: set[int]
) -> None:
    keys = {(e.end, e.base, e.grasp): e.total for e in told}
    triples = filled(told).triples(
        {row(g).tobytes() for g in grasps}, {row(b).tobytes() for b in bases}
    )
    assert len({t.grasp[0] for t in triples}) == len(triples)
    for triple in triples:
        assert triple.grasp[0] in grasps
        for end in End:
            base = int(triple.q_base[end][0])
            assert base in bases
            assert keys[end, base, int(triple.grasp[0])] == triple.scores[end]


@given(ENTRIES)
def test_grasps_are_counted_by_where_they_work(told: list[Entry]) -> None:
    ends = [{e.end for e in told if e.grasp == g} for g in range(4)]
    kinds = [{End.START}, {End.GOAL}, {End.START, End.GOAL}]
    assert filled(told).grasps_by_end() == tuple(ends.count(kind) for kind in kinds)


@given(ENTRIES)
def test_the_order_of_telling_does_not_change_the_best(told: list[Entry]) -> None:
    assert filled(told[::-1]).best == filled(sorted(told)).best == filled(told).best


ANGLE = GeneSpace(np.array([-np.pi]), np.array([np.pi]), np.array([True]))


def holding(angle: float, x: float = 0.0, total: float = 1.0) -> Triple:
    base = np.array([x, 0.0])
    return Triple((base, base), np.array([angle]), (total, total))


def test_distinct_candidates_differ_in_a_base_or_in_the_grasp() -> None:
    first = holding(0.0)
    assert distinct([first, holding(0.1)], ANGLE, 5) == [first]
    assert distinct([first, holding(0.0, x=0.04)], ANGLE, 5) == [first]
    assert len(distinct([first, holding(0.4)], ANGLE, 5)) == 2
    assert len(distinct([first, holding(0.0, x=0.06)], ANGLE, 5)) == 2
    assert len(distinct([first, holding(1.0), holding(2.0)], ANGLE, 2)) == 2


def test_angles_on_both_sides_of_the_seam_are_the_same_grasp() -> None:
    assert len(distinct([holding(3.1), holding(-3.1)], ANGLE, 5)) == 1
