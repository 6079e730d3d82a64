"""`mmplan grasps`: the grasps of an object, what they are worth, and as a file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan.commands.arguments import add_json, natural, positive
from mmplan.commands.results import SOLVED, print_json

if TYPE_CHECKING:
    from mmplan.grasp_survey import FamilySurvey
    from mmplan.problem import Object, Problem

_HEADERS = (
    "grasps",
    "family",
    "genes",
    "close",
    "quality",
    "best",
    "at start",
    "at goal",
)


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "show the grasps of an object: families, quality, where they are feasible"
    grasps = commands.add_parser("grasps", help=text, description=text)
    grasps.add_argument("scene", help="scene file or name")
    grasps.add_argument("--object", required=True, metavar="NAME")
    grasps.add_argument(
        "--samples", type=positive, default=100, help="of each family; default: 100"
    )
    grasps.add_argument(
        "--bases", type=positive, default=30, help="tried with each; default: 30"
    )
    grasps.add_argument("--seed", type=natural, default=0, help="default: 0")
    grasps.add_argument(
        "--save",
        type=Path,
        metavar="FILE",
        help="write the samples that close, best first, or the families as regions",
    )
    grasps.add_argument(
        "--as",
        dest="format",
        choices=("isaac_grasp", "tsr"),
        default="isaac_grasp",
        help="what --save writes: samples as isaac_grasp 1.0 (the default), or "
        "families as task space regions",
    )
    add_json(grasps)
    grasps.set_defaults(run=_grasps)


def _grasps(options: argparse.Namespace) -> int:
    from mmplan.grasp_survey import object_of, opening_of, survey
    from mmplan.scene_file import load_problem

    problem = load_problem(options.scene)
    item = object_of(problem, options.object)
    if options.save is not None:
        _save(options, problem, item)
    rows = survey(problem, item, options.samples, options.bases, options.seed)
    if options.json:
        families = [row.to_json() for row in rows]
        opening = opening_of(problem)
        print_json({"object": item.name, "hand_opens": opening, "families": families})
    else:
        _show(item, opening_of(problem), rows)
    return SOLVED


def _save(options: argparse.Namespace, problem: Problem, item: Object) -> None:
    from mmplan.grasp_survey import save_regions, save_samples

    if options.format == "tsr":
        save_regions(options.save, item)
        return
    save_samples(options.save, problem, item, options.samples, options.seed)


def _show(item: Object, opening: float, rows: tuple[FamilySurvey, ...]) -> None:
    from mmplan.terminal import grid, show

    shape = type(item.shape).__name__.lower()
    show(f"{item.name}: {shape}; the hand opens by {opening:.3g} m", "")
    show(grid(_HEADERS, (_texts(row) for row in rows), left=2))


def _texts(row: FamilySurvey) -> list[str]:
    at = [f"{row.feasible[k]:.0%}" if k in row.feasible else "" for k in _ENDS]
    quality = [f"{row.quality_median:.2f}", f"{row.quality_best:.2f}"]
    return [row.name, row.family, str(row.genes), f"{row.closes:.0%}", *quality, *at]


_ENDS = ("start", "goal")
