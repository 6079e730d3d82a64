"""`mmplan benchmark` and `mmplan benchmark report`: contests, at equal budgets."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

from mmplan.commands import benchmark_paths
from mmplan.commands.arguments import (
    add_json,
    add_quiet,
    add_results_folder,
    listed,
    natural,
    positive,
)
from mmplan.commands.results import SOLVED, print_json

REPORT = ("benchmark", "report")
# What stands in argv for one name each.
TWO_WORDS = (REPORT, benchmark_paths.PATHS)


def add(commands: Any) -> None:
    """Add the commands to the parser's."""
    text = "run optimizers against each other on the same seeds and budgets"
    run = commands.add_parser(
        "benchmark",
        help=text,
        description=f"{text}; a benchmark that was interrupted goes on where it was.",
    )
    run.add_argument("scenes", nargs="+", metavar="scene", help="scene files or names")
    add_results_folder(run)
    _add_contest(run)
    _add_scheduler(run)
    add_json(run)
    add_quiet(run)
    run.set_defaults(run=_run)
    benchmark_paths.add(commands)
    _add_report(commands)


def _add_contest(run: argparse.ArgumentParser) -> None:
    run.add_argument("--runs", type=positive, default=200, help="seeds; default: 200")
    run.add_argument(
        "--seed", type=natural, default=0, help="the first seed; default: 0"
    )
    run.add_argument(
        "--optimizers",
        type=listed(str),
        metavar="NAMES",
        default=["coevolution", "random"],
        help="separated by commas; default: coevolution,random",
    )
    run.add_argument(
        "--evaluations",
        type=listed(positive),
        metavar="N",
        default=[],
        help="score evaluations, or several budgets separated by commas; default: "
        "the scene's, which is the paper's 6940 where it says nothing",
    )
    run.add_argument(
        "--plan", action="store_true", help="plan and verify the motions too"
    )
    run.add_argument(
        "--planners",
        type=listed(str),
        metavar="NAMES",
        help="OMPL planners, separated by commas, for --plan; default: RRTConnect",
    )


def _add_scheduler(run: argparse.ArgumentParser) -> None:
    where = run.add_mutually_exclusive_group()
    where.add_argument(
        "--jobs", type=positive, default=1, help="local processes; default: 1"
    )
    where.add_argument(
        "--scheduler", metavar="ADDRESS", help="a Dask scheduler: tcp://host:8786"
    )


def _add_report(commands: Any) -> None:
    text = "tables, pictures and OMPL logs of a benchmark, and one page with all"
    report = commands.add_parser(
        " ".join(REPORT), prog=f"mmplan {' '.join(REPORT)}", help=text, description=text
    )
    report.add_argument("folder", type=Path, help="the folder of the results")
    add_json(report)
    report.set_defaults(run=_report)


def _run(options: argparse.Namespace) -> int:
    from mmplan.benchmarking.benchmark import run_benchmark, scheduler_of
    from mmplan.terminal import progress_display, show

    with progress_display(quiet=options.quiet) as progress:
        outcome = run_benchmark(
            options.scenes,
            options.output,
            optimizers=options.optimizers,
            runs=options.runs,
            first_seed=options.seed,
            evaluations=options.evaluations,
            planners=options.planners or (["RRTConnect"] if options.plan else []),
            scheduler=scheduler_of(options.jobs, options.scheduler),
            progress=partial(progress, "runs") if progress is not None else None,
        )
    if options.json:
        print_json(vars(outcome))
    elif not options.quiet:
        show(str(outcome), f"mmplan benchmark report {options.output}")
    return SOLVED


def _report(options: argparse.Namespace) -> int:
    from mmplan.benchmarking import write_report
    from mmplan.benchmarking.paths.report import holds_paths
    from mmplan.terminal import show

    if holds_paths(options.folder):
        return benchmark_paths.show_report(options.folder, as_json=options.json)
    report = write_report(options.folder)
    if options.json:
        print_json(
            {
                "page": str(report.page),
                "figures": [str(path) for path in report.figures],
                "logs": [str(path) for path in report.logs],
                "tables": [
                    {"title": t.title, "header": t.header, "rows": t.rows}
                    for t in report.tables
                ],
            }
        )
    else:
        short = [table.text() for table in report.tables if not table.detailed]
        show(*short, f"written to {report.page}")
    return SOLVED
