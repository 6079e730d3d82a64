"""What a plain (unquoted) YAML scalar means."""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from mmplan.files.document import Value

_INTEGER = re.compile(r"[-+]?[0-9]{1,18}")
_NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.?(inf|infinity)|\.?nan", re.IGNORECASE)
_EMPTY = frozenset(["", "~", "null", "Null", "NULL"])
_BOOLEANS = {"true": True, "false": False}


class Scalar(NamedTuple):
    """A value, and what is wrong with it."""

    value: Value
    fault: str | None = None


def parse_scalar(text: str) -> Scalar:
    """The value that a plain scalar stands for: boolean, number or text.

    Integers are decimal whatever their leading zeros. Nothing may be empty, and a
    number must be finite: `.nan`, `.inf` and `1e999` are faults.
    """
    if text in _EMPTY:
        return Scalar(None, "a value is missing")
    if text in _BOOLEANS:
        return Scalar(_BOOLEANS[text])
    if _INTEGER.fullmatch(text):
        return Scalar(int(text))
    if _NUMBER.fullmatch(text):
        value = float(text)
        if math.isfinite(value):
            return Scalar(value)
        return Scalar(value, f"{text} is too large for a number")
    if _NOT_FINITE.fullmatch(text):
        return Scalar(math.nan, f"expected a finite number, got {text}")
    return Scalar(text)
