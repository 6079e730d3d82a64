"""What a command hands back: an exit code, and JSON for programs."""

from __future__ import annotations

import json
from typing import Any

SOLVED, NO_PLAN, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


def print_json(value: Any) -> None:
    """Print one JSON value on stdout."""
    print(json.dumps(value, indent=2))
