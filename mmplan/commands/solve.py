"""`mmplan solve`: a verified plan for a scene."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan.commands.arguments import add_json, natural, positive
from mmplan.commands.results import SOLVED, print_json, require_folder
from mmplan.exceptions import InputError

if TYPE_CHECKING:
    from mmplan.plan import Plan
    from mmplan.problem import Problem


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "find a verified plan for a scene"
    solve = commands.add_parser("solve", help=text, description=text)
    solve.add_argument("scene", help="a scene file, or the name of a shipped scene")
    solve.add_argument("-o", "--output", type=Path, help="write the plan to this file")
    solve.add_argument("--seed", type=natural, default=0, help="default: 0")
    solve.add_argument(
        "--optimizer",
        metavar="NAME",
        help="instead of the scene's: coevolution, random",
    )
    solve.add_argument(
        "--evaluations",
        type=positive,
        metavar="N",
        help="score evaluations, instead of the scene's number",
    )
    solve.add_argument(
        "--jobs",
        type=positive,
        default=1,
        metavar="N",
        help="processes, of which two are of use; the plan is the same; default: 1",
    )
    solve.add_argument(
        "--html", type=Path, metavar="FILE", help="write a page that shows the plan"
    )
    solve.add_argument(
        "--view", action="store_true", help="show the plan in the browser"
    )
    add_json(solve)
    quiet = "no progress and no result on the terminal"
    solve.add_argument("--quiet", action="store_true", help=quiet)
    solve.set_defaults(run=_solve)


def _solve(options: argparse.Namespace) -> int:
    from mmplan.scene_file import load_problem

    for path in (options.output, options.html):
        if path is not None:
            require_folder(path)
    problem = _with_options(load_problem(options.scene), options)

    from mmplan.pipeline import solve
    from mmplan.terminal import plan_tables, progress_display, show

    with progress_display(quiet=options.quiet) as progress:
        plan = solve(problem, seed=options.seed, progress=progress, jobs=options.jobs)
    if options.output is not None:
        plan.save(options.output)
    if options.json:
        print_json(_plan_summary(plan, options.output))
    elif not options.quiet:
        show(*plan_tables(plan, options.output))
    if options.html is not None or options.view:
        _show(plan, problem, options)
    return SOLVED


def _show(plan: Plan, problem: Problem, options: argparse.Namespace) -> None:
    """The page, and then the viewer until it is ended."""
    from mmplan.commands.view import exhibit_of, show_live, write_page_of

    exhibit = exhibit_of(plan, problem, "the plan")
    if options.html is not None:
        write_page_of(exhibit, options.html)
    if options.view:
        show_live(exhibit, stdout_is_taken=options.json)


def _with_options(problem: Problem, options: argparse.Namespace) -> Problem:
    """The problem with what the command line says instead of the scene."""
    from mmplan.files.suggestions import unknown
    from mmplan.optimizers import OPTIMIZERS

    settings = problem.optimizer
    if options.optimizer is not None:
        if options.optimizer not in OPTIMIZERS:
            message = unknown("optimizer", options.optimizer, tuple(OPTIMIZERS))
            raise InputError(f"--optimizer: {message}")
        settings = replace(settings, name=options.optimizer)
    if options.evaluations is not None:
        settings = replace(settings, evaluations=options.evaluations)
    return replace(problem, optimizer=settings)


def _plan_summary(plan: Plan, output: Path | None) -> dict[str, Any]:
    """What `solve --json` prints."""
    return {
        "solved": True,
        "scene": plan.scene,
        "seed": plan.seed,
        "output": None if output is None else str(output),
        "duration": plan.duration,
        "tasks": [
            {
                "object": task.object,
                "grasp": task.grasp,
                "genes": task.genes.tolist(),
                "start": {
                    "base": task.start.base.tolist(),
                    "scores": task.start.scores,
                },
                "goal": {"base": task.goal.base.tolist(), "scores": task.goal.scores},
                "segments": [
                    {"name": s.name, "duration": s.duration} for s in task.segments
                ],
            }
            for task in plan.tasks
        ],
        "verification": plan.verification and plan.verification.to_json(),
    }
