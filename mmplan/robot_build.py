"""From the description of a robot to a robot that can be computed with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import cast

import numpy as np
import pinocchio as pin

from mmplan import assets
from mmplan.exceptions import InputError
from mmplan.files.suggestions import unknown
from mmplan.ik import InverseKinematics
from mmplan.ik.solvers import SOLVERS
from mmplan.robot import BaseType, Follower, JointGroup, Robot, ScoreScales
from mmplan.robot_file import RobotDescription, load_robot_description
from mmplan.robot_measures import base_radius, reach
from mmplan.robot_model import robot_model
from mmplan.shapes import Array, read_only


def load_robot(name: str | Path) -> Robot:
    """A robot that is shipped, by its name, or that of a robot.yaml, by its path.

    Raises:
        InputError: There is no such robot, or its files are faulty.
    """
    path = assets.find_robot(str(name), Path())
    if path is None:
        raise InputError(unknown("robot", str(name), assets.robot_names()))
    return build_robot(load_robot_description(path))


def build_robot(description: RobotDescription) -> Robot:
    """The robot of a description: its model built and everything checked against it.

    Raises:
        InputError: The URDF cannot be read, or does not have what robot.yaml names.
    """
    model, geometry = robot_model(description)
    _raise_if_any(description, _faults(description, model))
    base, arm, hand = (
        _group(model, names, description)
        for names in (
            description.base_joints,
            description.arm_joints,
            description.hand_joints,
        )
    )
    _raise_if_any(description, _value_faults(description, arm, hand))
    tool_frame = int(model.getFrameId(description.tool, pin.FrameType.BODY))
    _add_pairs(description, model, geometry)
    base_joint = model.getJointId(base.names[-1]) if len(base) else 0
    return Robot(
        name=description.name,
        description=description.description,
        model=model,
        geometry=geometry,
        base=base,
        arm=arm,
        hand=hand,
        base_type=cast(BaseType, description.base_type),
        turning_radius=description.turning_radius,
        base_radius=description.base_radius or base_radius(geometry, base_joint),
        reach=description.reach or reach(model, arm, base_joint, tool_frame),
        tool_frame=tool_frame,
        hand_open=read_only(description.hand_open),
        hand_closed=read_only(description.hand_closed),
        ik=_inverse_kinematics(description, model, tool_frame),
        ik_solver=description.ik_solver,
        configurations={
            name: read_only(q) for name, q in description.configurations.items()
        },
        score_scales=ScoreScales(
            description.manipulability_scale, description.clutter_scale
        ),
        path=description.path,
    )


def with_arm_limits(robot: Robot, lower: Array, upper: Array) -> Robot:
    """The robot with other limits (arm joints,) of its arm, in rad or m.

    Raises:
        InputError: Its robot.yaml cannot be read any more.
    """
    model = robot.model.copy()
    model.lowerPositionLimit[robot.arm.indices] = lower
    model.upperPositionLimit[robot.arm.indices] = upper
    arm = replace(robot.arm, lower=read_only(lower), upper=read_only(upper))
    description = load_robot_description(robot.path)
    ik = _inverse_kinematics(description, model, robot.tool_frame)
    return replace(robot, model=model, arm=arm, ik=ik)


def _raise_if_any(description: RobotDescription, faults: Iterator[str]) -> None:
    found = [f"{description.path}: {fault}" for fault in faults]
    if found:
        raise InputError(*found)


def _faults(description: RobotDescription, model: pin.Model) -> Iterator[str]:
    """What robot.yaml names and the model lacks, or the other way round."""
    groups = {
        "base": description.base_joints,
        "arm": description.arm_joints,
        "hand": description.hand_joints,
        "acceleration": tuple(description.acceleration),
    }
    joints = list(model.names)[1:]
    for group, names in groups.items():
        for name in names:
            if name not in joints:
                yield f"{group}: no joint '{name}' among {', '.join(joints)}"
    for name in joints:
        yield from _joint_faults(description, model, name)
    yield from _link_faults(description, model)
    if description.ik_solver not in SOLVERS:
        yield f"ik.solver: no '{description.ik_solver}' among {', '.join(SOLVERS)}"


def _joint_faults(
    description: RobotDescription, model: pin.Model, name: str
) -> Iterator[str]:
    grouped = description.base_joints + description.arm_joints + description.hand_joints
    if grouped.count(name) != 1:
        yield f"joint '{name}' must belong to exactly one of base, arm and hand"
    if name not in description.acceleration:
        yield f"acceleration: no value for joint '{name}'"
    joint = model.joints[model.getJointId(name)]
    if (joint.nq, joint.nv) == (1, 1):
        yield from _limit_faults(model, joint, name)
    else:
        yield f"joint '{name}' must have one degree of freedom and position limits"


def _limit_faults(model: pin.Model, joint: pin.JointModel, name: str) -> Iterator[str]:
    lower = float(model.lowerPositionLimit[joint.idx_q])
    upper = float(model.upperPositionLimit[joint.idx_q])
    if not lower < upper:
        yield f"joint '{name}' needs position limits in the URDF, lower below upper"
    if not 0.0 < float(model.velocityLimit[joint.idx_v]) < np.inf:
        yield f"joint '{name}' needs a velocity limit above 0 in the URDF"


def _link_faults(description: RobotDescription, model: pin.Model) -> Iterator[str]:
    links = [f.name for f in model.frames if f.type == pin.FrameType.BODY]
    if description.tool not in links:
        yield f"tool: no link '{description.tool}' among {', '.join(links)}"
    for first, second, _ in description.disabled_pairs:
        for link in (first, second):
            if link not in links:
                yield f"disabled_pairs: no link '{link}' among {', '.join(links)}"


def _group(
    model: pin.Model, names: Sequence[str], description: RobotDescription
) -> JointGroup:
    indices = np.array([model.joints[model.getJointId(n)].idx_q for n in names], int)
    indices.setflags(write=False)
    return JointGroup(
        names=tuple(names),
        indices=indices,
        lower=read_only(model.lowerPositionLimit[indices]),
        upper=read_only(model.upperPositionLimit[indices]),
        velocity=read_only(model.velocityLimit[indices]),
        acceleration=read_only([description.acceleration[n] for n in names]),
        wraps=np.array([description.facts.joints[n].continuous for n in names], bool),
        followers=tuple(_followers(model, names, description)),
    )


def _followers(
    model: pin.Model, names: Sequence[str], description: RobotDescription
) -> Iterator[Follower]:
    for name in names:
        if mimic := description.mimics.get(name):
            index, leader = (
                int(model.joints[model.getJointId(n)].idx_q)
                for n in (name, mimic.leader)
            )
            yield Follower(index, leader, mimic.multiplier, mimic.offset)


def _value_faults(
    description: RobotDescription, arm: JointGroup, hand: JointGroup
) -> Iterator[str]:
    """Named values of joints that are too few, too many, or beyond the limits."""
    for name, q in description.configurations.items():
        yield from _group_faults(f"configurations.{name}", np.array(q), arm)
    yield from _group_faults("hand.open", np.array(description.hand_open), hand)
    yield from _group_faults("hand.closed", np.array(description.hand_closed), hand)


def _group_faults(what: str, q: Array, group: JointGroup) -> Iterator[str]:
    if q.shape != (len(group),):
        yield f"{what}: {len(group)} numbers are needed, one a joint; found {q.size}"
        return
    for name, value, lower, upper in zip(
        group.names, q, group.lower, group.upper, strict=True
    ):
        if not lower <= value <= upper:
            yield f"{what}: {value:g} of '{name}' is outside of {lower:g} .. {upper:g}"


def _add_pairs(
    description: RobotDescription, model: pin.Model, geometry: pin.GeometryModel
) -> None:
    """Add every pair of bodies that can move against each other and is not disabled."""
    disabled = {frozenset(pair[:2]) for pair in description.disabled_pairs}
    bodies = [
        (model.frames[body.parentFrame].name, body.parentJoint)
        for body in geometry.geometryObjects
    ]
    for i, j in combinations(range(len(bodies)), 2):
        (link_i, joint_i), (link_j, joint_j) = bodies[i], bodies[j]
        if joint_i != joint_j and frozenset((link_i, link_j)) not in disabled:
            geometry.addCollisionPair(pin.CollisionPair(i, j))


def _inverse_kinematics(
    description: RobotDescription, model: pin.Model, tool_frame: int
) -> InverseKinematics:
    solver = SOLVERS[description.ik_solver]
    try:
        return solver(
            model, description.arm_joints, tool_frame, description.ik_settings
        )
    except InputError as error:
        raise InputError(f"{description.path}: {error}") from error
