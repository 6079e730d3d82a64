"""Where the time of an edge goes: Python, the compiled search, coal.

    python benchmarks/edges.py [--problem cage/8 bookshelf_thin/6] [--seed 1]

Plans a path for problems of MotionBenchMaker, keeps every question that OMPL asks, and
asks them again in the order of layers: the whole question, what is left of it below
OMPL's states, and so on down to the compiled function. CPU microseconds a question, the
best of five rounds; needs the extra `fast`.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from ompl import base as ob

from mmplan.benchmarking.paths.arena import Arena, contestant, make_arena
from mmplan.benchmarking.paths.planning import own_planner
from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.planning import PathChecker, state_space
from mmplan.problem import PlannerSettings

PROBLEMS = Path(__file__).parent / "data" / "panda_motionbenchmaker.json.gz"
SETTINGS = PlannerSettings(range=0.5, motion_check="continuous", shortcuts=0)
ROUNDS = 5


class Recorder:
    """Keeps the states that OMPL asks about, and who answers."""

    def __init__(self) -> None:
        """Listen to the two classes that OMPL asks."""
        self.motions: list[tuple[list[float], list[float]]] = []
        self.states: list[list[float]] = []
        self.motion_checker: Any = None
        self.state_checker: Any = None
        motion, state = state_space.WorldMotions, state_space.WorldValidity
        check, valid = motion.checkMotion, state.isValid

        def check_motion(asked: Any, start: ob.State, end: ob.State) -> bool:
            if self.motion_checker in (None, asked):  # of the first search alone
                self.motion_checker = asked
                n = asked.answers.states._size
                self.motions.append((start[0:n], end[0:n]))
            return check(asked, start, end)

        def is_valid(asked: Any, q: ob.State) -> bool:
            if self.state_checker in (None, asked):
                self.state_checker = asked
                self.states.append(q[0 : asked.answers.states._size])
            return valid(asked, q)

        motion.checkMotion, state.isValid = check_motion, is_valid  # type: ignore[method-assign, assignment]
        self._undo = lambda: (
            setattr(motion, "checkMotion", check),
            setattr(state, "isValid", valid),
        )

    def stop(self) -> None:
        """Let the classes be as they were."""
        self._undo()


def main() -> None:
    """Print a table for each problem."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--problem", nargs="+", default=["cage/8", "bookshelf_thin/6"])
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    problems = {
        f"{p.family}/{p.number}": p for p in load_path_problems(PROBLEMS).problems
    }
    robot = contestant()
    print("| problem | question | asked | layer | us |")
    print("| --- | --- | --- | --- | --- |")
    for name in options.problem:
        arena = make_arena(robot, problems[name])
        asked = recorded(arena, options.seed)
        rows = [("edge", len(asked.motions), *row) for row in edge_layers(arena, asked)]
        rows += [("state", len(asked.states), *x) for x in state_layers(arena, asked)]
        for question, count, layer, seconds in rows:
            print(f"| {name} | {question} | {count} | {layer} | {1e6 * seconds:.1f} |")


def recorded(arena: Arena, seed: int) -> Recorder:
    """What the first search of a plan asks."""
    planner = own_planner("RRTConnect", SETTINGS)(arena)
    recorder = Recorder()
    planner.plan(seed)
    recorder.stop()
    return recorder


def edge_layers(arena: Arena, asked: Recorder) -> list[tuple[str, float]]:
    """Seconds a whole edge by layers, each within the one before."""
    checker: PathChecker = asked.motion_checker.answers.checker
    states = asked.motion_checker.answers.states
    pairs = [(_filled(a), _filled(b)) for a, b in asked.motions]
    ends = [(states.configuration(a), states.configuration(b)) for a, b in pairs]
    moves = [(q, q_next - q) for q, q_next in ends]
    steps = [(q, dq, int(checker.steps(dq))) for q, dq in moves]
    world = arena.world
    motions: Any = world._checker._motions
    return [
        ("OMPL's question", _each(asked.motion_checker.checkMotion, pairs)),
        ("of configurations", _each(checker.edge_free, ends)),
        ("of steps", _each(world.steps_collide, steps)),
        ("without coal", _each(motions.on_steps, steps)),
        ("compiled", _each(motions._follow, steps)),
    ]


def state_layers(arena: Arena, asked: Recorder) -> list[tuple[str, float]]:
    """The same for single states."""
    checker: PathChecker = asked.state_checker.answers.checker
    states = asked.state_checker.answers.states
    asked_states = [(_filled(values),) for values in asked.states]
    single = [(states.configuration(s)[None],) for (s,) in asked_states]
    motions: Any = arena.world._checker._motions
    return [
        ("OMPL's question", _each(asked.state_checker.isValid, asked_states)),
        ("of configurations", _each(checker.states_free, single)),
        ("compiled", _each(motions._likeliest, [(q, 0) for (q,) in single])),
    ]


def _each(ask: Callable[..., object], questions: Sequence[tuple[Any, ...]]) -> float:
    """CPU s a question, the best of some rounds over all."""
    best = np.inf
    for _ in range(ROUNDS):
        begin = time.process_time()
        for question in questions:
            ask(*question)
        best = min(best, time.process_time() - begin)
    return float(best) / len(questions)


_SPACES: dict[int, ob.RealVectorStateSpace] = {}


def _filled(values: list[float]) -> ob.State:
    """A state of a real space with these values."""
    space = _SPACES.setdefault(len(values), ob.RealVectorStateSpace(len(values)))
    state = space.allocState()
    for i, value in enumerate(values):
        state[i] = value
    return state


if __name__ == "__main__":
    main()
