"""Grasp families: how an object can be held, as a few genes within bounds.

A family maps genes to poses of the tool frame in the object's frame; the tool's z is
the approach direction and its y the direction in which the fingers close.
"""

from mmplan.grasps.axis import Axis
from mmplan.grasps.box_faces import FACES, BoxFaces
from mmplan.grasps.cylinder_side import CylinderSide
from mmplan.grasps.cylinder_top import CylinderTop
from mmplan.grasps.family import GraspFamily
from mmplan.grasps.handle import Handle
from mmplan.grasps.mixture import Mixture
from mmplan.grasps.poses import Poses
from mmplan.grasps.regions import regions
from mmplan.grasps.rim import Rim
from mmplan.grasps.sphere import SphereGrasps
from mmplan.grasps.tsr import TaskSpaceRegion

__all__ = [
    "FACES",
    "Axis",
    "BoxFaces",
    "CylinderSide",
    "CylinderTop",
    "GraspFamily",
    "Handle",
    "Mixture",
    "Poses",
    "Rim",
    "SphereGrasps",
    "TaskSpaceRegion",
    "regions",
]
