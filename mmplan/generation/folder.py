"""Generated scenes as files in a folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from mmplan.atomic_file import write_whole
from mmplan.exceptions import InputError
from mmplan.files.suggestions import listed
from mmplan.generation.acceptance import Acceptance, has_candidate
from mmplan.generation.difficulty import Difficulty
from mmplan.generation.generator import generate, scene_name

# Called with the scenes that are written so far and with all that there are to be.
Progress: TypeAlias = Callable[[int, int], None]


@dataclass(frozen=True)
class Written:
    """The files that were written, and how many scenes were rejected on the way."""

    paths: tuple[Path, ...]
    rejected: int

    def __str__(self) -> str:
        """One line for people."""
        kept = len(self.paths)
        drawn = kept + self.rejected
        return f"{kept} of {drawn} scenes drawn were kept, {self.rejected} rejected"


def write_scenes(
    folder: str | Path,
    family: str,
    count: int,
    seed: int = 0,
    difficulty: float = 0.5,
    *,
    accept: Acceptance = has_candidate,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Written:
    """Generate scenes into a folder, which is made if its parent is there.

    Each scene is written as soon as it is accepted. The arguments are those of
    `generate`; files that are there are replaced with `overwrite` alone.

    Raises:
        InputError: An argument or the folder cannot be used, or files are there.
        NoPlanError: A scene was given up.
    """
    folder = Path(folder)
    scenes = generate(family, count, seed, difficulty, accept=accept)
    names = [scene_name(family, seed, i, Difficulty(difficulty)) for i in range(count)]
    _require_room(folder, [f"{name}.yaml" for name in names], overwrite=overwrite)
    paths: list[Path] = []
    rejected = 0
    for scene in scenes:
        path = folder / scene.file_name
        write_whole(path, scene.text)
        paths.append(path)
        rejected += scene.rejected
        if progress is not None:
            progress(len(paths), count)
    return Written(tuple(paths), rejected)


def _require_room(folder: Path, names: list[str], *, overwrite: bool) -> None:
    """Make the folder; refuse it before any work where it cannot take the files."""
    try:
        folder.mkdir(exist_ok=True)
    except FileNotFoundError:
        raise InputError(f"{folder}: there is no folder {folder.parent}") from None
    except FileExistsError:
        raise InputError(f"{folder}: is a file; give the name of a folder") from None
    except OSError as error:
        raise InputError(f"{folder}: cannot be made: {error.strerror}") from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{folder}: is a folder that cannot be written to")
    there = [name for name in names if (folder / name).exists()]
    if there and not overwrite:
        raise InputError(
            f"{folder}: already there: {listed(there)}; give another folder, or "
            "--overwrite to replace them"
        )
