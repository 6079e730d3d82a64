"""Grasp families that a scene does not name, to see whether one of them would help."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Any

import numpy as np

from mmplan.exceptions import InputError
from mmplan.explanation.settings import Change, Setting
from mmplan.grasp_build import default_grasps
from mmplan.grasps import (
    Axis,
    BoxFaces,
    CylinderSide,
    CylinderTop,
    GraspFamily,
    Poses,
    Rim,
    SphereGrasps,
)

# What scenes call the families that shapes suggest.
_NAMES: dict[type, str] = {
    Axis: "axis",
    BoxFaces: "box_faces",
    CylinderSide: "cylinder_side",
    CylinderTop: "cylinder_top",
    Poses: "antipodal",
    Rim: "rim",
    SphereGrasps: "sphere",
}


def other_families(setting: Setting) -> Iterator[Change]:
    """The object is grasped by a family that its shape suggests, and no other."""
    problem = setting.problem
    item = problem.object(setting.task.object)
    try:
        suggested = default_grasps(item, problem.robot)
    except InputError:  # the hand is too small
        return
    for name, family in suggested.items():
        if not any(_alike(family, known) for known in item.grasps.values()):
            yield _grasped_by(name, family)


def _grasped_by(name: str, family: GraspFamily) -> Change:
    """The object has one grasp family.

    The size is 0, as nothing is moved.
    """

    def apply(setting: Setting) -> Setting:
        problem, moved = setting.problem, setting.task.object
        objects = tuple(
            replace(o, grasps={name: family}) if o.name == moved else o
            for o in problem.objects
        )
        return setting._replace(problem=replace(problem, objects=objects))

    text = f"with another grasp family: {_NAMES[type(family)]} (`{name}` of its shape)"
    return Change(text, 0.0, apply)


def _alike(a: Any, b: Any) -> bool:
    """Whether a suggested family, a dataclass, and another are the same."""
    if type(a) is not type(b):
        return False
    names = [field.name for field in fields(a)]
    return all(np.array_equal(getattr(a, n), getattr(b, n)) for n in names)
