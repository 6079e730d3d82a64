"""What a score is made of, for people and reports."""

from __future__ import annotations

from dataclasses import dataclass

from mmplan.scoring.clutter import Clutter
from mmplan.scoring.outcome import Outcome
from mmplan.scoring.term import Grasped


@dataclass(frozen=True)
class LinkClutter:
    """What one link adds to the clutter term."""

    link: str
    distance: float  # m, to the nearest obstacle; infinite where there is none
    weight: float  # 1/m
    points: float  # weight times distance, scaled and weighted as the term is


@dataclass(frozen=True)
class Breakdown:
    """One score by term, and its clutter term by link; terms add up to `total`.

    `links` is empty where the outcome is another than SCORED.
    """

    outcome: Outcome
    total: float
    terms: dict[str, float]  # in the order of `term_names`
    links: tuple[LinkClutter, ...] = ()


def links_of(
    clutter: Clutter, grasped: Grasped, factor: float
) -> tuple[LinkClutter, ...]:
    """The clutter of the only configuration of `grasped`, link by link."""
    (weights,) = clutter.weights(grasped.q).tolist()
    (distances,) = clutter.distances(grasped).tolist()
    points = (factor * clutter.by_link(grasped)[0]).tolist()
    rows = zip(clutter.links, distances, weights, points, strict=True)
    return tuple(LinkClutter(*row) for row in rows)
