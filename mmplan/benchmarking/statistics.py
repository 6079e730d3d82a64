"""The statistics of a benchmark, by scipy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from mmplan.benchmarking.records import Record
from mmplan.shapes import Array

CONFIDENCE = 0.95
_RESAMPLES = 9999
_BAND_RESAMPLES = 999  # for each point of a curve


@dataclass(frozen=True)
class Proportion:
    """A share of runs with its Wilson interval."""

    count: int
    of: int
    low: float
    high: float

    @property
    def share(self) -> float:
        """The share itself, in [0, 1]."""
        return self.count / self.of


@dataclass(frozen=True)
class Spread:
    """Mean and sample standard deviation; NaN where there are too few numbers."""

    n: int
    mean: float
    deviation: float
    median: float


@dataclass(frozen=True)
class Difference:
    """How much a contender is ahead of another on the same seeds.

    `low` and `high` bound the mean difference: a bias-corrected and accelerated
    bootstrap interval. `p` is that of Wilcoxon's signed-rank test, two-sided.
    """

    n: int
    mean: float
    low: float
    high: float
    p: float

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """Number of pairs, mean, interval and p, for a table."""
        interval = f"{self.low:+.2f} to {self.high:+.2f}"
        return str(self.n), f"{self.mean:+.2f}", interval, f"{self.p:.2g}"


def proportion(count: int, of: int) -> Proportion:
    """A share and its Wilson interval."""
    interval = stats.binomtest(count, of).proportion_ci(CONFIDENCE, method="wilson")
    return Proportion(count, of, float(interval.low), float(interval.high))


def spread(values: Sequence[float]) -> Spread:
    """Mean, standard deviation (n - 1) and median."""
    n = len(values)
    mean = float(np.mean(values)) if n else np.nan
    deviation = float(np.std(values, ddof=1)) if n > 1 else np.nan
    return Spread(n, mean, deviation, float(np.median(values)) if n else np.nan)


def difference(
    ahead: Mapping[int, float], behind: Mapping[int, float]
) -> Difference | None:
    """Compare two contenders' scores by seed on the seeds that both have.

    None where they share fewer than two.
    """
    seeds = sorted(ahead.keys() & behind.keys())
    if len(seeds) < 2:
        return None
    d = np.array([ahead[s] - behind[s] for s in seeds])
    mean = float(d.mean())
    if np.ptp(d) == 0.0:  # nothing to resample or to rank
        p = 1.0 if mean == 0.0 else float(stats.wilcoxon(d).pvalue)
        return Difference(len(d), mean, mean, mean, p)
    interval = stats.bootstrap(
        (d,),
        np.mean,
        n_resamples=_RESAMPLES,
        confidence_level=CONFIDENCE,
        method="BCa",
        rng=np.random.default_rng(0),
    ).confidence_interval
    p = float(stats.wilcoxon(d).pvalue)
    return Difference(len(d), mean, float(interval.low), float(interval.high), p)


@dataclass(frozen=True, eq=False)
class Curve:
    """Mean best score so far against evaluations, with a bootstrap band."""

    evaluations: Array  # (n,)
    mean: Array  # (n,)
    low: Array  # (n,)
    high: Array  # (n,)


def best_so_far(records: Sequence[Record], share: float, points: int = 120) -> Curve:
    """The curve of a contender's runs, scores multiplied by `share`."""
    evaluations = np.linspace(1.0, records[0].evaluations, points)
    values = share * np.array([_steps(r, evaluations) for r in records])
    mean = values.mean(axis=0)
    low, high = mean.copy(), mean.copy()
    varied = np.flatnonzero(np.ptp(values, axis=0) > 0.0)
    if len(varied):
        interval = stats.bootstrap(
            (values[:, varied],),
            np.mean,
            axis=0,
            n_resamples=_BAND_RESAMPLES,
            batch=100,
            confidence_level=CONFIDENCE,
            method="percentile",
            rng=np.random.default_rng(0),
        ).confidence_interval
        low[varied], high[varied] = interval.low, interval.high
    return Curve(evaluations, mean, low, high)


def _steps(record: Record, evaluations: Array) -> Array:
    """The best score so far of one run after so many evaluations, (n,)."""
    if not record.history:
        return np.zeros(len(evaluations))
    spent, best = np.array(record.history).T
    place = np.searchsorted(spent, evaluations, side="right")
    found: Array = np.concatenate([[0.0], best])[place]
    return found
