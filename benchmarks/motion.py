"""What shortening, rounding and timing make of first paths; what limits of torque cost.

    python benchmarks/motion.py [--problems 3] [--peer-python PYTHON]
    python benchmarks/motion.py --torque [xarm7_lab=1.6 ...]

The first takes problems of MotionBenchMaker's Panda (so many of each family), lets
RRTConnect find a first path in each, and tells its length before and after shortening,
the duration of the motion along either, and the CPU time of both steps. With the Python
of an environment in which `roboplan` is installed, roboplan finds the first paths and
shortens them, and mmplan shortens the same ones; all are timed by mmplan and by
roboplan, with the same limits. roboplan's splines are not checked for collision.

The second solves scenes with and without limits of torque, with an object of that many
kg (1 where nothing is said), and tells durations and the largest share of a limit.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import astuple, dataclass, replace
from itertools import groupby
from pathlib import Path

import numpy as np
from peers.process import Process
from peers.world import describe

import mmplan
from mmplan.benchmarking.paths.arena import Arena, contestant, make_arena
from mmplan.benchmarking.paths.planning import own_planner
from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.benchmarking.paths.records import Answer
from mmplan.planning import PathChecker, motion_limits, time_path
from mmplan.planning.shortening import path_length, shorten
from mmplan.problem import PlannerSettings, Problem
from mmplan.shapes import Array

PROBLEMS = Path(__file__).parent / "data" / "panda_motionbenchmaker.json.gz"
SETTINGS = PlannerSettings(time_limit=30.0)
SCENES = ("panda_fixed=1", "panda_bin=1", "ur5_machine_tending=1", "xarm7_lab=1")


@dataclass(frozen=True)
class Made:
    """A path as one of the ways of making it has it."""

    way: str
    length: float  # m, weighted by lever arms
    radians: float
    duration: float  # s, NaN where it cannot be timed
    elsewhere: float  # s, by roboplan's timing, NaN where there is none
    shortening: float  # CPU s
    timing: float  # CPU s


def main() -> None:
    """Print one of the two tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--problems", type=int, default=3, help="of each family")
    parser.add_argument("--peer-python", help="with roboplan installed")
    parser.add_argument("--torque", nargs="*", metavar="SCENE=KG")
    options = parser.parse_args()
    if options.torque is not None:
        _torque_table(options.torque or list(SCENES))
    else:
        _path_table(list(_all_made(options.problems, options.peer_python)))


def _all_made(problems: int, python: str | None) -> Iterator[Made]:
    robot = contestant()
    every = load_path_problems(PROBLEMS).problems
    chosen = [
        problem
        for _, family in groupby(every, key=lambda p: p.family)
        for problem in list(family)[:problems]
    ]
    with tempfile.TemporaryDirectory() as folder:
        if python is None:
            for problem in chosen:
                arena = make_arena(robot, problem)
                answer = own_planner("RRTConnect", SETTINGS)(arena).plan(0)
                yield from _made(arena, answer, None)
            return
        with closing(_Peer(python, Path(folder))) as peer:
            for problem in chosen:
                arena = make_arena(robot, problem)
                answer = peer.plan(arena)
                yield from _made(arena, answer, peer)


class _Peer:
    """roboplan in processes of its own."""

    def __init__(self, python: str, folder: Path) -> None:
        self._python, self._folder = python, folder
        self._process = Process("roboplan", python, folder)

    def plan(self, arena: Arena) -> Answer:
        return self._process.prepare(arena, 1.0 / 32.0, 1.0, 30.0).plan(0)

    def durations(self, arena: Arena, paths: list[Array]) -> list[float]:
        """How long (s) motions take by its timing, NaN where it has none."""
        moving = arena.joints.indices
        request = {
            "world": describe(arena, self._folder),
            "acceleration": motion_limits(arena.world.robot)
            .acceleration[moving]
            .tolist(),
            "paths": [path[:, moving].tolist() for path in paths],
        }
        script = Path(__file__).parent / "peers" / "roboplan_timing.py"
        ran = subprocess.run(
            [self._python, str(script)],
            input=json.dumps(request),
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        found = [timed["duration"] for timed in json.loads(ran.stdout)]
        return [np.nan if duration is None else duration for duration in found]

    def close(self) -> None:
        self._process.end()


def _made(arena: Arena, answer: Answer, peer: _Peer | None) -> Iterator[Made]:
    """The paths of an answer, and mmplan's from the first path of a peer."""
    if answer.first is None or answer.path is None:
        print(f"{arena.problem.family} {arena.problem.number}: {answer.message}")
        return
    spent = (answer.seconds or 0.0) - answer.first_seconds
    paths = {"first": (answer.first, 0.0), "shortened": (answer.path, spent)}
    if peer is not None:
        checker = PathChecker(arena.world, SETTINGS.resolution)
        begin, rng = time.process_time(), np.random.default_rng(0)
        own = shorten(answer.first, checker, arena.joints, SETTINGS.shortcuts, rng)
        spent_here = time.process_time() - begin
        paths = {
            "roboplan's first": (answer.first, 0.0),
            "roboplan's shortcuts": (answer.path, spent),
            "mmplan's shortening of the first": (own, spent_here),
        }
    elsewhere = [np.nan] * len(paths)
    if peer is not None:
        elsewhere = peer.durations(arena, [path for path, _ in paths.values()])
    for (way, (path, seconds)), other in zip(paths.items(), elsewhere, strict=True):
        yield _timed(arena, way, path, seconds, other)


def _timed(
    arena: Arena, way: str, path: Array, shortening: float, elsewhere: float
) -> Made:
    weights = PathChecker(arena.world, SETTINGS.resolution).sweep.weights
    limits = motion_limits(arena.world.robot)
    begin = time.process_time()
    motion = time_path(arena.world, path, limits, SETTINGS.resolution).motion
    return Made(
        way=way,
        length=path_length(path, weights),
        radians=float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()),
        duration=np.nan if motion is None else motion.duration,
        elsewhere=elsewhere,
        shortening=shortening,
        timing=time.process_time() - begin,
    )


def _path_table(made: list[Made]) -> None:
    """Medians of each way of making paths, over those that mmplan can time in all."""
    ways = list(dict.fromkeys(m.way for m in made))
    rows = np.array([[*astuple(m)[1:]] for m in made]).reshape(-1, len(ways), 6)
    timed = np.isfinite(rows[:, :, 2]).all(axis=1)
    print(f"{len(rows)} problems; medians over {timed.sum()}, timed in every row")
    print(
        "| path | length rad | m | duration s | by roboplan's timing s | "
        "shortening CPU ms | timing CPU ms | not timed |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for k, way in enumerate(ways):
        length, radians, duration, elsewhere, *cpu = np.median(rows[timed, k], axis=0)
        other = "" if np.isnan(elsewhere) else f"{elsewhere:.2f}"
        lost = int(np.isnan(rows[:, k, 2]).sum())
        print(
            f"| {way} | {radians:.2f} | {length:.2f} | {duration:.2f} | {other} | "
            f"{cpu[0] * 1e3:.0f} | {cpu[1] * 1e3:.0f} | {lost} |"
        )


def _torque_table(scenes: list[str]) -> None:
    print(
        "| scene | object kg | motion s | with torque limits | largest share, where |"
    )
    print("|---|---|---|---|---|")
    for scene in scenes:
        name, _, mass = scene.partition("=")
        problem = _with_mass(mmplan.load_problem(name), float(mass or 1.0))
        free = mmplan.solve(problem, seed=0)
        limited = replace(problem, planner=replace(problem.planner, torque=True))
        plan = mmplan.solve(limited, seed=0)
        assert plan.verification is not None
        peak = max(plan.verification.peaks, key=lambda p: p.largest)
        print(
            f"| {name} | {mass or 1} | {free.duration:.2f} | {plan.duration:.2f} | "
            f"{peak.largest:.1%}, {peak.segment} |",
            flush=True,
        )


def _with_mass(problem: Problem, mass: float) -> Problem:
    objects = tuple(replace(item, mass=mass) for item in problem.objects)
    return replace(problem, objects=objects, tasks=problem.tasks[:1])


if __name__ == "__main__":
    try:
        main()
    except mmplan.MmplanError as error:
        sys.exit(f"motion.py: {error}")
