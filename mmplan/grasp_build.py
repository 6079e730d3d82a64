"""The grasp families of an object: those that a scene names, or those of its shape."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mmplan.collision import HandCloser, Scenery, hand_size, hand_widths
from mmplan.exceptions import InputError
from mmplan.files.document import Fault
from mmplan.files.scene_sections import ObjectSection
from mmplan.grasp_values import GraspContext, family, sampled
from mmplan.grasps import GraspFamily
from mmplan.grasps.defaults import default_families, narrowest
from mmplan.problem import Object
from mmplan.robot import Robot
from mmplan.shapes import Mesh

# How many grasps of a family are tried to see whether the hand goes around the object:
# a few first, which nearly always tell, then many.
_TRIED = (24, 400)
_SAMPLES = 500  # of a mesh, where the scene does not say


def named_grasps(
    section: ObjectSection, item: Object, robot: Robot, folder: Path
) -> tuple[dict[str, GraspFamily], list[Fault]]:
    """The families that a scene names, and the faults of those that cannot be.

    Files are sought in `folder`.
    """
    families: dict[str, GraspFamily] = {}
    faults = []
    context = GraspContext(item, robot, folder)
    for name, grasp in section.grasps.items():
        try:
            families[name] = family(grasp, context)
            message = too_wide(families[name], item, robot)
        except InputError as error:
            message = str(error)
        if message:
            faults.append(Fault(("objects", item.name, "grasps", name), message))
    return families, faults


def default_grasps(item: Object, robot: Robot) -> dict[str, GraspFamily]:
    """The families that an object's shape suggests to a robot's hand, by name.

    Raises:
        InputError: The object is too wide for the hand, with the width, or its mesh
            cannot be used.
    """
    if isinstance(item.shape, Mesh):
        return {"antipodal": sampled(item, robot, _SAMPLES, 0)}
    hand = hand_size(robot)
    families = default_families(item.shape, hand)
    if not families:
        raise InputError(
            f"'{item.name}' is {narrowest(item.shape):.3g} m wide where it is "
            f"narrowest, and the hand of {robot.name} opens by {hand.opening:.3g} m"
        )
    return families


def too_wide(grasps: GraspFamily, item: Object, robot: Robot) -> str | None:
    """Why the hand goes around the object in no grasp of a family; None if it may.

    Judged by a few grasps. Grasps that miss the object are none of its business.

    Raises:
        InputError: The object's mesh cannot be used.
    """
    rng, solids = np.random.default_rng(0), Scenery.solids_of_object(item)
    for n in _TRIED:
        T = grasps.tool_poses(grasps.genes.sample(n, rng))
        if HandCloser(robot, solids).close(T).touches.any():
            return None
    widths = hand_widths(robot, solids, T)
    widths = widths[np.isfinite(widths)]
    opening = hand_size(robot).opening
    if len(widths) == 0 or widths.min() < opening:
        return None
    return (
        f"the object is at least {widths.min():.3g} m wide between the fingers, and "
        f"the hand of {robot.name} opens by {opening:.3g} m"
    )
