"""roboplan's RRT-Connect and its shortcuts."""

from __future__ import annotations

import time
from itertools import combinations
from pathlib import Path

import numpy as np
from roboplan import core, rrt

_COLOR = np.array([0.5, 0.5, 0.5, 1.0])


class Peer:
    """The planner in one world."""

    def __init__(self, world: dict, step: float, reach: float, time_limit: float):
        """Build the scene; `step` is the resolution, `reach` the longest edge, rad."""
        description = core.loadUrdfSceneDescription(world["urdf"])
        self._scene = core.Scene("peer", description)
        self._scene.importSrdf(Path(world["srdf"]).read_text(encoding="utf-8"))
        for thing in world["obstacles"]:
            self._add(thing)
        # It would check what stands still against each other too.
        still = [*world["still"], *(thing["name"] for thing in world["obstacles"])]
        self._scene.setCollisions(list(combinations(still, 2)), False)
        group = world["group"]
        self._options = rrt.RRTOptions(
            group_name=group,
            max_nodes=10**7,
            max_connection_distance=reach,
            collision_check_step_size=step,
            max_planning_time=time_limit,
            rrt_connect=True,
        )
        self._shortcuts = {"group_name": group, "max_step_size": step}
        self._start, self._goal = (
            core.JointConfiguration(world["joints"], np.array(world[end]))
            for end in ("start", "goal")
        )

    def _add(self, thing: dict) -> None:
        where = thing["name"], "universe"
        pose = np.asfortranarray(thing["pose"])
        if thing["type"] == "box":
            box = core.Box(*thing["size"])
            self._scene.addBoxGeometry(*where, box, pose, _COLOR)
        elif thing["type"] == "cylinder":
            cylinder = core.Cylinder(thing["radius"], thing["length"])
            self._scene.addCylinderGeometry(*where, cylinder, pose, _COLOR)
        else:
            sphere = core.Sphere(thing["radius"])
            self._scene.addSphereGeometry(*where, sphere, pose, _COLOR)

    def plan(self, seed: int) -> dict:
        """A path, and the same shortened."""
        begin = time.process_time()
        planner = rrt.RRT(self._scene, self._options)
        planner.setRngSeed(seed)
        try:
            first = planner.plan(self._start, self._goal)
        except RuntimeError as error:
            seconds = time.process_time() - begin
            return {"first_seconds": seconds, "message": str(error)}
        found = time.process_time()
        options = core.PathShortcuttingOptions(seed=seed, **self._shortcuts)
        path = core.PathShortcutter(self._scene, options).shortcut(first)
        end = time.process_time()
        return {
            "first": [q.tolist() for q in first.positions],
            "first_seconds": found - begin,
            "path": [q.tolist() for q in path.positions],
            "seconds": end - begin,
        }
