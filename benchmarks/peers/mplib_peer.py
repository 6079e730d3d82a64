"""mplib's RRTConnect and OMPL's simplification, as its planner calls them.

Its resolution cannot be set: OMPL's default, a hundredth of the space's extent.
"""

from __future__ import annotations

import time
from pathlib import Path

import mplib
import numpy as np
from mplib.collision_detection.fcl import Box, CollisionObject, Cylinder, Sphere


class Peer:
    """The planner in one world."""

    def __init__(self, world: dict, step: float, reach: float, time_limit: float):
        """Build the world; `reach` is the longest edge, rad."""
        del step
        self._planner = mplib.Planner(
            urdf=_with_bare_names(Path(world["urdf"])),
            srdf=world["srdf"],
            move_group=world["tip"],
            user_joint_names=world["joints"],
            use_convex=True,
        )
        for thing in world["obstacles"]:
            pose = mplib.Pose(np.array(thing["pose"]))
            body = CollisionObject(_geometry(thing), pose)
            self._planner.planning_world.add_object(thing["name"], body)
        self._start, self._goal = np.array(world["start"]), np.array(world["goal"])
        self._options = {"time": time_limit, "range": reach, "simplify": False}

    def plan(self, seed: int) -> dict:
        """A path, and the same simplified."""
        mplib.set_global_seed(seed + 1)  # 0 is none
        planner = self._planner.planner
        begin = time.process_time()
        status, first = planner.plan(self._start, [self._goal], **self._options)
        found = time.process_time()
        if status != "Exact solution":
            return {"first_seconds": found - begin, "message": status}
        path = planner.simplify_path(first)
        end = time.process_time()
        return {
            "first": first.tolist(),
            "first_seconds": found - begin,
            "path": path.tolist(),
            "seconds": end - begin,
        }


def _with_bare_names(urdf: Path) -> Path:
    """The URDF with the names of its meshes relative to it, as mplib wants them."""
    bare = urdf.with_name("bare_names.urdf")
    bare.write_text(urdf.read_text().replace(f"{urdf.parent}/", ""))
    return bare


def _geometry(thing: dict) -> Box | Cylinder | Sphere:
    if thing["type"] == "box":
        return Box(np.array(thing["size"]))
    if thing["type"] == "cylinder":
        return Cylinder(thing["radius"], thing["length"])
    return Sphere(thing["radius"])
