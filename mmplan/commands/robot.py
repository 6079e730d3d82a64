"""`mmplan robot inspect`, `robot import`, `robot urdf`: a robot before it is used."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan import assets
from mmplan.commands.arguments import add_json
from mmplan.commands.results import SOLVED, print_json
from mmplan.exceptions import InputError

BASE_TYPES = ("xy", "planar", "diff_drive", "reeds_shepp", "fixed")

if TYPE_CHECKING:
    from mmplan.robot_file import RobotDescription


def add(commands: Any) -> None:
    """Add the commands to the parser's."""
    text = "look at a robot, or make one of a URDF"
    robot = commands.add_parser("robot", help=text, description=text)
    actions = robot.add_subparsers(required=True, metavar="ACTION")
    _add_inspect(actions)
    _add_import(actions)
    _add_urdf(actions)


def _add_inspect(actions: Any) -> None:
    text = (
        "groups, frames, limits, collision bodies, which pairs of links are not "
        "checked and why, and what inverse kinematics and collision checks cost"
    )
    inspect = actions.add_parser("inspect", help="everything there is to know about it")
    inspect.description = text
    _add_robot(inspect)
    add_json(inspect)
    inspect.set_defaults(run=_inspect)


def _add_import(actions: Any) -> None:
    text = (
        "make a robot.yaml of a URDF; groups, tool frame, pairs of links that need no "
        "check, resting places and more are guessed or measured, and said"
    )
    command = actions.add_parser("import", help="make one of a URDF", description=text)
    command.add_argument("urdf", type=Path, help="a URDF file")
    command.add_argument(
        "--base", required=True, choices=BASE_TYPES, help="how the base moves"
    )
    command.add_argument(
        "--tip",
        required=True,
        metavar="LINK",
        help="link between the fingers, or at the flange: the arm's last",
    )
    command.add_argument(
        "-o", "--output", type=Path, required=True, help="folder to write"
    )
    command.add_argument("--name", help="default: the name of the folder")
    command.add_argument(
        "--arm", type=_names, default=(), metavar="JOINTS", help="instead of the guess"
    )
    command.add_argument(
        "--hand",
        default="",
        metavar="JOINTS|FILE",
        help="joints of the fingers, instead of the guess; or the URDF of a hand that "
        "is fixed to the tip",
    )
    command.add_argument("--srdf", type=Path, help="for its disabled pairs")
    command.add_argument(
        "--package-dir",
        type=Path,
        action="append",
        default=[],
        metavar="FOLDER",
        help="where package:// names are looked up, too; may be given several times",
    )
    command.add_argument(
        "--pedestal",
        type=float,
        nargs=2,
        metavar=("RADIUS", "HEIGHT"),
        help="cylinder that the root stands on, m; 0 0 for none",
    )
    command.add_argument(
        "--tight",
        type=float,
        default=40.0,
        metavar="MM",
        help="a link's hull may stand off its mesh this far (a hand's by half of "
        "that), else the mesh is cut into convex pieces, which takes a minute a "
        "link; default: 40",
    )
    add_json(command)
    quiet = "no progress and no result on the terminal"
    command.add_argument("--quiet", action="store_true", help=quiet)
    command.set_defaults(run=_import)


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _add_urdf(actions: Any) -> None:
    text = "print the URDF of the whole robot: base, arm, hand and tool frame"
    urdf = actions.add_parser("urdf", help=text, description=text)
    _add_robot(urdf)
    urdf.set_defaults(run=_urdf)


def _add_robot(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "robot", help="a robot.yaml, its folder, or the name of a shipped robot"
    )


def _described(name: str) -> RobotDescription:
    from mmplan.files.suggestions import unknown
    from mmplan.robot_file import load_robot_description

    inside = Path(name) / assets.ROBOT_FILE
    path = inside if assets.is_file(inside) else assets.find_robot(name, Path())
    if path is None and name.endswith(".yaml"):
        raise InputError(f"{name}: no such file")
    if path is None:
        raise InputError(unknown("robot", name, assets.robot_names()))
    return load_robot_description(path)


def _inspect(options: argparse.Namespace) -> int:
    description = _described(options.robot)

    from mmplan.commands.robot_report import as_json, report
    from mmplan.robot_setup.inspection import inspect
    from mmplan.robot_setup.warnings import warnings
    from mmplan.terminal import show

    inspection = inspect(description)
    found = list(warnings(inspection))
    if options.json:
        print_json(as_json(inspection, found))
    else:
        show(*report(inspection, found))
    return SOLVED


def _import(options: argparse.Namespace) -> int:
    from mmplan.robot_setup.importing import import_robot
    from mmplan.robot_setup.wishes import Wishes
    from mmplan.terminal import show

    hand = (
        Path(options.hand) if options.hand.endswith(".urdf") else _names(options.hand)
    )
    wishes = Wishes(
        base=options.base,
        tip=options.tip,
        name=options.name or options.output.name,
        arm=options.arm,
        hand=hand,
        srdf=options.srdf,
        package_dirs=tuple(options.package_dir),
        pedestal=options.pedestal and tuple(options.pedestal),
        tight=options.tight / 1000.0,
    )
    quiet = options.quiet or not sys.stderr.isatty()
    progress = _silent if quiet else _say
    imported = import_robot(options.urdf, wishes, options.output, progress)
    if options.json:
        print_json({"robot": str(imported.path), "notes": imported.notes})
    elif not options.quiet:
        show(f"written to {imported.path}; to be checked:")
        show(*(f"- {note}" for note in imported.notes))
    return SOLVED


def _say(stage: str) -> None:
    print(f"{stage} ...", file=sys.stderr)


def _silent(stage: str) -> None:
    """Say nothing."""


def _urdf(options: argparse.Namespace) -> int:
    from xml.etree import ElementTree as ET

    from mmplan.files.urdf_edit import rename_link

    root = ET.fromstring(_described(options.robot).urdf)
    # The arms of some URDFs stand on one. MuJoCo takes it for the world itself.
    rename_link(root, "world", "world_link")
    ET.indent(root)
    print(ET.tostring(root, encoding="unicode"))
    return SOLVED
