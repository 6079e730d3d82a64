"""A parsed input file that remembers where each of its values stands."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeAlias

from mmplan.exceptions import Diagnostic, InputError

KeyPath: TypeAlias = tuple[str | int, ...]
"""The way to a value: `("tasks", 0, "to")`."""

Value: TypeAlias = (
    "str | int | float | bool | tuple[Value, ...] | dict[str, Value] | None"
)

LONGEST_SOURCE = 120  # characters of the offending line that are shown


class Place(NamedTuple):
    """A place in a text, counted from 1."""

    line: int
    column: int


class Fault(NamedTuple):
    """Something wrong with the value at a key path.

    `at_key` puts the fault on the key, not on the value behind it; `place` puts it
    anywhere else.
    """

    path: KeyPath
    message: str
    at_key: bool = False
    place: Place | None = None


def dotted(path: KeyPath) -> str:
    """The path for people: `tasks[0].to`."""
    parts = (f"[{p}]" if isinstance(p, int) else f".{p}" for p in path)
    return "".join(parts).removeprefix(".")


@dataclass(frozen=True, eq=False)
class Document:
    """A file's content, its data, and the places of its keys and values.

    `path` is the file as the user named it. Sequences of `data` are tuples. `faults`
    are those found while reading.
    """

    path: Path
    content: bytes
    lines: tuple[str, ...]
    data: dict[str, Value]
    places: Mapping[KeyPath, Place]
    key_places: Mapping[KeyPath, Place]
    faults: tuple[Fault, ...] = ()

    def get(self, *path: str | int) -> Value:
        """The value at a key path; None where there is none."""
        value: Value = self.data
        for part in path:
            if isinstance(value, dict) and isinstance(part, str):
                value = value.get(part)
            elif isinstance(value, tuple) and isinstance(part, int):
                value = value[part] if 0 <= part < len(value) else None
            else:
                return None
        return value

    def keys(self, *path: str | int) -> tuple[str, ...]:
        """The keys of the mapping at a key path; none where it is not a mapping."""
        value = self.get(*path)
        return tuple(value) if isinstance(value, dict) else ()

    def place(self, path: KeyPath, at_key: bool = False) -> Place | None:
        """Where the value (or its key) stands, or the nearest key above it."""
        if path in self.places and not (at_key and path in self.key_places):
            return self.places[path]
        while path and path not in self.key_places:
            path = path[:-1]
        return self.key_places.get(path, self.places.get(path))

    def diagnostic(
        self,
        path: KeyPath,
        message: str,
        at_key: bool = False,
        place: Place | None = None,
    ) -> Diagnostic:
        """The fault `message` of the value at `path`, with its place in the file."""
        text = f"{dotted(path)}: {message}" if path else message
        place = place or self.place(path, at_key)
        return located(self.path, self.lines, place, text)

    def error(self, faults: Iterable[Fault]) -> InputError:
        """One error of all faults, in the order of their places, each said once."""
        found = (self.diagnostic(*fault) for fault in faults)
        unique = {(d.line, d.column, d.message): d for d in found}
        return InputError(
            *sorted(unique.values(), key=lambda d: (d.line or 0, d.column or 0))
        )


def located(
    path: Path, lines: tuple[str, ...], place: Place | None, message: str
) -> Diagnostic:
    """A diagnostic that shows the line at `place`, where it can be shown."""
    if place is None:
        return Diagnostic(message, file=str(path))
    line, column = place
    source = lines[line - 1] if line <= len(lines) else ""
    shown = "".join(c if c.isprintable() else " " for c in source)[:LONGEST_SOURCE]
    visible = bool(shown.strip()) and column <= len(shown) + 1
    return Diagnostic(message, str(path), line, column, shown if visible else None)
