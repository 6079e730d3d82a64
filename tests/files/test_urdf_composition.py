"""A composed robot moves as its parts do, judged by Pinocchio."""

from __future__ import annotations

from copy import deepcopy
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.files.body_inertia import DENSITY, inertial
from mmplan.files.rigid_pose import RigidPose, from_rpy
from mmplan.files.urdf import UrdfError, parse_urdf, urdf_facts
from mmplan.files.urdf_composition import held, placed
from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.robot_file import load_robot_description

FOLDER = Path(__file__).parents[1] / "faulty_robots"
ARM = parse_urdf(FOLDER / "arm.urdf")
# Limits only: a continuous joint has two coordinates for Pinocchio.
VALUES = st.fixed_dictionaries(
    {
        "shoulder": st.floats(-1.5, 1.5),
        "nod": st.floats(0.2, 0.5),
        "left_finger": st.floats(0.0, 0.04),
    }
)
POSES = st.builds(
    from_rpy, st.tuples(*[st.floats(-2, 2)] * 3), st.tuples(*[st.floats(-3, 3)] * 3)
)


@cache
def sound() -> Robot:
    return build_robot(load_robot_description(FOLDER / "sound.yaml"))


def frames(urdf: ET.Element, values: dict[str, float]) -> dict[str, np.ndarray]:
    """The poses of all links with joints at values, others at 0."""
    model = pin.buildModelFromXML(ET.tostring(urdf, encoding="unicode"))
    q, data = pin.neutral(model), model.createData()
    for name, value in values.items():
        q[model.joints[model.getJointId(name)].idx_q] = value
    pin.framesForwardKinematics(model, data, q)
    links = [link.get("name", "") for link in urdf.findall("link")]
    return {n: data.oMf[model.getFrameId(n)].homogeneous for n in links}


@given(VALUES)
def test_a_joint_that_is_held_is_where_it_would_have_moved(
    values: dict[str, float],
) -> None:
    moved = frames(ARM, {**values, "right_finger": values["left_finger"]})
    fixed = frames(held(ARM, values), {})
    assert fixed.keys() == moved.keys()
    for link, pose in moved.items():
        np.testing.assert_allclose(fixed[link], pose, atol=1e-9)


@given(VALUES)
def test_joints_that_are_held_are_joints_no_more(values: dict[str, float]) -> None:
    assert set(urdf_facts(held(ARM, values), {}).joints) == {"elbow"}


@given(POSES)
def test_a_root_that_is_placed_takes_everything_along(pose: RigidPose) -> None:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = pose.R, pose.xyz
    before, after = frames(ARM, {}), frames(placed(ARM, pose), {})
    for link, T_root_link in before.items():
        np.testing.assert_allclose(after[link], T @ T_root_link, atol=1e-9)


def test_the_urdf_itself_stays_as_it_is() -> None:
    before = ET.tostring(ARM)
    held(ARM, {"nod": 0.3})
    placed(ARM, RigidPose())
    assert ET.tostring(ARM) == before


def test_a_joint_that_is_not_there_cannot_be_held() -> None:
    with pytest.raises(UrdfError, match="no joint 'knee'"):
        held(ARM, {"knee": 0.0})


def test_two_roots_are_named() -> None:
    urdf = deepcopy(ARM)
    ET.SubElement(urdf, "link", name="stray")
    with pytest.raises(UrdfError, match="exactly one root link; found foot, stray"):
        placed(urdf, RigidPose())


def test_a_robot_has_the_joints_of_its_groups_and_no_others() -> None:
    robot = sound()
    assert robot.base.names == ("base_x", "base_y", "base_yaw")
    assert robot.arm.names == ("shoulder", "elbow")
    assert robot.hand.names == ("left_finger", "right_finger")
    assert robot.model.nq == robot.model.nv == 7


def test_what_turns_without_end_has_no_limits_unless_they_are_given() -> None:
    robot = sound()
    assert robot.arm.wraps.tolist() == [False, True]
    assert robot.arm.upper.tolist() == [1.5, np.inf]
    assert robot.base.wraps.tolist() == [False] * 3
    assert robot.base.lower[2] == -1.0


@given(st.floats(0.0, 0.04))
def test_followers_follow(opening: float) -> None:
    robot = sound()
    q = robot.q_neutral.copy()
    q[robot.hand.indices[robot.hand.leads]] = opening
    followed = robot.with_followers(q)
    assert followed[robot.hand.indices].tolist() == [opening, opening]
    assert robot.hand.leads.tolist() == [True, False]


def test_links_that_are_parked_still_collide() -> None:
    robot = sound()
    kinds = {robot.link_of(b): robot.kind_of(b) for b in robot.geometry.geometryObjects}
    assert kinds["mobile_base"] == kinds["foot"] == "base"
    assert kinds["left"] == kinds["right"] == "finger"


@given(POSES, POSES)
def test_inertia_is_that_of_the_bodies(first: RigidPose, second: RigidPose) -> None:
    box, rod = ET.Element("box", size="0.3 0.2 0.5"), ET.Element("cylinder")
    rod.attrib = {"radius": "0.1", "length": "0.4"}
    urdf = ET.Element("robot", name="bodies")
    link = ET.SubElement(urdf, "link", name="base")
    link.append(inertial([(box, first), (rod, second)]))
    joint = ET.SubElement(urdf, "joint", name="slide", type="prismatic")
    ET.SubElement(joint, "parent", link="world")
    ET.SubElement(joint, "child", link="base")
    ET.SubElement(joint, "limit", lower="0", upper="1", velocity="1", effort="1")
    ET.SubElement(urdf, "link", name="world")
    found = pin.buildModelFromXML(ET.tostring(urdf, encoding="unicode")).inertias[1]
    expected = pin.Inertia.Zero()
    for pose, inertia in (
        (first, pin.Inertia.FromBox(DENSITY * 0.03, 0.3, 0.2, 0.5)),
        (second, pin.Inertia.FromCylinder(DENSITY * np.pi * 0.004, 0.1, 0.4)),
    ):
        expected += pin.SE3(np.array(pose.R), np.array(pose.xyz)).act(inertia)
    assert found.isApprox(expected, 1e-6)
