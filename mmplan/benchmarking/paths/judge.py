"""What is found out about a path, whoever made it."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from mmplan.benchmarking.paths.arena import Arena
from mmplan.planning.sweep import sweep_of
from mmplan.shapes import Array
from mmplan.verification.ledger import Ledger
from mmplan.verification.path_proof import prove_path

RECHECK = 1.0 / 64.0  # rad
# How far (rad or m) the ends of a path may be from those asked for, and its joints
# beyond their limits: some planners compute with single precision.
TOLERANCE = 1e-5


class Judgement(NamedTuple):
    """What is wrong with a path, empty if nothing is, and its smallest clearance."""

    fault: str
    clearance: float | None  # m


def judge(arena: Arena, path: Array) -> Judgement:
    """Prove that a path (n, nq) goes from start to goal and touches nothing."""
    fault = _end_fault(arena, path) or _limit_fault(arena, path)
    proof = prove_path(arena.world, path)
    nearest = proof.nearest.distance if proof.nearest else None
    return Judgement(fault or _touch(proof), nearest)


def collides_when_rechecked(arena: Arena, path: Array) -> bool:
    """Whether a path (n, nq) collides at steps of `RECHECK`."""
    for q_from, q_to in pairwise(path):
        dq = q_to - q_from
        steps = int(np.ceil(np.linalg.norm(dq) / RECHECK))
        fractions = np.linspace(0.0, 1.0, steps + 1)[:, None]
        if arena.world.any_collision(q_from + fractions * dq):
            return True
    return False


def lengths(arena: Arena, path: Array) -> tuple[float, float]:
    """Lengths of a path (n, nq): in joint space (rad), and by lever arms (m)."""
    dq = np.diff(path, axis=0)
    weights = sweep_of(arena.world).weights
    ways = (np.linalg.norm(dq * scale, axis=1).sum() for scale in (1.0, weights))
    length, way = ways
    return float(length), float(way)


def _end_fault(arena: Arena, path: Array) -> str:
    for name, q, end in (
        ("start", path[0], arena.q_start),
        ("goal", path[-1], arena.q_goal),
    ):
        off = float(np.abs(q - end).max())
        if off > TOLERANCE:
            return f"the path's {name} is {off:.2g} off"
    return ""


def _limit_fault(arena: Arena, path: Array) -> str:
    joints = arena.joints
    q = path[:, joints.indices]
    beyond = np.maximum(joints.lower - q, q - joints.upper).max(axis=0)
    worst = int(np.argmax(beyond))
    if beyond[worst] <= TOLERANCE:
        return ""
    return f"{joints.names[worst]} goes {beyond[worst]:.2g} beyond its limit"


def _touch(proof: Ledger) -> str:
    """The first overlap that the proof met, or what it could not decide."""
    for findings, text in (
        (proof.overlaps, "overlap"),
        (proof.undecided, "could not be proven apart"),
    ):
        for finding in findings.values():
            return f"{finding.first} and {finding.second} {text}"
    return ""
