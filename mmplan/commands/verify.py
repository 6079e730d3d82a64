"""`mmplan verify`: the proof of a plan."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from mmplan.commands.arguments import add_json
from mmplan.commands.plans import load_plan
from mmplan.commands.results import SOLVED, print_json
from mmplan.exceptions import VerificationError


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "prove a plan against its scene, independently of how it was made"
    verify = commands.add_parser("verify", help=text, description=text)
    verify.add_argument("plan", type=Path, help="a plan file")
    verify.add_argument("--scene", help="the scene, if it is not where the plan says")
    add_json(verify)
    verify.set_defaults(run=_verify)


def _verify(options: argparse.Namespace) -> int:
    plan, problem = load_plan(options.plan, options.scene)

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
