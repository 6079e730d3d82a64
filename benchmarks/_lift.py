"""A robot's hand without its arm, around an object in free space, in MuJoCo."""

from __future__ import annotations

from typing import NamedTuple

import coal
import mujoco
import numpy as np

from mmplan.collision import HandCloser, Scenery
from mmplan.collision.fingers import Fingers
from mmplan.collision.hand_room import HandRoom
from mmplan.problem import Object
from mmplan.robot import Robot
from mmplan.shapes import Array

SETTLE, RISE, HOLD = 0.5, 1.0, 0.5  # s
LIFT = 0.2  # m
TIME_STEP = 0.002
# Torsional friction is an arm in m for MuJoCo; 2/3 of a soft disc of 5 mm.
TORSION_ARM = 2.0 / 3.0 * 0.005


class Drift(NamedTuple):
    """How far the lift left the object from where the grasp had it in the hand."""

    distance: float  # m, of its centre of mass
    angle: float  # rad


def lift(item: Object, robot: Robot, T_object_tool: Array, opened: Array) -> Drift:
    """Close the hand at a tool pose (4, 4) and raise it; where the object then is.

    `opened` (hand joints,) is the hand before it closes. Each finger presses with its
    share of the hand's greatest force. Until it has closed, there is no gravity.
    """
    closer = HandCloser(robot, Scenery.solids_of_object(item))
    text = scene(item, robot, closer, T_object_tool, opened)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    first = place(data)
    for step in range(int((SETTLE + RISE + HOLD) / TIME_STEP)):
        time = step * TIME_STEP
        data.ctrl[:2] = closer.force / 2.0
        data.ctrl[2] = LIFT * np.clip((time - SETTLE) / RISE, 0.0, 1.0)
        model.opt.gravity[2] = -9.81 if time > 0.6 * SETTLE else 0.0
        mujoco.mj_step(model, data)
    turn = data.body("thing").xmat.reshape(3, 3)
    angle = np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0))
    return Drift(float(np.linalg.norm(place(data) - first)), float(angle))


def place(data: mujoco.MjData) -> Array:
    """Where the object's centre of mass is, seen from the hand, (3,)."""
    from_hand: Array = data.body("thing").xipos - data.body("hand").xpos
    return from_hand


def scene(
    item: Object, robot: Robot, closer: HandCloser, T_object_tool: Array, opened: Array
) -> str:
    """The hand around the object as a model of MuJoCo, z up, object at the origin."""
    fingers = Fingers(robot)
    hand = opened[None]
    palm = fingers.placed(T_object_tool[None], hand, HandRoom(robot).palm)
    closing = T_object_tool[:3, 1]
    parts: list[str] = []
    for sign, drive in zip((-1.0, 1.0), fingers.drives, strict=True):
        finger = next(iter(drive.fingers.values()))
        axis = " ".join(map(str, sign * closing))
        shapes = boxes(fingers.placed(T_object_tool[None], hand, finger))
        parts.append(
            f'<body><joint name="f{len(parts)}" type="slide" axis="{axis}" '
            f'damping="20"/>{shapes}<inertial pos="0 0 0" mass="0.05" '
            'diaginertia="1e-4 1e-4 1e-4"/></body>'
        )
    meshes, geoms = [], []
    for i, solid in enumerate(Scenery.solids_of_object(item)):
        points = " ".join(f"{v:.7g}" for v in corners(solid.geometry).ravel())
        meshes.append(f'<mesh name="m{i}" vertex="{points}"/>')
        geoms.append(f'<geom type="mesh" mesh="m{i}" contype="2" conaffinity="1"/>')
    centre = " ".join(map(str, closer.centre_of_mass))
    assert item.mass is not None
    inertia = 0.4 * item.mass * (0.6 * closer.size) ** 2
    friction = f"{item.friction} {item.friction * TORSION_ARM} 0.0001"
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
      <inertial pos="{centre}" mass="{item.mass}"
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
