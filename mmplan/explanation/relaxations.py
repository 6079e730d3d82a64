"""Changes that were tried, and those that make the problem solvable."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from mmplan.exceptions import NoPlanError
from mmplan.explanation.causes import STRAIGHT, Cause, Kind
from mmplan.explanation.other_grasps import other_families
from mmplan.explanation.robot_changes import narrower_hand, wider_limits
from mmplan.explanation.search import (
    blocked_line,
    blocked_motion,
    search,
    setting_score,
)
from mmplan.explanation.settings import (
    Change,
    Setting,
    any_quality,
    shifted,
    shorter_line,
    slimmer_object,
    wider_bounds,
    without,
    without_zone,
)
from mmplan.explanation.survey import is_reached
from mmplan.optimizers import search_space
from mmplan.problem import Problem
from mmplan.scoring import End

_SHIFTS = (0.03, 0.1, 0.4)  # m
_DIRECTIONS = (
    (0, 0, 1),
    (0, 0, -1),
    (1, 0, 0),
    (-1, 0, 0),
    (0, 1, 0),
    (0, -1, 0),
)
_NARROWER = (0.02, 0.04)  # m
_SLIMMER = (0.02, 0.05, 0.1)  # m
_WIDER = (0.1, 0.3, 1.0)  # m
_TURNS = tuple(np.radians([10.0, 20.0, 40.0, 80.0]).tolist())  # rad
_SHORTER = (0.75, 0.5, 0.25, 0.0)  # of what the scene wants
_SUSPECTS = 4  # obstacles that are taken away one by one, then two by two
_CANDIDATES = 3  # whose straight motions are tried
_PAIRS = 500  # drawn at each end to see whether a search is worth its while
_EVALUATIONS = 200  # of a search
_ITERATIONS = 1000  # of the planner

# What another grasp may help against.
_GRASPING: tuple[Kind, ...] = (
    "hand",
    "grasp quality",
    "carry",
    "reach",
    "joint limits",
    "collision",
    "hand opened",
    "common grasp",
)


@dataclass(frozen=True)
class Relaxation:
    """A change that was tried: in words, how large it is (m), whether it helps.

    `removed` names what was taken away.
    """

    text: str
    size: float
    removed: tuple[str, ...]
    solvable: bool


@dataclass(frozen=True)
class Trials:
    """Tries changes of a setting, each with a small search.

    Straight motions are asked for with `lines`, paths as well with `paths`.
    """

    setting: Setting
    seed: int
    lines: bool = False
    paths: bool = False

    def __call__(self, change: Change) -> Relaxation:
        """Whether the problem is solvable with a change."""
        changed = change.apply(self.setting)
        solvable = changed is not None and self._solvable(changed)
        return Relaxation(change.text, change.size, change.removed, solvable)

    def _solvable(self, setting: Setting) -> bool:
        score = setting_score(setting._replace(problem=_quick(setting.problem)))
        rng = np.random.default_rng(self.seed)
        space = search_space(score)
        if not all(is_reached(score, end, space, _PAIRS, rng) for end in End):
            return False
        try:
            triples = search(score, _EVALUATIONS, rng, _CANDIDATES).candidates
        except NoPlanError:
            return False
        if self.paths:
            return any(blocked_motion(score, t, rng) is None for t in triples[:1])
        if self.lines:
            return any(blocked_line(score, t) is None for t in triples)
        return bool(triples)


def _quick(problem: Problem) -> Problem:
    """The problem without what takes time and decides nothing here.

    That is the clutter term and most of the planner's patience.
    """
    settings = replace(
        problem.score,
        grasp=0.0,
        manipulability=1.0,
        clutter=0.0,
        joint_margin=0.0,
        more=(),
    )
    iterations = min(_ITERATIONS, problem.planner.iterations)
    planner = replace(problem.planner, iterations=iterations, shortcuts=0)
    return replace(problem, score=settings, planner=planner)


def relaxations(
    trials: Trials, cause: Cause, suspects: Sequence[str], joints: Sequence[str]
) -> tuple[Relaxation, ...]:
    """All that was tried; what helps comes first, the smallest change before others.

    `suspects` are taken away, and the limits of some `joints` widened.
    """
    tried = list(_removals(trials, suspects))
    for ladder in _ladders(trials.setting, cause, joints):
        tried += _climb(trials, ladder)
    return tuple(sorted(tried, key=lambda r: (not r.solvable, r.size, r.text)))


def _removals(trials: Trials, suspects: Sequence[str]) -> Iterator[Relaxation]:
    """Each of the suspects taken away; in twos if no single one does."""
    names = suspects[:_SUSPECTS]
    single = [trials(without(trials.setting, name)) for name in names]
    yield from single
    if not any(r.solvable for r in single):
        for two in combinations(names[:3], 2):
            yield trials(without(trials.setting, *two))


# A few changes of one kind and of one size each: smallest sizes first.
Ladder = Sequence[Sequence[Change]]


def _climb(trials: Trials, ladder: Ladder) -> Iterator[Relaxation]:
    """Try greater changes until one helps."""
    for rung in ladder:
        tried = [trials(change) for change in rung]
        yield from tried
        if any(r.solvable for r in tried):
            return


def _ladders(setting: Setting, cause: Cause, joints: Sequence[str]) -> Iterator[Ladder]:
    """The kinds of changes that can help against a cause."""
    task, kind = setting.task, cause.kind
    yield from _ladders_of_grasping(setting, kind)
    if kind == "joint limits":
        yield [[wider_limits(setting, j, by) for j in joints] for by in _TURNS]
    if kind in STRAIGHT:
        length: float = getattr(task, kind) or 0.0
        yield [[shorter_line(task, kind, share * length)] for share in _SHORTER]
    if kind in ("base bounds", "base", "reach", "joint limits"):
        yield [[wider_bounds(by)] for by in _WIDER]
        yield [[without_zone(zone) for zone in setting.problem.forbidden]]
    ends = list(End) if kind == "common grasp" else [cause.end]
    yield [
        [
            shifted(end, way, by)
            for end in ends
            if end is not None
            for way in _DIRECTIONS
        ]
        for by in _SHIFTS
    ]


def _ladders_of_grasping(setting: Setting, kind: Kind) -> Iterator[Ladder]:
    """Changes of the grasps, of the object and of the hand."""
    if kind == "grasp quality":
        yield [[any_quality(setting)]]
    if kind in _GRASPING:
        yield [list(other_families(setting))]
    if kind in ("hand", "hand opened"):
        yield [[slimmer_object(setting, by)] for by in _SLIMMER]
    if kind in ("collision", "hand opened", "common grasp"):
        yield [[narrower_hand(by)] for by in _NARROWER]
