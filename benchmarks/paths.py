"""Path planners side by side on problems that others made.

    python benchmarks/paths.py [FILE] [-o results/] [--runs 20]
        [--peers naive,roboplan,...] [--families cage,box]
        [--peer-python roboplan=/path/to/python ...]

Peers other than `naive` are libraries that need not go together with mmplan's: each
runs in a process of its own, with the Python given for it or else this one, and tells
CPU times measured in there. All get the same problems, the same bodies of robot and
obstacles, a step of 1/32 rad between two checks and edges of at most 1 rad, where they
let these be set. Preparing a world is measured on its own. Every path, whoever made
it, is judged as `mmplan benchmark paths` does, and goes into the same store: a run
that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

from peers import naive
from peers.process import Process

from mmplan.benchmarking.paths.arena import PANDA, contestant
from mmplan.benchmarking.paths.benchmark import (
    Competitor,
    own_competitor,
    run_path_benchmark,
)
from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.benchmarking.paths.report import write_path_report
from mmplan.exceptions import MmplanError
from mmplan.problem import PlannerSettings
from mmplan.terminal import progress_display

PROBLEMS = Path(__file__).parent / "data" / "panda_motionbenchmaker.json.gz"
PEERS = ("naive", "roboplan", "mplib", "sscbirrt")
STEP = 1.0 / 32.0  # rad, between two checks
REACH = 1.0  # rad, the longest edge
TIME_LIMIT = 120.0  # s


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what is missing and print the tables."""
    options = _parser().parse_args(arguments)
    robot = contestant(options.robot)
    settings = PlannerSettings(time_limit=TIME_LIMIT)
    given = {k: getattr(options, k) for k in ("resolution", "range", "motion_check")}
    settings = replace(settings, **{k: v for k, v in given.items() if v is not None})
    competitors = [own_competitor(name, settings) for name in options.planners]
    with (
        ExitStack() as stack,
        tempfile.TemporaryDirectory() as folder,
        progress_display(quiet=not sys.stderr.isatty()) as progress,
    ):
        for name in options.peers:
            python = dict(options.peer_python).get(name, sys.executable)
            competitors.append(_peer(name, python, Path(folder), stack))
        output = options.output or Path(folder) / "results"
        run_path_benchmark(
            load_path_problems(options.problems),
            robot,
            competitors,
            output,
            runs=options.runs,
            families=options.families,
            progress=partial(progress, "runs") if progress is not None else None,
        )
        for table in write_path_report(output).tables:
            print(table.markdown())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problems", nargs="?", type=Path, default=PROBLEMS)
    parser.add_argument("-o", "--output", type=Path, help="default: kept nowhere")
    parser.add_argument("--robot", default=PANDA)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--families", type=_names, default=[])
    parser.add_argument("--planners", type=_names, default=["RRTConnect"])
    parser.add_argument("--resolution", type=float, metavar="M", help="of mmplan's")
    parser.add_argument(
        "--range", type=float, default=0.4, metavar="M", help="of mmplan's"
    )
    checks = ("sampled", "continuous")
    parser.add_argument("--motion-check", choices=checks, default=checks[1])
    parser.add_argument("--peers", type=_peers, default=["naive"])
    parser.add_argument(
        "--peer-python",
        nargs="+",
        type=_assignment,
        default=[],
        metavar="PEER=PYTHON",
    )
    return parser


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _peers(text: str) -> list[str]:
    names = _names(text)
    unknown = [name for name in names if name not in PEERS]
    if unknown:
        raise argparse.ArgumentTypeError(
            f"no peer '{unknown[0]}'; there are {', '.join(PEERS)}"
        )
    return names


def _assignment(text: str) -> tuple[str, str]:
    name, _, python = text.partition("=")
    if name not in PEERS or not python:
        raise argparse.ArgumentTypeError(f"expected PEER=PYTHON, got '{text}'")
    return name, python


def _peer(name: str, python: str, folder: Path, stack: ExitStack) -> Competitor:
    settings = {"step": STEP, "reach": REACH, "time_limit": TIME_LIMIT}
    prepare = naive.prepare
    if name != "naive":
        process = Process(name, python, folder)
        stack.callback(process.end)
        prepare = process.prepare
    return Competitor(name, lambda arena: prepare(arena, **settings), settings)


if __name__ == "__main__":
    try:
        main()
    except MmplanError as error:
        sys.exit(f"paths.py: {error}")
