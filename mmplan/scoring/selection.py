"""The best of each row's candidates, where looking at a candidate is dear."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]

# Added to bounds, as values are rounded.
_ROUNDING = 1e-9


def best_of_rows(
    row: Indices, bound: Array, examine: Callable[[Indices], Array]
) -> Indices:
    """The places of the greatest value of each row, by row; the first of equals.

    Candidate k belongs to `row[k]`, and its value is at most `bound[k]`. `examine`
    gets places (m,) and returns their values (m,), -inf for what must not be chosen.
    It is asked about the candidates of a row by falling bounds, twice as many each
    time, for as long as one of them can still be the best. A row of which nothing can
    be chosen is examined in full and has no place in the result.
    """
    order = np.lexsort((-bound, row))
    group = np.cumsum(np.diff(row[order], prepend=row[order[:1]]) != 0)
    at = np.flatnonzero(np.diff(group, prepend=-1))
    end = np.append(at, len(row))[1:]
    best = np.full(len(at), -np.inf)
    value = np.full(len(row), -np.inf)
    bound, take = bound[order] + _ROUNDING, 1
    while True:
        left = np.flatnonzero(at < end)
        left = left[bound[at[left]] >= best[left]]
        if len(left) == 0:
            break
        stop = np.minimum(at[left] + take, end[left])
        chosen = _ranges(at[left], stop)
        chosen = chosen[bound[chosen] >= best[group[chosen]]]
        value[chosen] = examine(order[chosen])
        np.maximum.at(best, group[chosen], value[chosen])
        at[left], take = stop, 2 * take
    return _first_of_each(row, order, (value == best[group]) & (value > -np.inf))


def _ranges(start: Indices, stop: Indices) -> Indices:
    """All whole numbers from each start (k,) to before its stop, one after another."""
    sizes = stop - start
    skipped = np.repeat(start - (np.cumsum(sizes) - sizes), sizes)
    ranges: Indices = np.arange(len(skipped)) + skipped
    return ranges


def _first_of_each(
    row: Indices, order: Indices, wins: npt.NDArray[np.bool_]
) -> Indices:
    """The first place of each row among those that win, given in some order."""
    places = np.sort(order[wins])
    _, first = np.unique(row[places], return_index=True)
    return places[first]
