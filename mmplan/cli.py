"""The command line: arguments in, results out; everything else is done elsewhere."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version

from mmplan.commands import (
    benchmark,
    check,
    explain,
    export,
    generate,
    grasps,
    import_,
    robot,
    shipped,
    solve,
    verify,
    view,
)
from mmplan.commands.results import (
    BAD_INPUT,
    INTERRUPTED,
    NO_PLAN,
    SOLVED,
    print_json,
)
from mmplan.exceptions import InputError, MmplanError, NoPlanError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit code is 0, 1 (no plan), 2 (bad input) or 130."""
    given = sys.argv[1:] if arguments is None else arguments
    options = _parser().parse_args(_joined(given))
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


def _joined(arguments: Sequence[str]) -> list[str]:
    """The arguments with commands of two words, as `benchmark report`, as one."""
    words = tuple(arguments[:2])
    if words in benchmark.TWO_WORDS:
        return [" ".join(words), *arguments[2:]]
    return list(arguments)


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
    for command in (
        solve,
        verify,
        view,
        check,
        explain,
        export,
        import_,
        benchmark,
        generate,
        grasps,
        robot,
        shipped,
    ):
        command.add(commands)
    return parser


def _report_error(error: MmplanError, *, as_json: bool) -> int:
    """Say what is wrong, once; on stdout too where a program listens there."""
    print(f"mmplan: {error}", file=sys.stderr)
    if isinstance(error, NoPlanError) and as_json:
        account = error.report and error.report.to_json()
        print_json({"solved": False, "message": str(error), "failure": account})
    if isinstance(error, InputError) and as_json:
        faults = [asdict(d) for d in error.diagnostics]
        print_json({"solved": False, "faults": faults})
    return BAD_INPUT if isinstance(error, InputError) else NO_PLAN
