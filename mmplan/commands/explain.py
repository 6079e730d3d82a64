"""`mmplan explain`: why a scene has no solution, or how hard it is."""

from __future__ import annotations

import argparse
from typing import Any

from mmplan.commands.arguments import add_json, natural
from mmplan.commands.results import NO_PLAN, SOLVED, print_json


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "say why a scene has no solution, or how hard it is, without planning paths"
    explain = commands.add_parser("explain", help=text, description=text)
    explain.add_argument("scene", help="a scene file, or the name of a shipped scene")
    explain.add_argument("--seed", type=natural, default=0, help="default: 0")
    explain.add_argument(
        "--paths",
        action="store_true",
        help="plan paths as well, where nothing else is in the way",
    )
    add_json(explain)
    explain.set_defaults(run=_explain)


def _explain(options: argparse.Namespace) -> int:
    from mmplan.scene_file import load_problem

    problem = load_problem(options.scene)

    from mmplan.explanation import explain, explanation_json, explanation_lines
    from mmplan.terminal import show

    found = explain(problem, seed=options.seed, paths=options.paths)
    solvable = all(task.solvable for task in found)
    if options.json:
        tasks = [explanation_json(task) for task in found]
        print_json({"scene": problem.name, "solvable": solvable, "tasks": tasks})
    else:
        show(*(line for task in found for line in explanation_lines(task)))
    return SOLVED if solvable else NO_PLAN
