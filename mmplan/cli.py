"""The command line: arguments in, results out; everything else is done elsewhere."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan import assets
from mmplan.exceptions import InputError, MmplanError, NoPlanError, VerificationError

if TYPE_CHECKING:
    from mmplan.plan import Plan
    from mmplan.problem import Problem

SOLVED, NO_PLAN, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit code is 0, 1 (no plan), 2 (bad input) or 130."""
    options = _parser().parse_args(arguments)
    try:
        code = int(options.run(options))
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # whoever reads stdout has seen enough, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return SOLVED
    except KeyboardInterrupt:
        print("mmplan: interrupted", file=sys.stderr)
        return INTERRUPTED
    except MmplanError as error:
        return _report_error(error, as_json=getattr(options, "json", False))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="mmplan",
        description="Grasps, base placements and verified motions for mobile "
        "manipulators.",
        epilog="Exit codes: 0 done, 1 no plan (with the reasons), 2 bad input, "
        "130 interrupted.",
    )
    parser.add_argument("--version", action="version", version=version("mmplan"))
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    _add_solve(commands)
    _add_verify(commands)
    _add_check(commands)
    for name, text, run in (
        ("robots", "list the robots that are shipped", _robots),
        ("scenes", "list the scenes that are shipped", _scenes),
    ):
        command = commands.add_parser(name, help=text, description=text)
        _add_json(command)
        command.set_defaults(run=run)
    text = "print the JSON schema of scene files"
    schema = commands.add_parser("schema", help=text, description=text)
    schema.set_defaults(run=_schema)
    return parser


def _add_solve(commands: Any) -> None:
    text = "find a verified plan for a scene"
    solve = commands.add_parser("solve", help=text, description=text)
    solve.add_argument("scene", help="a scene file, or the name of a shipped scene")
    solve.add_argument("-o", "--output", type=Path, help="write the plan to this file")
    solve.add_argument("--seed", type=_natural, default=0, help="default: 0")
    solve.add_argument(
        "--optimizer",
        metavar="NAME",
        help="instead of the scene's: coevolution, random",
    )
    solve.add_argument(
        "--evaluations",
        type=_positive,
        metavar="N",
        help="score evaluations, instead of the scene's number",
    )
    _add_json(solve)
    quiet = "no progress and no result on the terminal"
    solve.add_argument("--quiet", action="store_true", help=quiet)
    solve.set_defaults(run=_solve)


def _add_verify(commands: Any) -> None:
    text = "prove a plan against its scene, independently of how it was made"
    verify = commands.add_parser("verify", help=text, description=text)
    verify.add_argument("plan", type=Path, help="a plan file")
    verify.add_argument("--scene", help="the scene, if it is not where the plan says")
    _add_json(verify)
    verify.set_defaults(run=_verify)


def _add_check(commands: Any) -> None:
    text = "load and validate scene files, solve nothing"
    check = commands.add_parser("check", help=text, description=text)
    check.add_argument(
        "scenes", nargs="+", metavar="scene", help="scene files or names"
    )
    _add_json(check)
    check.set_defaults(run=_check)


def _add_json(command: argparse.ArgumentParser) -> None:
    command.add_argument("--json", action="store_true", help="results for programs")


def _natural(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"expected a whole number >= 0, got '{text}'")
    return int(text)


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"expected a whole number > 0, got '{text}'")
    return int(text)


def _solve(options: argparse.Namespace) -> int:
    from mmplan.scene_file import load_problem

    if options.output is not None:
        _require_folder(options.output)
    problem = _with_options(load_problem(options.scene), options)

    from mmplan.pipeline import solve
    from mmplan.terminal import plan_tables, progress_display, show

    with progress_display(quiet=options.quiet) as progress:
        plan = solve(problem, seed=options.seed, progress=progress)
    if options.output is not None:
        plan.save(options.output)
    if options.json:
        _print_json(_plan_summary(plan, options.output))
    elif not options.quiet:
        show(*plan_tables(plan, options.output))
    return SOLVED


def _with_options(problem: Problem, options: argparse.Namespace) -> Problem:
    """The problem with what the command line says instead of the scene."""
    from mmplan.files.suggestions import unknown
    from mmplan.optimizers import OPTIMIZERS

    settings = problem.optimizer
    if options.optimizer is not None:
        if options.optimizer not in OPTIMIZERS:
            message = unknown("optimizer", options.optimizer, tuple(OPTIMIZERS))
            raise InputError(f"--optimizer: {message}")
        settings = replace(settings, name=options.optimizer)
    if options.evaluations is not None:
        settings = replace(settings, evaluations=options.evaluations)
    return replace(problem, optimizer=settings)


def _require_folder(path: Path) -> None:
    """Refuse an output that cannot be written before any work is done for it."""
    if path.is_dir():
        raise InputError(f"{path}: is a folder; give the name of a file")
    if not path.absolute().parent.is_dir():
        raise InputError(f"{path}: there is no folder {path.parent}")


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
        _print_json(report.to_json())
    elif report.ok:
        show(verification_table(plan, report))
    if not report.ok:
        raise VerificationError(tuple(str(fault) for fault in report.faults))
    return SOLVED


def _check(options: argparse.Namespace) -> int:
    from mmplan.scene_file import load_problem

    faults: list[Any] = []
    for scene in options.scenes:
        try:
            problem = load_problem(scene)
        except InputError as error:
            faults += error.diagnostics
            continue
        if not options.json:
            print(f"{scene}: ok: {_counts(problem)}")
    if options.json:
        _print_json({"ok": not faults, "faults": [asdict(f) for f in faults]})
    if faults and not options.json:
        raise InputError(*faults)
    return BAD_INPUT if faults else SOLVED


def _counts(problem: Problem) -> str:
    counts = {
        "obstacles": len(problem.obstacles),
        "objects": len(problem.objects),
        "tasks": len(problem.tasks),
    }
    return f"{problem.robot.name}, " + ", ".join(f"{n} {k}" for k, n in counts.items())


def _robots(options: argparse.Namespace) -> int:
    from mmplan.robot_file import load_robot_description

    folder = assets.robots_folder()
    return _list(
        [
            (
                name,
                load_robot_description(folder / name / assets.ROBOT_FILE).description,
            )
            for name in assets.robot_names()
        ],
        options.json,
    )


def _scenes(options: argparse.Namespace) -> int:
    from mmplan.scene_reader import read_scene

    return _list(
        [(name, read_scene(name).section.description) for name in assets.scene_names()],
        options.json,
    )


def _list(rows: list[tuple[str, str]], as_json: bool) -> int:
    if as_json:
        _print_json([{"name": name, "description": text} for name, text in rows])
    else:
        width = max(len(name) for name, _ in rows)
        for name, text in rows:
            print(f"{name:<{width}}  {text}")
    return SOLVED


def _schema(_options: argparse.Namespace) -> int:
    from mmplan.schema import scene_schema

    _print_json(scene_schema())
    return SOLVED


def _plan_summary(plan: Plan, output: Path | None) -> dict[str, Any]:
    """What `solve --json` prints."""
    return {
        "solved": True,
        "scene": plan.scene,
        "seed": plan.seed,
        "output": None if output is None else str(output),
        "duration": plan.duration,
        "tasks": [
            {
                "object": task.object,
                "grasp": task.grasp,
                "genes": task.genes.tolist(),
                "start": {
                    "base": task.start.base.tolist(),
                    "scores": task.start.scores,
                },
                "goal": {"base": task.goal.base.tolist(), "scores": task.goal.scores},
                "segments": [
                    {"name": s.name, "duration": s.duration} for s in task.segments
                ],
            }
            for task in plan.tasks
        ],
        "verification": plan.verification and plan.verification.to_json(),
    }


def _print_json(value: Any) -> None:
    print(json.dumps(value, indent=2))


def _report_error(error: MmplanError, *, as_json: bool) -> int:
    """Say what is wrong, once; on stdout too where a program listens there."""
    print(f"mmplan: {error}", file=sys.stderr)
    if isinstance(error, NoPlanError) and as_json:
        account = error.report and error.report.to_json()
        _print_json({"solved": False, "message": str(error), "failure": account})
    if isinstance(error, InputError) and as_json:
        faults = [asdict(d) for d in error.diagnostics]
        _print_json({"solved": False, "faults": faults})
    return BAD_INPUT if isinstance(error, InputError) else NO_PLAN


if __name__ == "__main__":
    sys.exit(main())
