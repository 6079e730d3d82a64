"""Grasp families: how an object can be held, as a few genes within bounds.

A family maps genes to poses of the tool frame in the object's frame; the tool's z is
the approach direction and its y the direction in which the fingers close.
"""

from mmplan.grasps.axis import Axis
from mmplan.grasps.family import GraspFamily
from mmplan.grasps.mixture import Mixture
from mmplan.grasps.rim import Rim

__all__ = ["Axis", "GraspFamily", "Mixture", "Rim"]
