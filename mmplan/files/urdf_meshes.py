"""Where the mesh files of a URDF are: `package://` names, URLs, and plain paths."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from mmplan.assets import is_file

PACKAGE = "package://"


def find_mesh(name: str, urdf: Path, package_dirs: Sequence[Path] = ()) -> Path | None:
    """The file that a mesh's `filename` in a URDF means; None where there is none."""
    relative = name.removeprefix("file://")
    if name.startswith(PACKAGE):
        relative = name.removeprefix(PACKAGE).lstrip("/")
    files = (folder / relative for folder in folders_of(name, urdf, package_dirs))
    return next(filter(is_file, files), None)


def folders_of(name: str, urdf: Path, package_dirs: Sequence[Path] = ()) -> list[Path]:
    """The folders in which a name is looked up, each once, in order.

    They are the folder of the URDF and those given; for `package://` also the folders
    above the URDF, which mostly stands somewhere inside the package that it names, and
    those of ROS.
    """
    here = urdf.resolve().parent
    folders = [here, *package_dirs]
    if name.startswith(PACKAGE):
        folders += [*list(here.parents)[:_LEVELS], *_ros_folders()]
    return list(dict.fromkeys(folders))


def _ros_folders() -> Iterator[Path]:
    for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
        if entry:
            yield Path(entry)
    for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if entry:
            yield Path(entry) / "share"


# How far above a URDF its package may start.
_LEVELS = 4
