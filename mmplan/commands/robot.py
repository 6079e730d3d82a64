"""`mmplan robot inspect`, `robot import`, `robot urdf`: a robot before it is used."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan import assets
from mmplan.commands.arguments import add_json
from mmplan.commands.results import SOLVED, print_json
from mmplan.exceptions import InputError

if TYPE_CHECKING:
    from mmplan.robot_file import RobotDescription


def add(commands: Any) -> None:
    """Add the commands to the parser's."""
    text = "look at a robot, or make one of a URDF"
    robot = commands.add_parser("robot", help=text, description=text)
    actions = robot.add_subparsers(required=True, metavar="ACTION")
    _add_inspect(actions)
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


def _add_urdf(actions: Any) -> None:
    text = "print the URDF of the whole robot: base, arm, hand and tool frame"
    urdf = actions.add_parser("urdf", help=text, description=text)
    _add_robot(urdf)
    urdf.set_defaults(run=_urdf)


def _add_robot(command: argparse.ArgumentParser) -> None:
    command.add_argument("robot", help="a robot.yaml, or the name of a shipped robot")


def _described(name: str) -> RobotDescription:
    from mmplan.files.suggestions import unknown
    from mmplan.robot_file import load_robot_description

    path = assets.find_robot(name, Path())
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


def _urdf(options: argparse.Namespace) -> int:
    from xml.etree import ElementTree as ET

    root = ET.fromstring(_described(options.robot).urdf)
    ET.indent(root)
    print(ET.tostring(root, encoding="unicode"))
    return SOLVED
