"""Planners side by side on path problems that others made, in one process.

    python benchmarks/paths.py [--runs 1] [--peers naive] [--families cage box]

Times are CPU ms to the first path and after shortening: median / 95th percentile over
problems and runs. Building the world is not counted. Every path, whoever made it, is
checked continuously by mmplan's verifier (`valid`) and at steps of 1/64 rad (`1/64`:
how many collide there).
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from peers.naive import Naive

from mmplan.benchmarking.paths.arena import Arena, make_arena, panda
from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.planning import plan_path
from mmplan.problem import PlannerSettings
from mmplan.shapes import Array
from mmplan.verification.path_proof import prove_path

PROBLEMS = Path(__file__).parent / "data" / "panda_motionbenchmaker.json.gz"
STEP = 1.0 / 32.0  # rad, between two checks
RANGE = 1.0  # rad, the longest edge
TIME_LIMIT = 30.0  # s


class Answer(NamedTuple):
    """What came of one run."""

    planner: str
    family: str
    first: Array | None  # (n, nq)
    path: Array | None  # shortened
    first_seconds: float
    seconds: float
    states: int


def main() -> None:
    """Print a table for each family and one for all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("problems", nargs="?", type=Path, default=PROBLEMS)
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--families", nargs="+")
    parser.add_argument("--planners", nargs="+", default=["RRTConnect"])
    parser.add_argument("--peers", nargs="*", default=["naive"])
    parser.add_argument("--resolution", type=float, default=0.01)
    options = parser.parse_args()
    robot = panda()
    rows: dict[tuple[str, str], list[tuple[Answer, bool, bool]]] = {}
    for problem in load_path_problems(options.problems):
        if options.families and problem.family not in options.families:
            continue
        arena = make_arena(robot, problem)
        arena.world.any_collision(arena.q_start[None])  # makes the checker
        planners = {n: _mmplan(arena, n, options.resolution) for n in options.planners}
        if "naive" in options.peers:
            planners["naive"] = _naive(arena)
        for seed in range(options.runs):
            for name, plan in planners.items():
                answer = Answer(name, problem.family, *plan(seed))
                found = answer.path is not None
                valid = found and _valid(arena, answer)
                hit = found and _collides(arena, answer.first)
                for family in (problem.family, "all"):
                    rows.setdefault((family, name), []).append((answer, valid, hit))
    print(
        "| family | planner | solved | valid | of | first ms | short ms | first rad | "
        "short rad | 1/64 | states |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for (family, name), answers in sorted(rows.items()):
        print(f"| {family} | {name} | {_cells(answers)} |")


def _mmplan(arena: Arena, name: str, resolution: float) -> Callable[[int], tuple]:
    def plan(seed: int) -> tuple:
        settings = PlannerSettings(
            name=name, resolution=resolution, iterations=10**9, time_limit=TIME_LIMIT
        )
        rng = np.random.default_rng(seed)
        begin = time.process_time()
        found = plan_path(
            arena.world, arena.q_start, arena.q_goal, arena.joints, settings, rng
        )
        spent = time.process_time() - begin
        first = found.path if found.first is None else found.first
        return first, found.path, spent - found.shortening, spent, found.states

    return plan


def _naive(arena: Arena) -> Callable[[int], tuple]:
    joints = arena.joints
    planner = Naive(
        arena.world.model,
        arena.world.geometry,
        joints.indices,
        joints.lower,
        joints.upper,
        STEP,
        RANGE,
    )

    def plan(seed: int) -> tuple:
        found = planner.plan(arena.q_start, arena.q_goal, TIME_LIMIT, seed + 1)
        return found.path, found.path, found.seconds, math.nan, found.states

    return plan


def _valid(arena: Arena, answer: Answer) -> bool:
    for path in (answer.first, answer.path):
        proof = prove_path(arena.world, path)
        if proof.overlaps or proof.undecided:
            return False
    return True


def _collides(arena: Arena, path: Array) -> bool:
    """Whether a path (n, nq) collides at steps of 1/64 rad."""
    for q_from, q_to in pairwise(path):
        steps = max(1, math.ceil(64.0 * float(np.linalg.norm(q_to - q_from))))
        q = q_from + np.linspace(0.0, 1.0, steps + 1)[:, None] * (q_to - q_from)
        if arena.world.any_collision(q):
            return True
    return False


def _cells(answers: list[tuple[Answer, bool, bool]]) -> str:
    found = [a for a, _, _ in answers if a.path is not None]
    valid, hits = sum(v for _, v, _ in answers), sum(h for _, _, h in answers)
    first = 1e3 * np.percentile([a.first_seconds for a in found], [50, 95])
    short = 1e3 * np.percentile([a.seconds for a in found], [50, 95])
    lengths = [
        np.median([_length(p) for p in ps])
        for ps in ([a.first for a in found], [a.path for a in found])
    ]
    states = np.median([a.states for a in found])
    return (
        f"{len(found)} | {valid} | {len(answers)} | {first[0]:.1f} / {first[1]:.1f} | "
        f"{short[0]:.1f} / {short[1]:.1f} | {lengths[0]:.1f} | {lengths[1]:.1f} | "
        f"{hits} | {states:.0f}"
    )


def _length(path: Array) -> float:
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


if __name__ == "__main__":
    main()
