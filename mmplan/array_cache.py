"""Arrays that are costly to make, kept in the user's cache folder."""

from __future__ import annotations

import contextlib
import os
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from mmplan.shapes import Array


def cached(folder: str, key: str, make: Callable[[], list[Array]]) -> list[Array]:
    """The arrays under a key, made if they are not there.

    Files are named by the key and appear whole or not at all, so that processes may
    write the same at once; one that is damaged is made anew. Without a cache that can
    be written the arrays are made each time.
    """
    path = _cache_folder() / folder / f"{key}.npz"
    arrays = _read(path)
    if arrays is None:
        arrays = make()
        with contextlib.suppress(OSError):
            _write(path, arrays)
    return arrays


def _cache_folder() -> Path:
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "mmplan"


def _read(path: Path) -> list[Array] | None:
    """The arrays in a file of the cache; None where there is no sound one."""
    try:
        with path.open("rb") as file, np.load(file) as arrays:
            return [arrays[f"arr_{i}"] for i in range(len(arrays.files))]
    except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile):
        return None


def _write(path: Path, arrays: list[Array]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        part = Path(file.name)
        try:
            np.savez(file, *arrays)
            file.close()
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
