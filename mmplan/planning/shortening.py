"""Shortening of paths, bounded by the number of attempts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mmplan.collision import planning_clock
from mmplan.planning.checking import PathChecker
from mmplan.planning.joints import MovingJoints
from mmplan.planning.metric import Metric
from mmplan.shapes import Array

# A shortcut is worth its checks if it saves more than this share of the path's length.
MIN_GAIN = 0.01


def shorten(
    path: Array,
    checker: PathChecker,
    joints: MovingJoints,
    attempts: int,
    rng: np.random.Generator,
    seconds: float = np.inf,
) -> Array:
    """A shorter path (m, nq) between the same ends, free where the given one is.

    First drops waypoints that are not needed. Then tries shortcuts between two random
    places, in turn of all joints and of one joint alone, the others going on as before
    (Geraerts and Overmars, "Creating high-quality paths for motion planning", 2007).
    Lengths are weighted by the joints' lever arms and costs. Joints that wrap may end
    whole turns from where they did. No attempt is begun after `seconds` of CPU time.
    """
    deadline = planning_clock() + seconds
    metric = Metric.of_joints(joints, checker.sweep.weights)
    path = drop_waypoints(path, checker, metric)
    moving = np.flatnonzero(np.ptp(path, axis=0))
    moving = np.intersect1d(moving, joints.indices)
    along = _lengths(path, metric.weights)
    for attempt in range(attempts):
        if len(path) == 2 or planning_clock() > deadline:  # 2: straight already
            break
        joint = int(rng.choice(moving)) if attempt % 2 else None
        places = sorted(rng.random(2).tolist())
        shorter = _try_shortcut(path, along, checker, joints, metric, places, joint)
        if shorter is not None:
            path, along = shorter, _lengths(shorter, metric.weights)
    return drop_waypoints(path, checker, metric)


def drop_waypoints(path: Array, checker: PathChecker, metric: Metric) -> Array:
    """The path less the waypoints that a straight edge can do without, greedily."""
    path = path.copy()
    kept = [0]
    while kept[-1] < len(path) - 1:
        here = kept[-1]
        q = path[here]
        ahead = range(len(path) - 1, here + 1, -1)
        near = ((i, path[i] + metric.turns(path[i], q)) for i in ahead)
        there = next((i for i, q_to in near if checker.edge_free(q, q_to)), here + 1)
        path[there:] += metric.turns(path[there], q)
        kept.append(there)
    return path[kept]


def path_length(path: Array, weights: Array) -> float:
    """The length of a polyline (n, nq), m, weighted by lever arms (nq,)."""
    return float(_edges(path, weights).sum())


def _edges(path: Array, weights: Array) -> Array:
    """The lengths of a polyline's edges, (n - 1,)."""
    lengths: Array = np.linalg.norm((path[1:] - path[:-1]) * weights, axis=1)
    return lengths


def _lengths(path: Array, weights: Array) -> Array:
    """How long a polyline (n, nq) is up to each waypoint, (n,)."""
    return np.concatenate([[0.0], np.cumsum(_edges(path, weights))])


def _try_shortcut(
    path: Array,
    along: Array,
    checker: PathChecker,
    joints: MovingJoints,
    metric: Metric,
    places: Sequence[float],
    joint: int | None,
) -> Array | None:
    """The path with a shortcut between two places in [0, 1], if that is shorter."""
    weights = metric.weights
    i, q_i = _place(path, along, places[0] * along[-1])
    j, q_j = _place(path, along, places[1] * along[-1])
    if i == j:
        return None
    old = np.vstack([q_i, path[i + 1 : j + 1], q_j])
    turns = metric.turns(q_j, q_i) if joint is None else np.zeros_like(q_j)
    new = np.vstack([q_i, q_j + turns])
    if joint is not None:
        new = joints.with_followers(_straightened(old, weights, joint))
    if path_length(old, weights) - path_length(new, weights) < MIN_GAIN * along[-1]:
        return None
    if not checker.path_free(new):
        return None
    return np.vstack([path[: i + 1], new, path[j + 1 :] + turns])


def _place(path: Array, along: Array, length: float) -> tuple[int, Array]:
    """The edge at a length along the path, and the configuration there."""
    edge = min(max(int(along.searchsorted(length)) - 1, 0), len(path) - 2)
    step = along[edge + 1] - along[edge]
    fraction = (length - along[edge]) / step if step > 0.0 else 0.0
    q: Array = path[edge] + fraction * (path[edge + 1] - path[edge])
    return edge, q


def _straightened(part: Array, weights: Array, joint: int) -> Array:
    """Part of a path (n, nq) with one joint moving evenly from end to end."""
    along = _lengths(part, weights)
    along /= along[-1]
    part = part.copy()
    part[:, joint] = part[0, joint] + along * (part[-1, joint] - part[0, joint])
    return part
