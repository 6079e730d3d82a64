"""Where in a file's format an error of pydantic is."""

from __future__ import annotations

import types
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin

from pydantic import Tag

from mmplan.files.document import KeyPath
from mmplan.files.section import Section


class Location(NamedTuple):
    """A key path, the section that holds its last key, the size of its last list."""

    path: KeyPath
    section: type[Section] | None
    size: int


def locate(model: type[Section], loc: tuple[str | int, ...]) -> Location:
    """The location of an error in `model` that pydantic places at `loc`.

    `loc` is the key path, but that it also names the alternative taken of each union
    and marks errors of keys.
    """
    path: list[str | int] = []
    section: type[Section] | None = None
    size = 0
    here: Any = model
    for part in loc:
        here = _plain(here)
        if part == "[key]":
            break
        if _is_union(here) and (alternative := _alternative(here, part)):
            here = alternative
            continue
        path.append(part)
        section = here if _is_section(here) else None
        size = len(get_args(here))
        here = _inside(here, part)
    return Location(tuple(path), section, size)


def _plain(annotation: Any) -> Any:
    """The annotation without metadata and without None."""
    while get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    if not _is_union(annotation):
        return annotation
    given = [a for a in get_args(annotation) if _plain(a) is not type(None)]
    return annotation if len(given) > 1 else _plain(given[0])


def _is_union(annotation: Any) -> bool:
    return get_origin(annotation) in (Union, types.UnionType)


def _is_section(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, Section)


def _alternative(union: Any, tag: str | int) -> Any:
    """The alternative of a tagged union that has the tag; None where none has."""
    for annotation in get_args(union):
        if any(isinstance(m, Tag) and m.tag == tag for m in get_args(annotation)[1:]):
            return annotation
    return None


def _inside(annotation: Any, part: str | int) -> Any:
    """The annotation of what stands at `part` of a section, mapping or list."""
    if _is_section(annotation):
        field = annotation.model_fields.get(part)
        return field.annotation if field else None
    arguments = get_args(annotation)
    if get_origin(annotation) is dict:
        return arguments[1]
    if get_origin(annotation) is tuple and isinstance(part, int):
        return arguments[0 if Ellipsis in arguments else min(part, len(arguments) - 1)]
    return None
