"""The one door to coal: solids, the collision world, batched checks, distances."""

from mmplan.collision.assembly import Assembly, Body, TouchRules
from mmplan.collision.scenery import Scenery
from mmplan.collision.static_scene import StaticScene
from mmplan.collision.supports import supports
from mmplan.collision.world import (
    CONTACT_ZONE,
    TOUCH_TOLERANCE,
    CollisionWorld,
    Contact,
)

__all__ = [
    "CONTACT_ZONE",
    "TOUCH_TOLERANCE",
    "Assembly",
    "Body",
    "CollisionWorld",
    "Contact",
    "Scenery",
    "StaticScene",
    "TouchRules",
    "supports",
]
