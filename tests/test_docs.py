"""The documentation leaves nothing out; that it is sound `make docs` says."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from pathlib import Path

import mmplan
from mmplan import cli

DOCS = Path(__file__).parents[1] / "docs"


def test_every_command_shows_its_help() -> None:
    page = (DOCS / "commands.md").read_text(encoding="utf-8")
    shown = re.findall(r"^```\{help\} (.+)$", page, re.MULTILINE)
    assert sorted(shown) == sorted(_commands(cli._parser()))


def _commands(parser: argparse.ArgumentParser, above: str = "") -> Iterator[str]:
    """The words of all commands below a parser."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, command in action.choices.items():
                yield f"{above}{name}"
                yield from _commands(command, f"{above}{name} ")


def test_every_public_name_is_on_the_page_about_python() -> None:
    page = (DOCS / "python.md").read_text(encoding="utf-8")
    described = re.findall(r"^\.\. auto\w+:: (\w+)$", page, re.MULTILINE)
    assert set(mmplan.__all__) <= set(described)
