"""A robot's composed URDF -> Pinocchio's model and collision bodies."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from mmplan.exceptions import InputError
from mmplan.files.urdf_edit import limit
from mmplan.robot_file import RobotDescription

# A continuous joint would get two coordinates, (cos, sin); with limits it gets one.
_WITHOUT_END = 1e9  # rad


def robot_model(
    description: RobotDescription,
) -> tuple[pin.Model, pin.GeometryModel]:
    """The kinematic model and the collision bodies, without any pairs yet.

    Every joint has one coordinate; those that turn without end have infinite limits.

    Raises:
        InputError: Pinocchio cannot read the URDF.
    """
    urdf = _with_one_coordinate_a_joint(description)
    try:
        model = pin.buildModelFromXML(urdf)
        geometry = pin.buildGeomFromUrdfString(
            model, urdf, pin.GeometryType.COLLISION, package_dirs=[]
        )
    except (RuntimeError, ValueError) as error:
        message = f"{description.path}: its URDF cannot be read: {error}"
        raise InputError(message) from error
    for name, joint in description.facts.joints.items():
        if joint.continuous:
            place = model.joints[model.getJointId(name)].idx_q
            model.lowerPositionLimit[place] = -np.inf
            model.upperPositionLimit[place] = np.inf
    _make_convex(model, geometry, description.collision)
    return model, geometry


def _with_one_coordinate_a_joint(description: RobotDescription) -> str:
    root = ET.fromstring(description.urdf)
    for joint in root.findall("joint"):
        if joint.get("type") == "continuous":
            limit(joint, lower=-_WITHOUT_END, upper=_WITHOUT_END)
    return ET.tostring(root, encoding="unicode")


def _make_convex(
    model: pin.Model, geometry: pin.GeometryModel, kinds: Mapping[str, str]
) -> None:
    """Replace meshes by their convex hulls, except for links that keep them."""
    for body in geometry.geometryObjects:
        link = model.frames[body.parentFrame].name
        mesh = body.geometry
        if hasattr(mesh, "buildConvexHull") and kinds.get(link) != "mesh":
            mesh.buildConvexHull(True, "Qt")
            body.geometry = mesh.convex
