"""URDF files as fixtures, which scenes of mmplan know by themselves."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mmplan.exceptions import InputError
from mmplan.files.scene_checks import package_folders
from mmplan.files.urdf import UrdfError, read_urdf
from mmplan.imports.foreign_scene import ForeignScene, ForeignThing


def read_urdfs(files: Sequence[Path]) -> ForeignScene:
    """Each file becomes one obstacle, with all moving joints in its configuration.

    Raises:
        InputError: A file is no URDF that can be used.
    """
    scene = ForeignScene(files[0].stem)
    for path in files:
        try:
            urdf = read_urdf(path, package_folders(path))
        except UrdfError as error:
            raise InputError(f"{path}: {error}") from None
        at = {
            joint.name: float(np.clip(0.0, joint.lower, joint.upper))
            for joint in urdf.joints.values()
            if joint.mimic is None
        }
        entry = {"urdf": str(path.resolve()), **({"configuration": at} if at else {})}
        scene.things.append(ForeignThing(path.stem, entry, np.eye(4)))
        if not urdf.bodies:
            scene.unsupported.append(f"{path.name}: it has no collision bodies")
    return scene
