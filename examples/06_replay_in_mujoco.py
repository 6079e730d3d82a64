"""Replay a plan in MuJoCo, with nothing of mmplan.

    mmplan solve wineglass --seed 7 -o plan.json
    mmplan robot urdf puma_mobile > robot.urdf
    mmplan export plan.json --to mjcf -o scene.xml
    python examples/06_replay_in_mujoco.py plan.json robot.urdf scene.xml

Needs numpy and mujoco. Every 2 ms of the plan MuJoCo says what touches what, links of
the robot among themselves included. The replay fails if anything does but the hand, the
object and what the object stands on, if an object is not where the hand takes it, or if
it is not at its goal in the end.

MuJoCo leaves out links that a joint connects, and this program those that overlap
before the robot moves: neighbours whose bodies are larger than they. MuJoCo takes
meshes for their convex hulls; a robot whose bodies are hollow may be found to touch.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

STEP = 0.002  # s
DEEPEST = 0.001  # m: objects may press that deep into what they stand on
GOAL_TOLERANCE = 1e-3  # m


def main(plan_file: str, urdf_file: str, scene_file: str) -> int:
    """Replay the plan; the exit code is 0 if it does what it promises."""
    plan = json.loads(Path(plan_file).read_text(encoding="utf-8"))
    model = robot_in_scene(urdf_file, scene_file)
    replay = Replay(model, plan)
    contacts: dict[tuple[str, str], float] = {}
    segments = [s for task in plan["tasks"] for s in task["segments"]]
    next(replay.run(segments[0]))
    standing = {pair for pair, _ in replay.contacts()}  # base on floor, before it moves
    neighbours = {pair for pair in standing if replay.links(pair) == set(pair)}
    for segment in segments:
        for _ in replay.run(segment):
            for pair, depth in replay.contacts():
                rests = pair in standing and depth <= DEEPEST
                if not rests and pair not in neighbours:
                    contacts[pair] = max(depth, contacts.get(pair, 0.0))
    faults = list(replay.faults(contacts))
    for first, second in sorted(contacts):
        print(f"{first} touches {second}: {1000 * contacts[first, second]:.2f} mm deep")
    for fault in faults:
        print(f"FAULT: {fault}")
    if not faults:
        print(f"replayed {plan['duration']:.2f} s: every object is at its goal")
    return 1 if faults else 0


def robot_in_scene(urdf_file: str, scene_file: str) -> mujoco.MjModel:
    """The robot's URDF and the scene as one model; no link is merged into another."""
    robot = mujoco.MjSpec.from_file(urdf_file)
    robot.compiler.fusestatic = False
    robot.compiler.discardvisual = True
    for body in robot.bodies:
        for geom in body.geoms:  # meets the scene, whose bits are 1, and itself
            geom.contype, geom.conaffinity = 2, 3
    scene = mujoco.MjSpec.from_file(scene_file)
    robot.compiler.boundmass = robot.compiler.boundinertia = 1e-6
    robot.compiler.balanceinertia = True  # nothing here depends on inertia
    scene.attach(robot, frame=scene.worldbody.add_frame(), prefix="robot:")
    return scene.compile()


class Replay:
    """Moves the robot's joints and the objects as the plan says."""

    def __init__(self, model: mujoco.MjModel, plan: dict[str, Any]) -> None:
        """Find the joints and the objects of the plan in the model."""
        self.model, self.data = model, mujoco.MjData(model)
        self.plan = plan
        names = plan["robot"]["joints"]
        self.places = [model.joint(f"robot:{name}").qposadr[0] for name in names]
        self.tool = model.body(f"robot:{plan['robot']['tool']}").id
        first, last = plan["tasks"][0]["segments"][0], plan["tasks"][-1]["segments"][-1]
        self.objects = list(first["objects"])
        self.starts = {n: model.joint(n).qposadr[0] for n in self.objects}
        self.goals = last["objects"]  # they do not move after the last release
        self.jumps = dict.fromkeys(self.objects, 0.0)  # m, between two segments

    def run(self, segment: dict[str, Any]) -> Iterator[float]:
        """Go through the times of a segment; the model is as the plan says at each."""
        arrays = [np.array(segment[k]) for k in ("times", "positions", "velocities")]
        for time in np.arange(0.0, arrays[0][-1] + STEP, STEP):
            self.data.qpos[self.places] = hermite(min(time, arrays[0][-1]), *arrays)
            mujoco.mj_kinematics(self.model, self.data)
            for name, T in segment["objects"].items():
                held = segment["attached"].get(name)
                at = np.array(T) if held is None else self.carried(held)
                if time == 0.0:
                    self.jumps[name] = max(self.jumps[name], self.away(name, at))
                self.place(name, at)
            mujoco.mj_forward(self.model, self.data)
            yield time

    def carried(self, T_tool_object: list[list[float]]) -> np.ndarray:
        """The pose T_world_object (4, 4) of something in the hand."""
        T_world_tool = np.eye(4)
        T_world_tool[:3, :3] = self.data.xmat[self.tool].reshape(3, 3)
        T_world_tool[:3, 3] = self.data.xpos[self.tool]
        return T_world_tool @ np.array(T_tool_object)

    def place(self, name: str, T: np.ndarray) -> None:
        """Put an object at a pose (4, 4)."""
        start = self.starts[name]
        self.data.qpos[start : start + 3] = T[:3, 3]
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, np.ascontiguousarray(T[:3, :3]).ravel())
        self.data.qpos[start + 3 : start + 7] = quat

    def contacts(self) -> Iterator[tuple[tuple[str, str], float]]:
        """What touches what, by name, and how deep (m)."""
        for contact in self.data.contact:
            bodies = [self.model.geom_bodyid[geom] for geom in contact.geom]
            names = sorted(self.model.body(body).name for body in bodies)
            yield (names[0], names[1]), -float(contact.dist)

    def faults(self, contacts: dict[tuple[str, str], float]) -> Iterator[str]:
        """What the plan does and must not: contacts, objects that are elsewhere."""
        hand = self.hand()
        for pair, depth in contacts.items():
            links = self.links(pair)
            things = {n for n in pair if n in self.objects}
            rests = not links and things and depth <= DEEPEST + 1e-5
            if not (rests or (links and links <= hand and things)):
                yield f"{' touches '.join(pair)}: {1000 * depth:.2f} mm deep"
        for name, goal in self.goals.items():
            if self.away(name, np.array(goal)) > GOAL_TOLERANCE:
                yield f"{name} is {self.away(name, np.array(goal)):.4f} m from its goal"
            if self.jumps[name] > GOAL_TOLERANCE:
                yield f"{name} jumps by {self.jumps[name]:.4f} m when taken or left"

    def away(self, name: str, T: np.ndarray) -> float:
        """How far an object is from a pose (4, 4), m."""
        start = self.starts[name]
        return float(np.linalg.norm(self.data.qpos[start : start + 3] - T[:3, 3]))

    def links(self, names: Iterable[str]) -> set[str]:
        """Those of some names that are links of the robot."""
        return {name for name in names if name.startswith("robot:")}

    def hand(self) -> set[str]:
        """The links that the joints of the hand move."""
        fingers = len(self.plan["tasks"][0]["grasp"]["hand_open"])
        names = self.plan["robot"]["joints"][-fingers:]
        bodies = {int(self.model.joint(f"robot:{n}").bodyid[0]) for n in names}
        return {self.model.body(body).name for body in bodies}


def hermite(
    time: float, times: np.ndarray, positions: np.ndarray, velocities: np.ndarray
) -> np.ndarray:
    """Joint positions at a time: the cubic curve that the plan is made of."""
    k = int(np.clip(np.searchsorted(times, time, "right") - 1, 0, len(times) - 2))
    h = times[k + 1] - times[k]
    s = (time - times[k]) / h
    start = (2 * s**3 - 3 * s**2 + 1) * positions[k]
    start += (s**3 - 2 * s**2 + s) * h * velocities[k]
    end = (3 * s**2 - 2 * s**3) * positions[k + 1]
    return start + end + (s**3 - s**2) * h * velocities[k + 1]


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
