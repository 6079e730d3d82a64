"""Claims on runs, so that processes that share a store do not do the same work."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

_SETUP = 0  # the byte that is locked while a store is opened


class RunKey(Protocol):
    """A named tuple that tells one run from every other in the same store."""

    @property
    def _fields(self) -> tuple[str, ...]: ...

    def __iter__(self) -> Iterator[object]:
        """Its values."""

    @property
    def digest(self) -> str:
        """The key as a number in hexadecimal digits."""


class Claims:
    """One lock for each run, held by a process: gone with it, however it ends.

    Every key has a byte of one file, whose size does not matter. Locks of this kind
    belong to a process and are all lost when it closes the file, so that a process
    must open a folder's claims once only.
    """

    def __init__(self, path: Path) -> None:
        """Open the file of the claims, and make it where there is none."""
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)

    def take(self, key: RunKey) -> bool:
        """Whether the run is now this process's to do."""
        try:
            fcntl.lockf(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _byte(key))
        except (BlockingIOError, PermissionError):
            return False
        return True

    def release(self, key: RunKey) -> None:
        """Let others have the run."""
        fcntl.lockf(self._file, fcntl.LOCK_UN, 1, _byte(key))

    @contextmanager
    def setting_up(self) -> Iterator[None]:
        """Wait until no other process sets up the store, and keep others waiting."""
        fcntl.lockf(self._file, fcntl.LOCK_EX, 1, _SETUP)
        try:
            yield
        finally:
            fcntl.lockf(self._file, fcntl.LOCK_UN, 1, _SETUP)

    def close(self) -> None:
        """Give up all claims."""
        os.close(self._file)


def _byte(key: RunKey) -> int:
    return 1 + int(key.digest[:14], 16)
