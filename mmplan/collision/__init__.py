"""The one door to coal: solids, the collision world, batched checks, distances."""

from mmplan.collision.antipodal import antipodal_poses
from mmplan.collision.assembly import Assembly, Body, TouchRules
from mmplan.collision.bisection import coarse_to_fine
from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.closing import Closings, HandCloser
from mmplan.collision.compiling import compile_motions, planning_clock
from mmplan.collision.distances import LinkDistances
from mmplan.collision.hand_size import hand_size
from mmplan.collision.hand_widths import hand_widths
from mmplan.collision.inertia import inertia_of
from mmplan.collision.levers import body_corners, joint_levers
from mmplan.collision.planner_space import ROUNDING, PlannerSpace
from mmplan.collision.regions import depth_in_region
from mmplan.collision.requests import make_exact
from mmplan.collision.scenery import Scenery
from mmplan.collision.solids import solids_of_obstacle
from mmplan.collision.supports import clearances, overlaps, supports
from mmplan.collision.vicinity import LinkBounds
from mmplan.collision.world import (
    CONTACT_ZONE,
    TOUCH_TOLERANCE,
    CollisionWorld,
    Contact,
)

__all__ = [
    "CONTACT_ZONE",
    "ROUNDING",
    "TOUCH_TOLERANCE",
    "Assembly",
    "Body",
    "Bounds",
    "Closings",
    "CollisionWorld",
    "Contact",
    "HandCloser",
    "LinkBounds",
    "LinkDistances",
    "PlannerSpace",
    "Scenery",
    "TouchRules",
    "antipodal_poses",
    "body_corners",
    "clearances",
    "coarse_to_fine",
    "compile_motions",
    "depth_in_region",
    "hand_size",
    "hand_widths",
    "inertia_of",
    "joint_levers",
    "local_bounds",
    "make_exact",
    "moved_bounds",
    "overlaps",
    "planning_clock",
    "solids_of_obstacle",
    "supports",
]
