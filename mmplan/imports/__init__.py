"""Scenes of other programs as scenes of mmplan: one format a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

from mmplan.imports.foreign_scene import ForeignScene
from mmplan.imports.mjcf import read_mjcf
from mmplan.imports.planning_scene import read_motionbenchmaker, read_moveit_scenes
from mmplan.imports.urdf import read_urdfs
from mmplan.imports.writing import TaskWish, Wishes, scene_text

Reader: TypeAlias = Callable[[Sequence[Path]], ForeignScene]

IMPORTS: Mapping[str, Reader] = MappingProxyType(
    {
        "moveit-scene": read_moveit_scenes,
        "motionbenchmaker": read_motionbenchmaker,
        "urdf": read_urdfs,
        "mjcf": read_mjcf,
    }
)

__all__ = ["IMPORTS", "ForeignScene", "Reader", "TaskWish", "Wishes", "scene_text"]
