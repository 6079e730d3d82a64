"""Everything there is to know about a robot before it is used."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.robot_file import RobotDescription
from mmplan.robot_setup.evidence import Evidence, gather
from mmplan.robot_setup.link_bodies import LinkBodies, link_bodies
from mmplan.robot_setup.measurements import (
    IkMeasurement,
    measure_collision,
    measure_ik,
)
from mmplan.robot_setup.self_collisions import SelfCollisions
from mmplan.shapes import Array

_SAMPLES = 2000  # configurations that pairs are looked at in
_POSES = 500  # of the inverse kinematics


class JointFacts(NamedTuple):
    """A joint of a group; limits in rad or m and per s, None where it has none."""

    group: str
    name: str
    lower: float | None
    upper: float | None
    velocity: float
    acceleration: float
    follows: str | None


class PairFacts(NamedTuple):
    """Two links, why they are not checked (None: they are), and what samples say."""

    first: str
    second: str
    reason: str | None
    evidence: Evidence


class ToolFacts(NamedTuple):
    """The tool frame, its pose (4, 4) in the frame of the link that carries it."""

    frame: str
    link: str
    T_link_tool: Array


@dataclass(frozen=True, eq=False)
class Inspection:
    """What was found out about a robot; `collision` is the time of a check, s."""

    robot: Robot
    joints: tuple[JointFacts, ...]
    moved_by: dict[str, str]  # link with bodies -> joint, "" for none
    tool: ToolFacts
    bodies: tuple[LinkBodies, ...]
    pairs: tuple[PairFacts, ...]
    named_collisions: dict[str, tuple[str, ...]]  # configuration -> pairs that overlap
    ik: IkMeasurement
    collision: float


def inspect(description: RobotDescription, samples: int = _SAMPLES) -> Inspection:
    """Inspect a robot, its pairs of links in some samples; takes a few seconds.

    Raises:
        InputError: The robot's files are faulty.
    """
    robot = build_robot(description)
    links = SelfCollisions(robot)
    reasons = {frozenset(p[:2]): p[2] for p in description.disabled_pairs}
    evidence = gather(robot, links, samples)
    pairs = tuple(
        PairFacts(*pair, reasons.get(frozenset(pair)), evidence[pair])
        for pair in links.pairs
    )
    return Inspection(
        robot=robot,
        joints=tuple(_joints(robot)),
        moved_by={
            robot.link_of(body): _joint_name(robot.model, body.parentJoint)
            for body in robot.geometry.geometryObjects
        },
        tool=_tool(robot),
        bodies=tuple(link_bodies(robot, description)),
        pairs=pairs,
        named_collisions=dict(_named_collisions(robot, links, pairs)),
        ik=measure_ik(robot, _POSES),
        collision=measure_collision(robot, _POSES),
    )


def _joints(robot: Robot) -> Iterator[JointFacts]:
    leaders = {
        f.follower: _name_at(robot.model, f.leader) for f in robot.hand.followers
    }
    groups = {"base": robot.base, "arm": robot.arm, "hand": robot.hand}
    for title, group in groups.items():
        for k, name in enumerate(group.names):
            free = bool(group.wraps[k])
            yield JointFacts(
                group=title,
                name=name,
                lower=None if free else float(group.lower[k]),
                upper=None if free else float(group.upper[k]),
                velocity=float(group.velocity[k]),
                acceleration=float(group.acceleration[k]),
                follows=leaders.get(int(group.indices[k])),
            )


def _joint_name(model: pin.Model, joint: int) -> str:
    return str(model.names[joint]) if joint else ""


def _name_at(model: pin.Model, place: int) -> str:
    """The name of the joint at a place in q."""
    joints = range(1, model.njoints)
    return next(str(model.names[j]) for j in joints if model.joints[j].idx_q == place)


def _tool(robot: Robot) -> ToolFacts:
    """The tool frame against the next link with bodies above it, or its joint."""
    model, tool = robot.model, robot.model.frames[robot.tool_frame]
    with_bodies = {int(body.parentFrame) for body in robot.geometry.geometryObjects}
    frame = int(tool.parentFrame)
    while frame and frame not in with_bodies:
        frame = int(model.frames[frame].parentFrame)
    link = model.frames[frame]
    T_link_joint = link.placement.inverse()
    if link.parentJoint != tool.parentJoint:  # no body between the last joint and it
        return ToolFacts(
            tool.name, _joint_name(model, tool.parentJoint), robot.T_joint_tool
        )
    return ToolFacts(tool.name, link.name, (T_link_joint * tool.placement).homogeneous)


def _named_collisions(
    robot: Robot, links: SelfCollisions, pairs: tuple[PairFacts, ...]
) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Named configurations at which checked pairs overlap, the hand open or closed."""
    checked = np.array([pair.reason is None for pair in pairs])
    for name, q_arm in robot.configurations.items():
        q = np.tile(robot.q_neutral, (2, 1))
        q[:, robot.arm.indices] = q_arm
        q[:, robot.hand.indices] = [robot.hand_open, robot.hand_closed]
        hit = links.overlaps(q, checked).any(axis=0)
        if hit.any():
            yield name, tuple(" / ".join(links.pairs[k]) for k in np.flatnonzero(hit))
