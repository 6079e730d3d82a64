"""The one door to YAML: a file in, a `Document` out.

Read is what YAML 1.2 and people agree on, where PyYAML's YAML 1.1 does not: only `true`
and `false` are booleans, `1e-3` is a number, `012` is twelve, `1:30` and dates are
text. Refused are duplicate keys, empty values, numbers that are not finite, tags, merge
keys, and aliases that are cyclic or expand without end.
"""

from __future__ import annotations

import re
from pathlib import Path

import yaml

from mmplan.exceptions import Diagnostic, InputError
from mmplan.files.document import Document, Fault, KeyPath, Place, Value, located
from mmplan.files.yaml_nodes import Node, TreeError, build_tree
from mmplan.files.yaml_scalars import parse_scalar

LARGEST_FILE = 1_000_000  # bytes
MOST_VALUES = 100_000  # after aliases are expanded

_LINE_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")  # those of PyYAML


def read_document(path: Path) -> Document:
    """Read a YAML file whose top level is a mapping.

    Raises:
        InputError: The file cannot be read or is not YAML. Faults of single values
            are kept in the document, for its reader to raise with those it finds.
    """
    return parse_document(path, _read_bytes(path))


def parse_document(path: Path, content: bytes) -> Document:
    """The same of a file whose content is known."""
    text = _decode(path, content)
    lines = tuple(_LINE_BREAK.split(text))
    try:
        root = build_tree(text)
        if root is None:
            raise InputError(Diagnostic("the file is empty", file=str(path)))
        expansion = _Expansion()
        data = expansion.value(root, ())
    except TreeError as error:
        raise InputError(located(path, lines, error.place, error.message)) from None
    if not isinstance(data, dict):
        message = "expected 'key: value' lines at the top level of the file"
        raise InputError(located(path, lines, root.place, message))
    return Document(
        path=path,
        content=content,
        lines=lines,
        data=data,
        places=expansion.places,
        key_places=expansion.key_places,
        faults=tuple(expansion.faults),
    )


def _read_bytes(path: Path) -> bytes:
    """The file's content, or an error that says why there is none."""

    def refuse(message: str) -> InputError:
        return InputError(Diagnostic(message, file=str(path)))

    try:
        if path.is_dir():
            raise refuse("is a folder, not a file")
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise refuse("no such file") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise refuse(f"cannot be read: {reason}") from None
    if len(content) > LARGEST_FILE:
        raise refuse(f"is too large: at most {LARGEST_FILE:,} bytes are read")
    return content


def _decode(path: Path, content: bytes) -> str:
    """The content as text, or an error that says where it is not text."""

    def refuse(before: str, message: str) -> InputError:
        lines = _LINE_BREAK.split(before)
        return InputError(
            Diagnostic(message, str(path), len(lines), len(lines[-1]) + 1)
        )

    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8-sig", errors="replace")
        byte = content[error.start]
        raise refuse(before, f"not UTF-8 text: found the byte 0x{byte:02x}") from None
    control = yaml.reader.Reader.NON_PRINTABLE.search(text)
    if control:
        code = ord(control.group())
        message = f"not a text file: found the control character U+{code:04X}"
        raise refuse(text[: control.start()], message)
    return text


class _Expansion:
    """Turns a tree of nodes into plain data and writes down the places."""

    def __init__(self) -> None:
        self.places: dict[KeyPath, Place] = {}
        self.key_places: dict[KeyPath, Place] = {}
        self.faults: list[Fault] = []

    def value(self, node: Node, path: KeyPath) -> Value:
        """The data of `node`, which stands at `path`."""
        if len(self.places) >= MOST_VALUES:
            raise TreeError(f"holds more than {MOST_VALUES:,} values", node.place)
        self.places[path] = node.place
        if node.fault:
            self.faults.append(Fault(path, node.fault))
        if node.kind == "mapping":
            return self._mapping(node, path)
        if node.kind == "sequence":
            return tuple(
                self.value(item, (*path, i)) for i, item in enumerate(node.items)
            )
        return self._scalar(node, path)

    def _mapping(self, node: Node, path: KeyPath) -> dict[str, Value]:
        """The data of a mapping; of a key given twice, the first value is kept."""
        data: dict[str, Value] = {}
        for key, item in zip(node.items[::2], node.items[1::2], strict=True):
            here = (*path, key.text)
            first = self.key_places.get(here)
            if fault := _key_fault(key, first):
                where = here if key.text else path
                self.faults.append(Fault(where, fault, place=key.place))
                continue
            self.key_places[here] = key.place
            data[key.text] = self.value(item, here)
        return data

    def _scalar(self, node: Node, path: KeyPath) -> Value:
        """The data of a scalar."""
        if node.quoted:
            return node.text
        scalar = parse_scalar(node.text)
        if scalar.fault:
            self.faults.append(Fault(path, scalar.fault))
        return scalar.value


def _key_fault(key: Node, first: Place | None) -> str | None:
    """What is wrong with a key; `first` is where the same key stood before."""
    if key.kind != "scalar":
        return "a key must be plain text"
    if key.fault:
        return key.fault
    if key.text == "<<" and not key.quoted:
        return "merge keys ('<<') are not read; write the keys out"
    if first:
        return f"duplicate key '{key.text}', first given in line {first.line}"
    return None
