"""sscbirrt's CBiRRT in a MuJoCo world, both trees marching until blocked."""

from __future__ import annotations

import time
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
from sscbirrt import CBiRRTConfig
from sscbirrt.mujoco import Arm, plan

_TYPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
}


class Peer:
    """The planner in one world."""

    def __init__(self, world: dict, step: float, reach: float, time_limit: float):
        """Build the model; `step` is the resolution, `reach` the longest edge, rad."""
        spec = mujoco.MjSpec.from_string(_with_compiler(world["urdf"]))
        spec.body(spec.bodies[-1].name).add_site(name="tip")
        for pair in ET.parse(world["srdf"]).getroot().findall("disable_collisions"):
            spec.add_exclude(bodyname1=pair.get("link1"), bodyname2=pair.get("link2"))
        for thing in world["obstacles"]:
            _add(spec, thing)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        limits = np.array(world["lower"]), np.array(world["upper"])
        self._arm = Arm(self._model, world["joints"], "tip", joint_limits=limits)
        self._start, self._goal = np.array(world["start"]), np.array(world["goal"])
        self._config = CBiRRTConfig(
            timeout=time_limit,
            max_iterations=10**9,
            edge_resolution=step,
            step_size=reach,
            smooth_path=False,
        )

    def plan(self, seed: int) -> dict:
        """A path, not smoothed."""
        begin = time.process_time()
        found = plan(
            self._model,
            self._data,
            self._arm,
            start=self._start,
            goal=self._goal,
            config=self._config,
            seed=seed,
            backend="native",
        )
        seconds = time.process_time() - begin
        if not found.success:
            return {"first_seconds": seconds, "message": str(found.failure_reason)}
        return {
            "first": [np.asarray(q).tolist() for q in found.path],
            "first_seconds": seconds,
        }


def _with_compiler(urdf: str) -> str:
    """The URDF with bodies that stay apart though joints between them are fixed."""
    root = ET.parse(urdf).getroot()
    for link in root.findall("link"):
        for inertial in link.findall("inertial"):  # MuJoCo takes no tiny ones
            link.remove(inertial)
    settings = {
        "fusestatic": "false",
        "strippath": "false",
        "boundmass": "0.001",
        "boundinertia": "0.000001",
    }
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", settings)
    return ET.tostring(root, encoding="unicode")


def _add(spec: mujoco.MjSpec, thing: dict) -> None:
    pose = np.array(thing["pose"])
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, pose[:3, :3].ravel())
    sizes = {
        "box": lambda: [0.5 * edge for edge in thing["size"]],
        "cylinder": lambda: [thing["radius"], 0.5 * thing["length"], 0.0],
        "sphere": lambda: [thing["radius"], 0.0, 0.0],
    }
    spec.worldbody.add_geom(
        name=thing["name"],
        type=_TYPES[thing["type"]],
        size=sizes[thing["type"]](),
        pos=pose[:3, 3],
        quat=quat,
    )
