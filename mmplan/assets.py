"""Robots and scenes that are shipped with mmplan, and where they are."""

from __future__ import annotations

import sys
from pathlib import Path

ROBOT_FILE = "robot.yaml"


def robots_folder() -> Path:
    """The folder with one folder for each robot that is shipped."""
    return _folder("robots")


def scenes_folder() -> Path:
    """The folder with the scenes that are shipped."""
    return _folder("scenes")


def robot_names() -> tuple[str, ...]:
    """The robots that are shipped, sorted."""
    return tuple(sorted(p.parent.name for p in robots_folder().glob(f"*/{ROBOT_FILE}")))


def scene_names() -> tuple[str, ...]:
    """The scenes that are shipped, sorted."""
    return tuple(sorted(p.stem for p in scenes_folder().glob("*.yaml")))


def find_scene(name: str | Path) -> Path:
    """The scene file that `name` means: a file of that path, else a shipped scene.

    A shipped scene goes by its bare name, with or without `.yaml`. Where there is
    neither, the path comes back as it was given, for its reader to refuse.
    """
    path = Path(name)
    if is_file(path):
        return path
    bare = str(name).removesuffix(".yaml")
    return scenes_folder() / f"{bare}.yaml" if bare in scene_names() else path


def find_robot(name: str, folder: Path) -> Path | None:
    """The robot.yaml that `name` means: a shipped robot, else a path from `folder`.

    The path is that of a robot.yaml, or of the folder that it is in.
    """
    if name in robot_names():
        return robots_folder() / name / ROBOT_FILE
    paths = (folder / name, folder / name / ROBOT_FILE)
    return next((path for path in paths if is_file(path)), None)


def is_file(path: Path) -> bool:
    """Whether a file is there; never where the system refuses to look (a long name)."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def example_robots() -> Path | None:
    """The folder `share` that example-robot-data is installed in, if it is."""
    for entry in sys.path:
        share = Path(entry) / "cmeel.prefix" / "share"
        if (share / "example-robot-data" / "robots").is_dir():
            return share
    return None


def _folder(name: str) -> Path:
    """The folder inside the package (a wheel), else beside it (a checkout)."""
    package = Path(__file__).resolve().parent
    inside = package / name
    return inside if inside.is_dir() else package.parent / name
