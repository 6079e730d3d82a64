"""YAML files of other programs, as plain data; mmplan's own are read more strictly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from mmplan.exceptions import Diagnostic, InputError


def read_foreign_yaml(path: Path) -> Any:
    """The first document of a file: mappings, lists, text, numbers, booleans.

    Raises:
        InputError: It cannot be read, is not YAML, or has tags of a program.
    """
    try:
        with path.open(encoding="utf-8") as file:
            return next(iter(yaml.safe_load_all(file)), None)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = (mark.line + 1, mark.column + 1) if mark else (None, None)
        message = error.problem or "is not YAML"
        raise InputError(Diagnostic(message, str(path), *place)) from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: is not YAML: {error}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
