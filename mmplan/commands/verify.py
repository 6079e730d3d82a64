"""`mmplan verify`: the proof of a plan."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from mmplan.commands.arguments import add_json
from mmplan.commands.results import SOLVED, print_json
from mmplan.exceptions import InputError, VerificationError


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "prove a plan against its scene, independently of how it was made"
    verify = commands.add_parser("verify", help=text, description=text)
    verify.add_argument("plan", type=Path, help="a plan file")
    verify.add_argument("--scene", help="the scene, if it is not where the plan says")
    add_json(verify)
    verify.set_defaults(run=_verify)


def _verify(options: argparse.Namespace) -> int:
    from mmplan.plan import Plan
    from mmplan.scene_file import load_problem

    plan = Plan.load(options.plan)
    scene = options.scene if options.scene is not None else plan.path
    if scene is None or (options.scene is None and not Path(scene).is_file()):
        raise InputError(
            f"{options.plan}: its scene '{scene or plan.scene}' is not there; give it "
            "with --scene"
        )
    problem = load_problem(scene)

    from mmplan.terminal import show, verification_table
    from mmplan.verification import examine

    report = examine(plan, problem)
    if options.json:
        print_json(report.to_json())
    elif report.ok:
        show(verification_table(plan, report))
    if not report.ok:
        raise VerificationError(tuple(str(fault) for fault in report.faults))
    return SOLVED
