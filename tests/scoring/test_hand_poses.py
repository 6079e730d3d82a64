"""The hand's joints from the tool's pose alone."""

from __future__ import annotations

import numpy as np

from mmplan.kinematics import joint_placements
from mmplan.scoring.hand_poses import HandPoses
from tests.collision.worlds import draw
from tests.honest import puma


def test_the_hand_is_where_the_tool_is_whatever_the_arm() -> None:
    robot, q = puma(), draw(20, 22)
    q[:, robot.hand.indices] = np.linspace(0.0, 0.05, 20)[:, None]
    T_world_tool = np.array([robot.tool_pose(row) for row in q])
    found = HandPoses(robot)(T_world_tool, q)
    joints = [robot.tool_joint]
    joints += [robot.model.getJointId(name) for name in robot.hand.names]
    expected = joint_placements(robot.model, q)[:, joints]
    np.testing.assert_allclose(found[:, joints], expected, atol=1e-12)
