"""`mmplan generate`: scenes with problems of one family."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

from mmplan.commands.arguments import add_json, natural, positive
from mmplan.commands.results import SOLVED, print_json


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    text = "make scenes with pick-and-place problems that can be solved"
    generate = commands.add_parser("generate", help=text, description=text)
    generate.add_argument(
        "--family", required=True, metavar="NAME", help="bin, kitchen, shelf or table"
    )
    generate.add_argument(
        "-o", "--output", type=Path, required=True, help="folder of the scenes"
    )
    generate.add_argument(
        "--count", type=positive, default=1, help="scenes; default: 1"
    )
    generate.add_argument("--seed", type=natural, default=0, help="default: 0")
    generate.add_argument(
        "--difficulty",
        type=float,
        default=0.5,
        metavar="0..1",
        help="more clutter, tighter gaps, less room; default: 0.5",
    )
    generate.add_argument(
        "--planned",
        action="store_true",
        help="keep only scenes for which a verified plan is found; takes longer",
    )
    replace = "replace scenes that are there"
    generate.add_argument("--overwrite", action="store_true", help=replace)
    add_json(generate)
    quiet = "no progress and no result on the terminal"
    generate.add_argument("--quiet", action="store_true", help=quiet)
    generate.set_defaults(run=_generate)


def _generate(options: argparse.Namespace) -> int:
    from mmplan.generation import has_candidate, has_plan, write_scenes
    from mmplan.terminal import progress_display, show

    with progress_display(quiet=options.quiet) as progress:
        written = write_scenes(
            options.output,
            options.family,
            options.count,
            options.seed,
            options.difficulty,
            accept=has_plan if options.planned else has_candidate,
            overwrite=options.overwrite,
            progress=partial(progress, "scenes") if progress is not None else None,
        )
    if options.json:
        paths = [str(path) for path in written.paths]
        print_json({"scenes": paths, "rejected": written.rejected})
    elif not options.quiet:
        show(str(written), f"written to {options.output}")
    return SOLVED
