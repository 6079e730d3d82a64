"""`mmplan robots`, `mmplan scenes`, `mmplan schema`: what is shipped."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from mmplan import assets
from mmplan.commands.arguments import add_json
from mmplan.commands.results import SOLVED, print_json
from mmplan.files.suggestions import listed

ROBOTS_PACKAGE = "example-robot-data"


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

    names, elsewhere = _robots_here()
    rows = [summary(load_robot(name)) for name in names]
    if elsewhere:
        needs = f"{ROBOTS_PACKAGE}: pip install 'mmplan[robots]'"
        print(f"mmplan: {listed(elsewhere)} need {needs}", file=sys.stderr)
    if options.json:
        print_json([row.to_json() for row in rows])
    else:
        show(grid(rows[0].HEADERS, (row.texts() for row in rows), left=2))
        show("", *(f"{row.name}: {row.description}" for row in rows))
    return SOLVED


def _robots_here() -> tuple[list[str], list[str]]:
    """The shipped robots that can be loaded, and those whose data is not installed."""
    from mmplan.files.yaml_reader import read_document

    here: list[str] = []
    elsewhere: list[str] = []
    for name in assets.robot_names():
        document = read_document(assets.robots_folder() / name / "robot.yaml")
        of_package = document.get("urdf", ROBOTS_PACKAGE.replace("-", "_")) is not None
        missing = of_package and assets.example_robots() is None
        (elsewhere if missing else here).append(name)
    return here, elsewhere


def _scenes(options: argparse.Namespace) -> int:
    from mmplan.files.yaml_reader import read_document

    documents = [
        (name, read_document(assets.find_scene(name))) for name in assets.scene_names()
    ]
    return _list(
        [(name, str(d.get("description") or "")) for name, d in documents], options.json
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
