"""`mmplan export`: a plan in the format of another program."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from mmplan.commands.plans import load_plan
from mmplan.commands.results import SOLVED, require_folder
from mmplan.exceptions import InputError

_FORMATS = "ros-yaml, csv, npz, mcap, rosbag2, moveit-scene, mjcf"


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "write a plan, or its scene, in the format of another program"
    export = commands.add_parser("export", help=text, description=text)
    export.add_argument("plan", type=Path, help="a plan file")
    export.add_argument("--to", required=True, metavar="FORMAT", help=_FORMATS)
    export.add_argument(
        "-o", "--output", type=Path, required=True, help="the file to write"
    )
    export.add_argument("--scene", help="the scene, if it is not where the plan says")
    export.set_defaults(run=_export)


def _export(options: argparse.Namespace) -> int:
    from mmplan.exports import EXPORTS
    from mmplan.files.suggestions import unknown

    if options.to not in EXPORTS:
        raise InputError(f"--to: {unknown('format', options.to, tuple(EXPORTS))}")
    require_folder(options.output)
    plan, problem = load_plan(options.plan, options.scene)
    if problem.fingerprint != plan.fingerprint:
        raise InputError(f"{options.plan}: is a plan for another state of its scene")
    EXPORTS[options.to](problem, plan, options.output)
    return SOLVED
