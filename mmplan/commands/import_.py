"""`mmplan import`: the scene of another program as a scene file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan.commands.results import SOLVED, require_folder
from mmplan.exceptions import InputError

if TYPE_CHECKING:
    from mmplan.imports import Wishes

_FORMATS = "moveit-scene, motionbenchmaker, urdf, mjcf"


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "make a scene file of the scene of another program"
    command = commands.add_parser("import", help=text, description=text)
    command.add_argument("files", nargs="+", type=Path, metavar="FILE")
    command.add_argument("--from", required=True, metavar="FORMAT", help=_FORMATS)
    command.add_argument(
        "-o", "--output", type=Path, required=True, help="the scene file to write"
    )
    command.add_argument(
        "--robot",
        default="puma_mobile",
        help="a robot that is shipped, or the path of a robot.yaml",
    )
    command.add_argument(
        "--base",
        type=_numbers,
        metavar="X,Y[,YAW]",
        help="where the base starts, as --base=-1,0; default: beside the scene",
    )
    command.add_argument("--move", metavar="NAME", help="the thing that is to be moved")
    command.add_argument(
        "--to",
        type=_numbers,
        metavar="X,Y,Z[,R,P,Y]",
        help="the pose that it is to be moved to",
    )
    command.set_defaults(run=_import)


def _import(options: argparse.Namespace) -> int:
    from mmplan.atomic_file import write_whole
    from mmplan.files.suggestions import unknown
    from mmplan.imports import IMPORTS, scene_text

    format_ = getattr(options, "from")
    if format_ not in IMPORTS:
        raise InputError(f"--from: {unknown('format', format_, tuple(IMPORTS))}")
    require_folder(options.output)
    wishes = _wishes(options)
    scene = IMPORTS[format_](options.files)
    text, meshes = scene_text(scene, wishes)
    folder = options.output.absolute().parent
    for path, content in meshes.items():
        (folder / path).parent.mkdir(exist_ok=True)
        write_whole(folder / path, content)
    write_whole(options.output, text)
    for line in scene.unsupported:
        print(f"mmplan: not imported: {line}", file=sys.stderr)
    return SOLVED


def _wishes(options: argparse.Namespace) -> Wishes:
    """What the options say of robot and task.

    Raises:
        InputError: The robot is not there, or an option needs another one.
    """
    from mmplan import assets
    from mmplan.files.suggestions import unknown
    from mmplan.imports import TaskWish, Wishes
    from mmplan.robot_file import load_robot_description

    path = assets.find_robot(options.robot, Path.cwd())
    if path is None:
        names = assets.robot_names()
        raise InputError(f"--robot: {unknown('robot', options.robot, names)}")
    if (options.move is None) != (options.to is None):
        raise InputError("--move and --to go together")
    task = None
    if options.move is not None:
        if len(options.to) not in (3, 6):
            raise InputError("--to: expected X,Y,Z or X,Y,Z,ROLL,PITCH,YAW")
        task = TaskWish(options.move, options.to)
    shipped = options.robot in assets.robot_names()
    model = options.robot if shipped else str(path.resolve())
    return Wishes(load_robot_description(path), model, options.base, task)


def _numbers(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        message = f"expected numbers with commas between them, got '{text}'"
        raise argparse.ArgumentTypeError(message) from None
