"""Arguments that several commands share."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any


def add_json(command: argparse.ArgumentParser) -> None:
    """Add the option that asks for results for programs."""
    command.add_argument("--json", action="store_true", help="results for programs")


def add_results_folder(command: argparse.ArgumentParser) -> None:
    """Add the option that says where the results of a benchmark are."""
    text = "folder of the results"
    command.add_argument("-o", "--output", type=Path, required=True, help=text)


def add_quiet(command: argparse.ArgumentParser) -> None:
    """Add the option that leaves the terminal alone."""
    text = "no progress and no result on the terminal"
    command.add_argument("--quiet", action="store_true", help=text)


def natural(text: str) -> int:
    """A whole number, at least 0."""
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"expected a whole number >= 0, got '{text}'")
    return int(text)


def positive(text: str) -> int:
    """A whole number above 0."""
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"expected a whole number > 0, got '{text}'")
    return int(text)


def above_zero(text: str) -> float:
    """A number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"expected a number > 0, got '{text}'")
    return value


def listed(kind: Callable[[str], Any]) -> Callable[[str], list[Any]]:
    """A reader of what is separated by commas."""

    def read(text: str) -> list[Any]:
        return [kind(part.strip()) for part in text.split(",")]

    return read
