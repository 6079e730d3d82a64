"""Arguments that several commands share."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import Any


def add_json(command: argparse.ArgumentParser) -> None:
    """Add the option that asks for results for programs."""
    command.add_argument("--json", action="store_true", help="results for programs")


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
