"""`mmplan explain`: why a scene has no solution, or how hard it is."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan.commands.arguments import add_json, natural
from mmplan.commands.results import NO_PLAN, SOLVED, print_json
from mmplan.commands.view import kind_of, size_in_pixels, write_page_of

if TYPE_CHECKING:
    from mmplan.explanation import Explanation
    from mmplan.problem import Problem

_KINDS = (".html", ".png", ".webp")


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
    explain.add_argument(
        "-o",
        "--output",
        type=Path,
        help="draw the nearest miss of the first task that has one; the ending of the "
        f"file says how: {', '.join(_KINDS)}",
    )
    explain.add_argument(
        "--size",
        type=size_in_pixels,
        metavar="WxH",
        default=(1280, 800),
        help="pixels of the picture; default: 1280x800",
    )
    explain.add_argument(
        "--camera", default="auto", help="as for render; auto: near what is missing"
    )
    add_json(explain)
    explain.set_defaults(run=_explain)


def _explain(options: argparse.Namespace) -> int:
    from mmplan.scene_file import load_problem

    if options.output is not None:
        kind_of(options.output, _KINDS)
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
    if options.output is not None:
        _draw(problem, found, options)
    return SOLVED if solvable else NO_PLAN


def _draw(
    problem: Problem, found: Sequence[Explanation], options: argparse.Namespace
) -> None:
    """Draw the first nearest miss, or say on stderr that there is none."""
    from mmplan.explanation import single_tasks
    from mmplan.explanation.drawing import exhibit_of_miss
    from mmplan.terminal import show
    from mmplan.visualization.pictures import Look, write_pictures

    for one, task in zip(single_tasks(problem), found, strict=True):
        miss = task.near_miss
        if miss is None:
            continue
        exhibit = exhibit_of_miss(one, miss)
        if options.output.suffix.lower() == ".html":
            write_page_of(exhibit, options.output)
        else:
            look = Look(options.size, options.camera)
            write_pictures(options.output, exhibit, look)
        if not options.json:
            show(f"written to {options.output}")
        return
    print(f"mmplan: {options.output} not written: no miss to draw", file=sys.stderr)
