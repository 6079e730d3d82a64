"""What a command hands back: an exit code, and JSON for programs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mmplan.exceptions import InputError

SOLVED, NO_PLAN, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


def print_json(value: Any) -> None:
    """Print one JSON value on stdout."""
    print(json.dumps(value, indent=2))


def require_folder(path: Path) -> None:
    """Refuse an output that cannot be written before any work is done for it."""
    if path.is_dir():
        raise InputError(f"{path}: is a folder; give the name of a file")
    if not path.absolute().parent.is_dir():
        raise InputError(f"{path}: there is no folder {path.parent}")
