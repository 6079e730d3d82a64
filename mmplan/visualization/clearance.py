"""How near things come that must stay apart, along a plan."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mmplan.collision import CollisionWorld
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.replay import Stage, replay
from mmplan.shapes import Array
from mmplan.verification.bodies import Bodies, Indices
from mmplan.verification.moments import Moments
from mmplan.verification.touching import TouchRule
from mmplan.visualization.film import Film

# Moments a second at which the clearance is computed.
_RATE = 12.0


@dataclass(frozen=True, eq=False)
class ClearanceCurve:
    """The clearance at n times, and the two things that are nearest then.

    What may touch, as fingers may the object that they hold, does not count.
    """

    times: Array  # (n,), s
    distances: Array  # (n,), m
    pairs: tuple[tuple[str, str], ...]  # (n,)


def clearance_curve(
    problem: Problem, plan: Plan, film: Film, check: Callable[[], None] | None = None
) -> ClearanceCurve:
    """The clearance along a plan's film.

    `check` is called now and then, and may raise to end this.
    """
    stages = list(replay(problem, plan.tasks))
    step = max(1, round((len(film.times) - 1) / (film.duration * _RATE)))
    rows = np.arange(0, len(film.times), step)
    starts = np.array([mark.start for mark in film.marks])
    which = np.searchsorted(starts, film.times[rows], side="right") - 1
    distances = np.full(len(rows), np.inf)
    pairs = [("", "")] * len(rows)
    for number in np.unique(which).tolist():
        if check is not None:
            check()
        mine = np.flatnonzero(which == number)
        found = _stage_clearances(problem, stages[number], film.q[rows[mine]])
        for place, (distance, pair) in zip(mine.tolist(), found, strict=True):
            distances[place], pairs[place] = distance, pair
    return ClearanceCurve(film.times[rows], distances, tuple(pairs))


def _stage_clearances(
    problem: Problem, stage: Stage, q: Array
) -> Sequence[tuple[float, tuple[str, str]]]:
    """The clearance at each configuration (n, nq) of a segment."""
    bodies = Bodies(_world(problem, stage), np.abs(q).max(axis=0))
    rule, moments = TouchRule.of_stage(stage, bodies), Moments(bodies, q)
    pair = np.arange(len(bodies.world.pairs))
    found = []
    for moment in range(len(q)):
        now = np.full(len(pair), moment)
        allowed, _ = rule.allowances(moments.T_world_joint, np.zeros_like(q), now, pair)
        apart = np.flatnonzero(allowed == 0.0)
        found.append(_nearest(bodies, moments, moment, apart))
    return found


def _world(problem: Problem, stage: Stage) -> CollisionWorld:
    """The world during a segment, with no touch permitted."""
    world = CollisionWorld.of_problem(problem)
    for name, T_world_object in stage.standing.items():
        world = world.place(name, T_world_object)
    for name, T_tool_object in stage.attached.items():
        world = world.attach(name, T_tool_object).forbid_touch(name)
    return world


def _nearest(
    bodies: Bodies, moments: Moments, moment: int, pair: Indices
) -> tuple[float, tuple[str, str]]:
    """The least exact distance of some pairs, those of the least bounds first."""
    first, second = bodies.world.pairs[pair].T
    now = np.full(len(pair), moment)
    rough = moments.sphere_gaps(now, first, second)
    few = np.argsort(rough)[:_FEW]
    rough[few] = moments.box_gaps(now[few], first[few], second[few])
    order = np.argsort(rough)
    exact = moments.distances(now, first[order], second[order])
    best, names = np.inf, ("", "")
    for place in order.tolist():
        if rough[place] >= best:
            break
        distance = next(exact)
        if distance < best:
            best = distance
            names = (bodies.owners[first[place]], bodies.owners[second[place]])
    return best, names


# Pairs whose boxes are looked at as well as their spheres.
_FEW = 400
