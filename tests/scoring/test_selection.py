"""The best of each row is found without looking at what cannot be the best."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st

from mmplan.scoring.selection import best_of_rows
from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]
# A candidate's row, its value or None if it must not be chosen, and its bound's excess.
CANDIDATE = st.tuples(
    st.integers(0, 4),
    st.none() | st.integers(-3, 3).map(float),
    st.sampled_from([0.0, 0.5, 2.0, 9.0]),
)


class Examiner:
    """Answers with known values and keeps what it was asked."""

    def __init__(self, values: Array) -> None:
        self.values = values
        self.asked: list[int] = []

    def __call__(self, places: Indices) -> Array:
        self.asked += places.tolist()
        return self.values[places]


def examined(candidates: list[tuple[int, float | None, float]]) -> tuple[Array, ...]:
    rows = np.array([row for row, _, _ in candidates], dtype=np.int64)
    values = np.array([-np.inf if v is None else v for _, v, _ in candidates])
    bounds = np.array([(v or 0.0) + excess for _, v, excess in candidates])
    return rows, values, bounds


@given(st.lists(CANDIDATE, max_size=40))
def test_it_is_the_first_of_the_greatest_values(
    candidates: list[tuple[int, float | None, float]],
) -> None:
    rows, values, bounds = examined(candidates)
    expected = [
        int(np.flatnonzero((rows == row) & (values == values[rows == row].max()))[0])
        for row in sorted(set(rows.tolist()))
        if values[rows == row].max() > -np.inf
    ]
    assert best_of_rows(rows, bounds, Examiner(values)).tolist() == expected


@given(st.lists(CANDIDATE, max_size=40))
def test_each_is_examined_at_most_once_and_all_where_none_can_be_chosen(
    candidates: list[tuple[int, float | None, float]],
) -> None:
    rows, values, bounds = examined(candidates)
    examiner = Examiner(values)
    best_of_rows(rows, bounds, examiner)
    assert len(examiner.asked) == len(set(examiner.asked))
    for row in set(rows.tolist()):
        places = np.flatnonzero(rows == row)
        if np.all(values[places] == -np.inf):
            assert set(places.tolist()) <= set(examiner.asked)


def test_what_cannot_be_the_best_is_not_examined() -> None:
    rows = np.zeros(100, dtype=np.int64)
    values = np.arange(100.0)
    examiner = Examiner(values)
    assert best_of_rows(rows, values + 0.5, examiner).tolist() == [99]
    assert examiner.asked == [99]


def test_nothing_to_choose_from() -> None:
    nothing = np.empty(0)
    assert len(best_of_rows(nothing.astype(np.int64), nothing, Examiner(nothing))) == 0
