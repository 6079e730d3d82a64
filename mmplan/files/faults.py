"""Pydantic's errors in plain sentences, at the key paths of the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from mmplan.files.document import Document, Fault, KeyPath
from mmplan.files.locations import locate
from mmplan.files.section import PATTERNS, Section
from mmplan.files.suggestions import listed, suggestion, unknown

S = TypeVar("S", bound=Section)


def validate(model: type[S], document: Document) -> tuple[S | None, tuple[Fault, ...]]:
    """The document's data as a section, or None, and every fault of either.

    Faults of values that the reader has found at fault already are left out.
    """
    context = {"folder": document.path.parent}
    try:
        section = model.model_validate(document.data, context=context)
    except ValidationError as error:
        known = {f.path for f in document.faults if f.place is None}
        found = [_fault(model, e) for e in error.errors(include_url=False)]
        new = [f for f in found if not _is_below(f.path, known)]
        return None, (*document.faults, *new)
    return (None if document.faults else section), document.faults


def _is_below(path: KeyPath, known: set[KeyPath]) -> bool:
    return any(path[:i] in known for i in range(len(path) + 1))


def _fault(model: type[Section], error: ErrorDetails) -> Fault:
    """One of pydantic's errors as a fault."""
    path, section, size = locate(model, error["loc"])
    kind = error["type"]
    if kind == "extra_forbidden":
        return Fault(path, _unknown_key(str(path[-1]), section), at_key=True)
    if kind == "missing" and isinstance(path[-1], str):
        return Fault(path[:-1], _missing_key(path[-1], section), at_key=True)
    if kind == "missing":
        message = f"expected {size} {_noun(error['input'])}, got {len(error['input'])}"
        return Fault(path[:-1], message)
    at_key = error["loc"][-1] == "[key]"
    return Fault(path, _sentence(error), at_key=at_key)


def _unknown_key(key: str, section: type[Section] | None) -> str:
    allowed = section.model_fields if section else ()
    guess = suggestion(key, allowed) or ";"
    return f"unknown key '{key}'{guess} allowed: {listed(allowed)}"


def _missing_key(key: str, section: type[Section] | None) -> str:
    text = section.model_fields[key].description if section else None
    return f"missing key '{key}'" + (f" ({text.rstrip('.')})" if text else "")


def _sentence(error: ErrorDetails) -> str:
    """What was expected and what came instead."""
    context = error.get("ctx", {})
    write = _SENTENCES.get(error["type"])
    if write is not None:
        return write(context, error["input"])
    if expected := _EXPECTED.get(error["type"]):
        return f"expected {expected}, got {shown(error['input'])}"
    return error["msg"]


def shown(value: object) -> str:
    """A value as people write it, shortened."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f"'{value}'" if len(value) <= 60 else f"'{value[:57]}...'"
    if isinstance(value, Mapping):
        return f"the keys {listed(value)}" if value else "no keys"
    if isinstance(value, tuple | list):
        return f"a list of {len(value)}"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _one_of(context: Mapping[str, Any], value: object) -> str:
    allowed = str(context["expected"]).replace(" or ", ", ").replace("'", "")
    if isinstance(value, str):
        return unknown("name", value, allowed.split(", "))
    return f"expected one of {allowed}; got {shown(value)}"


def _length(context: Mapping[str, Any], value: object) -> str:
    bound = context.get("max_length", context.get("min_length"))
    size = context.get("actual_length", len(value) if isinstance(value, str) else None)
    if isinstance(value, str):
        return f"expected at most {bound} characters, got {size}"
    return f"expected {bound} {_noun(value)}, got {size}"


def _noun(values: object) -> str:
    """What a list is a list of."""
    items = values if isinstance(values, tuple) else ()
    return "numbers" if all(isinstance(i, int | float) for i in items) else "values"


def _pattern(context: Mapping[str, Any], value: object) -> str:
    return f"expected {PATTERNS[context['pattern']]}, got {shown(value)}"


_SENTENCES: dict[str, Callable[[Mapping[str, Any], object], str]] = {
    "literal_error": _one_of,
    "string_pattern_mismatch": _pattern,
    "too_long": _length,
    "too_short": _length,
    "string_too_long": _length,
    "greater_than_equal": lambda c, v: f"must be at least {c['ge']}, got {shown(v)}",
    "less_than_equal": lambda c, v: f"must be at most {c['le']}, got {shown(v)}",
}
_EXPECTED = {
    "float_type": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "string_type": "text",
    "bool_type": "true or false",
    "tuple_type": "a list",
    "dict_type": "keys with values",
    "model_type": "keys with values",
    "model_attributes_type": "keys with values",
}
