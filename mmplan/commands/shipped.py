"""`mmplan robots`, `mmplan scenes`, `mmplan schema`: what is shipped."""

from __future__ import annotations

import argparse
from typing import Any

from mmplan import assets
from mmplan.commands.arguments import add_json
from mmplan.commands.results import SOLVED, print_json


def add(commands: Any) -> None:
    """Add the commands to the parser's."""
    for name, text, run in (
        ("robots", "list the robots that are shipped, with measured costs", _robots),
        ("scenes", "list the scenes that are shipped", _scenes),
    ):
        command = commands.add_parser(name, help=text, description=text)
        add_json(command)
        command.set_defaults(run=run)
    text = "print the JSON schema of scene files, of robot files, or of plan files"
    schema = commands.add_parser("schema", help=text, description=text)
    schema.add_argument(
        "of", nargs="?", choices=("scene", "robot", "plan"), default="scene"
    )
    schema.set_defaults(run=_schema)


def _robots(options: argparse.Namespace) -> int:
    from mmplan.robot_build import load_robot
    from mmplan.robot_setup.summary import summary
    from mmplan.terminal import grid, show

    rows = [summary(load_robot(name)) for name in assets.robot_names()]
    if options.json:
        print_json([row.to_json() for row in rows])
    else:
        show(grid(rows[0].HEADERS, (row.texts() for row in rows), left=2))
        show("", *(f"{row.name}: {row.description}" for row in rows))
    return SOLVED


def _scenes(options: argparse.Namespace) -> int:
    from mmplan.scene_reader import read_scene

    return _list(
        [(name, read_scene(name).section.description) for name in assets.scene_names()],
        options.json,
    )


def _list(rows: list[tuple[str, str]], as_json: bool) -> int:
    if as_json:
        print_json([{"name": name, "description": text} for name, text in rows])
    else:
        width = max(len(name) for name, _ in rows)
        for name, text in rows:
            print(f"{name:<{width}}  {text}")
    return SOLVED


def _schema(options: argparse.Namespace) -> int:
    from mmplan.plan_file import plan_schema
    from mmplan.schema import robot_schema, scene_schema

    schemas = {"scene": scene_schema, "robot": robot_schema, "plan": plan_schema}
    print_json(schemas[options.of]())
    return SOLVED
