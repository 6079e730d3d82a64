"""Where the time of an edge goes: Python, the compiled search, coal.

    python benchmarks/edges.py [--problem cage/8 bookshelf_thin/6] [--seed 1]

Plans a path for problems of MotionBenchMaker, keeps every question that OMPL asks, and
asks them again in the order of layers: the whole question, what is left of it once
OMPL's states are lists of coordinates, and the compiled function alone. CPU
microseconds a question, the best of five rounds; needs the extra `fast`.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, TypeAlias
from unittest.mock import patch

import numpy as np
from ompl import base as ob

from mmplan.benchmarking.paths.arena import Arena, contestant, make_arena
from mmplan.benchmarking.paths.planning import own_planner
from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.collision import kernels
from mmplan.planning.state_space import Answers
from mmplan.problem import PlannerSettings

PROBLEMS = Path(__file__).parent / "data" / "panda_motionbenchmaker.json.gz"
SETTINGS = PlannerSettings(range=0.5, motion_check="continuous", shortcuts=0)
ROUNDS = 5


class Recorder:
    """Keeps the states that OMPL asks about, and who answers for the first search."""

    def __init__(self) -> None:
        """Listen to those who answer."""
        self.motions: list[tuple[list[float], list[float]]] = []
        self.states: list[list[float]] = []
        self.answers: Any = None
        edge_free, state_free = Answers.edge_free, Answers.state_free

        def on_edge(asked: Answers, start: ob.State, end: ob.State) -> bool:
            if self._listens_to(asked):
                n = asked.states._size
                self.motions.append((start[0:n], end[0:n]))
            return edge_free(asked, start, end)

        def on_state(asked: Answers, state: ob.State) -> bool:
            if self._listens_to(asked):
                self.states.append(state[0 : asked.states._size])
            return state_free(asked, state)

        self._listening = ExitStack()
        for name, listening in (("edge_free", on_edge), ("state_free", on_state)):
            self._listening.enter_context(patch.object(Answers, name, listening))

    def _listens_to(self, asked: Answers) -> bool:
        self.answers = self.answers or asked
        return self.answers is asked

    def stop(self) -> None:
        """Let the classes be as they were."""
        self._listening.close()


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
        for question, count, layer, seconds in edge_layers(asked) + state_layers(asked):
            print(f"| {name} | {question} | {count} | {layer} | {1e6 * seconds:.1f} |")


def recorded(arena: Arena, seed: int) -> Recorder:
    """What the first search of a plan asks."""
    planner = own_planner("RRTConnect", SETTINGS)(arena)
    recorder = Recorder()
    planner.plan(seed)
    recorder.stop()
    return recorder


Row: TypeAlias = tuple[str, int, str, float]


def edge_layers(asked: Recorder) -> list[Row]:
    """Seconds a whole edge by layers, each within the one before.

    Edges that compiled code settles, and those that are left to coal.
    """
    answers, quick = asked.answers, _quick(asked)
    states = answers.states
    pairs = [(_filled(a), _filled(b)) for a, b in asked.motions]
    ends = [(states.coordinates(a) + states.coordinates(b),) for a, b in pairs]
    known = (quick._places, quick._rows, quick._followers, quick._resolution)
    room = (quick._q, quick._dq, *quick._broadphase.known)
    arrays = [(np.array(*both), *known, *room) for both in ends]
    found = [kernels.check_edge(*array) for array in arrays]
    settled = [k for k, count in enumerate(found) if count <= 0]
    left = [k for k, count in enumerate(found) if count > 0]
    one, other = "edge", "edge left to coal"
    return [
        (
            one,
            len(settled),
            *_layer("OMPL's question", answers.edge_free, pairs, settled),
        ),
        (
            one,
            len(settled),
            *_layer("from coordinates on", quick.edge_free, ends, settled),
        ),
        (one, len(settled), *_layer("compiled", kernels.check_edge, arrays, settled)),
        (
            other,
            len(left),
            *_layer("OMPL's question", answers.edge_free, pairs, left),
        ),
        (other, len(left), *_layer("from coordinates on", quick.edge_free, ends, left)),
        (other, len(left), *_layer("compiled", kernels.check_edge, arrays, left)),
    ]


def state_layers(asked: Recorder) -> list[Row]:
    """The same for single states, all of them."""
    answers, quick = asked.answers, _quick(asked)
    states = [(_filled(values),) for values in asked.states]
    points = [(answers.states.coordinates(state),) for (state,) in states]
    known = (quick._places, quick._rows, quick._followers, quick._row)
    arrays = [(np.array(*p), *known, *quick._broadphase.known) for p in points]
    count = len(states)
    return [
        ("state", count, "OMPL's question", _each(answers.state_free, states)),
        ("state", count, "from coordinates on", _each(quick.state_free, points)),
        ("state", count, "compiled", _each(kernels.check_state, arrays)),
    ]


def _quick(asked: Recorder) -> Any:
    """The compiled answers, which there are after the first question."""
    asked.answers.state_free(_filled(asked.states[0]))
    return asked.answers._quick


def _layer(
    name: str,
    ask: Callable[..., object],
    questions: Sequence[tuple[Any, ...]],
    chosen: Sequence[int],
) -> tuple[str, float]:
    return name, _each(ask, [questions[k] for k in chosen])


def _each(ask: Callable[..., object], questions: Sequence[tuple[Any, ...]]) -> float:
    """CPU s a question, the best of some rounds over all."""
    if not questions:
        return np.nan
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
