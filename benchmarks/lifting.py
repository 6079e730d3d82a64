"""Do grasps of good quality hold? Judged by MuJoCo, which shares nothing with mmplan.

For each mesh: antipodal grasps of the Puma's hand, rated by epsilon with the object's
weight. In the simulation the hand alone, without the arm, stands around the object in
free space, closes with half of its force and then rises by 0.2 m in a second, while
gravity pulls along the object's -z. Both fingers move alike, as those of most
parallel grippers do, and the palm does not give way. A grasp holds if the object is
then still within 5 cm of where it was in the hand. Printed are the share that holds in
the top decile and in the bottom half by quality, and the rank correlation of quality
and holding. Where all grasps are rated 0, none has a weight margin, and there is no
top decile.

    python benchmarks/lifting.py [--grasps 100] [--objects mug bowl ...]

Needs the extras `meshes` and `render` (for MuJoCo).
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path

import coal
import mujoco
import numpy as np
from _objects import OBJECTS
from scipy.stats import spearmanr

from mmplan.collision import HandCloser, Scenery
from mmplan.collision.fingers import Fingers
from mmplan.collision.hand_room import HandRoom
from mmplan.grasp_values import sampled
from mmplan.problem import Object, Problem, ScoreSettings, Task
from mmplan.robot import Robot
from mmplan.robot_build import load_robot
from mmplan.scoring.grasp_quality import Hold, WrenchQuality
from mmplan.shapes import Array, Mesh

MASS, FRICTION = 0.3, 0.6
FORCE = 20.0  # N, of each finger: half of what the Puma's can
LIFT, HELD = 0.2, 0.05  # m
SETTLE, RISE, HOLD = 0.5, 1.0, 0.5  # s
TIME_STEP = 0.002
# Torsional friction is an arm in m for MuJoCo; 2/3 of a soft disc of 5 mm.
TORSION_ARM = 2.0 / 3.0 * 0.005


def rated_grasps(item: Object, robot: Robot, n: int) -> tuple[Array, Array, Array]:
    """Tool poses (n, 4, 4) that close, the opened hands (n, h) and qualities (n,)."""
    solids = Scenery.solids_of_object(item)
    closer = HandCloser(robot, solids)
    task = Task(item.name, np.eye(4))
    problem = Problem(
        "lifting",
        robot,
        robot.q_neutral,
        np.zeros((2, 2)),
        (),
        (item,),
        (task,),
        score=ScoreSettings(quality="epsilon"),
    )
    T = sampled(item, robot, n, 0).T_object_tool
    closings = closer.close(T)
    quality = WrenchQuality(problem, task, closer)(
        Hold(np.zeros((len(T), 0)), T, closings)
    )
    held = closings.touches
    return T[held], closings.opened[held], quality[held]


def holds(item: Object, robot: Robot, T_object_tool: Array, opened: Array) -> bool:
    """Whether the hand, closed at a pose and raised, still has the object."""
    model = mujoco.MjModel.from_xml_string(scene(item, robot, T_object_tool, opened))
    data = mujoco.MjData(model)
    first = None
    for step in range(int((SETTLE + RISE + HOLD) / TIME_STEP)):
        time = step * TIME_STEP
        data.ctrl[:2] = FORCE
        data.ctrl[2] = LIFT * np.clip((time - SETTLE) / RISE, 0.0, 1.0)
        # Until the fingers have closed, the object rests on nothing but air.
        model.opt.gravity[2] = -9.81 if time > 0.6 * SETTLE else 0.0
        mujoco.mj_step(model, data)
        if first is None and time > 0.6 * SETTLE:
            first = offset(data)
    return bool(np.linalg.norm(offset(data) - first) < HELD)


def offset(data: mujoco.MjData) -> Array:
    """Where the object is, seen from the hand, (3,)."""
    return data.body("thing").xpos - data.body("hand").xpos


def scene(item: Object, robot: Robot, T_object_tool: Array, opened: Array) -> str:
    """The hand around the object as a model of MuJoCo, z up, object at the origin."""
    fingers = Fingers(robot)
    hand = opened[None]
    palm = fingers.placed(T_object_tool[None], hand, HandRoom(robot).palm)
    closing = T_object_tool[:3, 1]
    parts = []
    for sign, drive in zip((-1.0, 1.0), fingers.drives, strict=True):
        finger = next(iter(drive.fingers.values()))
        axis = " ".join(map(str, sign * closing))
        geoms = boxes(fingers.placed(T_object_tool[None], hand, finger))
        parts.append(
            f'<body><joint name="f{len(parts)}" type="slide" axis="{axis}" '
            f'damping="20"/>{geoms}<inertial pos="0 0 0" mass="0.05" '
            'diaginertia="1e-4 1e-4 1e-4"/></body>'
        )
    meshes, geoms = [], []
    for i, solid in enumerate(Scenery.solids_of_object(item)):
        points = " ".join(f"{v:.7g}" for v in corners(solid.geometry).ravel())
        meshes.append(f'<mesh name="m{i}" vertex="{points}"/>')
        geoms.append(f'<geom type="mesh" mesh="m{i}" contype="2" conaffinity="1"/>')
    closer = HandCloser(robot, Scenery.solids_of_object(item))
    centre = " ".join(map(str, closer.centre_of_mass))
    inertia = 0.4 * MASS * (0.6 * closer.size) ** 2
    friction = f"{FRICTION} {FRICTION * TORSION_ARM} 0.0001"
    return f"""
<mujoco>
  <option timestep="{TIME_STEP}" cone="elliptic" impratio="10" integrator="implicitfast"
   noslip_iterations="3"/>
  <default><geom friction="{friction}" condim="4" density="0"
   solref="0.004 1" contype="1" conaffinity="2"/></default>
  <asset>{"".join(meshes)}</asset>
  <worldbody>
    <body name="hand"><joint name="lift" type="slide" axis="0 0 1" damping="50"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      {boxes(palm)}{"".join(parts)}</body>
    <body name="thing"><freejoint/>
      <inertial pos="{centre}" mass="{MASS}"
       diaginertia="{inertia} {inertia} {inertia}"/>{"".join(geoms)}</body>
  </worldbody>
  <equality><joint joint1="f0" joint2="f1" solref="0.004 1"/></equality>
  <actuator><motor joint="f0"/><motor joint="f1"/>
    <position joint="lift" kp="20000" kv="400"/></actuator>
</mujoco>"""


def boxes(placed: list[tuple[coal.CollisionGeometry, Array]]) -> str:
    """Geoms of the hand's bodies, which are boxes."""
    geoms = []
    for geometry, T in placed:
        size = " ".join(map(str, np.ravel(geometry.halfSide)))
        x, y = T[0, :3, 0], T[0, :3, 1]
        axes = " ".join(map(str, [*x, *y]))
        position = " ".join(map(str, T[0, :3, 3]))
        geoms.append(
            f'<geom type="box" size="{size}" pos="{position}" xyaxes="{axes}"/>'
        )
    return "".join(geoms)


def corners(geometry: coal.CollisionGeometry) -> Array:
    """The corners (n, 3) of a convex piece."""
    return np.array(geometry.points()).reshape(-1, 3)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one row for each object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grasps", type=int, default=100)
    parser.add_argument("--objects", nargs="*", default=list(OBJECTS))
    options = parser.parse_args(arguments)
    robot = load_robot("puma_mobile")
    tops, all_quality, all_held = [], [], []
    print("| object | grasps | top decile holds | bottom half | rank correlation |")
    print("|---|---|---|---|---|")
    for name in options.objects:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{name}.stl"
            OBJECTS[name](1).export(path)
            item = Object(name, Mesh(path), np.eye(4), {}, MASS, FRICTION)
            T, opened, quality = rated_grasps(item, robot, options.grasps)
            held = np.array(
                [holds(item, robot, *row) for row in zip(T, opened, strict=True)]
            )
        order = np.argsort(-quality, kind="stable")
        top = held[order[: max(1, len(order) // 10)]]
        if not quality.any():
            top = np.empty(0, np.bool_)
        tops.append(top)
        all_quality.append(quality)
        all_held.append(held)
        bottom = held[order[len(order) // 2 :]].mean()
        best = f"{top.mean():.0%}" if len(top) else "all are rated 0"
        row = [name, len(T), best, f"{bottom:.0%}", rank(quality, held)]
        print("|", *(f"{cell} |" for cell in row), flush=True)
    quality, held = np.concatenate(all_quality), np.concatenate(all_held)
    share = f"{np.concatenate(tops).mean():.0%}"
    print("| all |", len(held), f"| {share} | | {rank(quality, held)} |")


def rank(quality: Array, held: Array) -> str:
    """The rank correlation of quality and holding; none where either is constant."""
    if np.ptp(quality) == 0.0:
        return ""
    if held.all() or not held.any():
        return "all hold" if held.all() else "none holds"
    return f"{spearmanr(quality, held).statistic:.2f}"


if __name__ == "__main__":
    main()
