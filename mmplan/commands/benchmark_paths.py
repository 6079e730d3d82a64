"""`mmplan benchmark paths`: path planners on problems that others made."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan.commands.arguments import (
    above_zero,
    add_json,
    add_quiet,
    add_results_folder,
    listed,
    natural,
    positive,
)
from mmplan.commands.results import SOLVED, print_json

if TYPE_CHECKING:
    from mmplan.benchmarking.paths.report import PathReport

# What stands in argv for the one name `benchmark paths`.
PATHS = ("benchmark", "paths")

# Options that are settings of the planner, which has defaults of its own.
_SETTINGS = ("range", "motion_check", "resolution", "shortcuts", "time_limit")


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "run OMPL's planners against each other on path problems in a file"
    run = commands.add_parser(
        " ".join(PATHS),
        prog=f"mmplan {' '.join(PATHS)}",
        help=text,
        description=f"{text}; a benchmark that was interrupted goes on where it was.",
    )
    run.add_argument("problems", type=Path, metavar="FILE", help=".json or .json.gz")
    add_results_folder(run)
    add_choice(run)
    _add_settings(run)
    add_json(run)
    add_quiet(run)
    run.set_defaults(run=_run)


def add_choice(run: argparse.ArgumentParser) -> None:
    """Add the options that say which planners, problems and seeds."""
    run.add_argument(
        "--planners",
        type=listed(str),
        metavar="NAMES",
        default=["RRTConnect"],
        help="OMPL planners, separated by commas; default: RRTConnect",
    )
    run.add_argument("--runs", type=positive, default=20, help="seeds; default: 20")
    run.add_argument(
        "--seed", type=natural, default=0, help="the first seed; default: 0"
    )
    run.add_argument(
        "--families",
        type=listed(str),
        metavar="NAMES",
        default=[],
        help="only these, separated by commas; default: all",
    )
    run.add_argument(
        "--robot",
        default="panda",
        help="a robot that is shipped or a robot.yaml; default: panda, which stands "
        "still where the world begins",
    )
    run.add_argument(
        "--hand",
        type=listed(float),
        metavar="POSITIONS",
        help="of the hand's joints (m or rad), separated by commas; default: open",
    )


def _add_settings(run: argparse.ArgumentParser) -> None:
    run.add_argument(
        "--range",
        type=above_zero,
        default=0.4,
        metavar="M",
        help="the longest edge of the planner; default: 0.4",
    )
    run.add_argument(
        "--motion-check",
        choices=("sampled", "continuous"),
        default="continuous",
        help="how edges are checked; default: continuous",
    )
    run.add_argument(
        "--resolution",
        type=above_zero,
        metavar="M",
        help="the longest way of any point of the robot between two checks; default: "
        "that of scenes",
    )
    run.add_argument(
        "--shortcuts",
        type=natural,
        metavar="N",
        help="attempts at shortening a path; default: that of scenes",
    )
    run.add_argument(
        "--time-limit",
        type=above_zero,
        default=30.0,
        metavar="S",
        help="for one path; default: 30",
    )


def _run(options: argparse.Namespace) -> int:
    from mmplan.benchmarking.paths.arena import contestant
    from mmplan.benchmarking.paths.benchmark import own_competitor, run_path_benchmark
    from mmplan.benchmarking.paths.problems import load_path_problems
    from mmplan.benchmarking.paths.report import write_path_report
    from mmplan.problem import PlannerSettings
    from mmplan.terminal import progress_display, show

    given = {
        key: value for key in _SETTINGS if (value := getattr(options, key)) is not None
    }
    settings = PlannerSettings(**given)
    competitors = [own_competitor(name, settings) for name in options.planners]
    with progress_display(quiet=options.quiet) as progress:
        outcome = run_path_benchmark(
            load_path_problems(options.problems),
            contestant(options.robot, options.hand),
            competitors,
            options.output,
            runs=options.runs,
            first_seed=options.seed,
            families=options.families,
            progress=partial(progress, "runs") if progress is not None else None,
        )
    report = write_path_report(options.output)
    if options.json:
        print_json({**vars(outcome), **_values(report)})
    elif not options.quiet:
        show(str(outcome), *_lines(report))
    return SOLVED


def show_report(folder: Path, *, as_json: bool) -> int:
    """Write the report of a folder anew, and show it."""
    from mmplan.benchmarking.paths.report import write_path_report
    from mmplan.terminal import show

    report = write_path_report(folder)
    if as_json:
        print_json(_values(report))
    else:
        show(*_lines(report))
    return SOLVED


def _values(report: PathReport) -> dict[str, Any]:
    """The report for programs."""
    return {
        "page": str(report.page),
        "logs": [str(path) for path in report.logs],
        "tables": [
            {"title": t.title, "header": t.header, "rows": t.rows}
            for t in report.tables
        ],
    }


def _lines(report: PathReport) -> list[str]:
    """The report for people."""
    return [*(table.text() for table in report.tables), f"written to {report.page}"]
