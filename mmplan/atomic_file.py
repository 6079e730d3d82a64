"""Files that appear whole or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from mmplan.exceptions import InputError


def write_whole(path: Path, content: str | bytes) -> None:
    """Write text (UTF-8) or bytes to `path`, replacing what stood there in one step.

    The content goes to a file beside `path` first, which takes its place only once it
    is on the disk. Whatever interrupts this leaves the old file as it was and the
    folder clean. Pipes and devices, which cannot be replaced, are written to.

    Raises:
        InputError: if the file cannot be written there.
    """
    target = path.resolve()
    data = content.encode("utf-8") if isinstance(content, str) else content
    try:
        if target.exists() and not (target.is_file() or target.is_dir()):
            target.write_bytes(data)
        else:
            _replace(target, data)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise InputError(f"{path}: cannot be written: {reason}") from error


def _replace(target: Path, data: bytes) -> None:
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, "this is a folder")
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        with part.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)
