"""One hash over the contents of all files that a problem is made of."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

from mmplan.exceptions import Diagnostic, InputError


def fingerprint(files: Mapping[str, Path]) -> str:
    """SHA-256 over the contents of files, each under the role that it plays.

    Where the files lie does not count, nor does the order of the mapping.

    Raises:
        InputError: A file cannot be read.
    """
    total = hashlib.sha256()
    for role, path in sorted(_with_buffers(files).items()):
        content = hashlib.sha256(_read(path)).hexdigest()
        total.update(f"{role}\0{content}\n".encode())
    return total.hexdigest()


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        message = f"cannot be read: {error.strerror}"
        raise InputError(Diagnostic(message, file=str(path))) from None


def _with_buffers(files: Mapping[str, Path]) -> dict[str, Path]:
    """The files, and those in which glTF files keep their numbers."""
    found = dict(files)
    for role, path in files.items():
        if path.suffix.lower() == ".gltf":
            for name in _buffers(path):
                found[f"{role} {name}"] = path.parent / name
    return found


def _buffers(path: Path) -> list[str]:
    try:
        buffers = json.loads(_read(path)).get("buffers", [])
    except (ValueError, AttributeError):
        return []  # not glTF: refused where its triangles are read
    names = [b.get("uri", "") for b in buffers]
    return [n for n in names if n and not n.startswith("data:")]
