"""`mmplan check`: the faults of scene files."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from mmplan.commands.arguments import add_json
from mmplan.commands.results import BAD_INPUT, SOLVED, print_json
from mmplan.exceptions import InputError

if TYPE_CHECKING:
    from mmplan.problem import Problem


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "load and validate scene files, solve nothing"
    check = commands.add_parser("check", help=text, description=text)
    check.add_argument(
        "scenes", nargs="+", metavar="scene", help="scene files or names"
    )
    add_json(check)
    check.set_defaults(run=_check)


def _check(options: argparse.Namespace) -> int:
    from mmplan.scene_file import load_problem

    faults: list[Any] = []
    for scene in options.scenes:
        try:
            problem = load_problem(scene)
        except InputError as error:
            faults += error.diagnostics
            continue
        if not options.json:
            print(f"{scene}: ok: {_counts(problem)}")
    if options.json:
        print_json({"ok": not faults, "faults": [asdict(f) for f in faults]})
    if faults and not options.json:
        raise InputError(*faults)
    return BAD_INPUT if faults else SOLVED


def _counts(problem: Problem) -> str:
    counts = {
        "obstacles": len(problem.obstacles),
        "objects": len(problem.objects),
        "tasks": len(problem.tasks),
    }
    return f"{problem.robot.name}, " + ", ".join(f"{n} {k}" for k, n in counts.items())
