import numpy as np
import pytest

from mmplan.kinematics import joint_placements
from mmplan.planning import hand_motion, straight_motion

RESOLUTION = 0.01
UP, DOWN = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0])
FORWARD = np.array([1.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def q_work(kitchen):
    """Beside the counter, the tool in the air and pointing at it."""
    q = kitchen.q_start.copy()
    q[kitchen.robot.base.indices] = [1.0, 0.8]
    q[kitchen.robot.arm.indices] = kitchen.robot.configurations["home"]
    return q


def tool_poses(robot, q):
    return joint_placements(robot.model, q)[:, robot.tool_joint] @ robot.T_joint_tool


@pytest.mark.parametrize("direction", [UP, FORWARD, np.array([0.6, 0.0, 0.8])])
def test_the_tool_goes_straight_and_does_not_turn(kitchen_world, q_work, direction):
    robot = kitchen_world.robot
    motion = straight_motion(kitchen_world, q_work, direction, 0.05, RESOLUTION)
    assert motion.complete, motion.message
    assert np.array_equal(motion.path[0], q_work)
    poses = tool_poses(robot, motion.path)
    moved = poses[:, :3, 3] - poses[0, :3, 3]
    assert moved == pytest.approx(np.outer(moved @ direction, direction), abs=1e-9)
    assert moved[-1] == pytest.approx(0.05 * direction, abs=1e-9)
    assert np.all(np.diff(moved @ direction) > 0.0)
    assert poses[:, :3, :3] == pytest.approx(
        np.broadcast_to(poses[0, :3, :3], (len(poses), 3, 3)), abs=1e-9
    )
    amid = tool_poses(robot, (motion.path[:-1] + motion.path[1:]) / 2.0)
    off = amid[:, :3, 3] - (poses[:-1, :3, 3] + poses[1:, :3, 3]) / 2.0
    assert np.linalg.norm(off, axis=1).max() < 0.001


def test_only_the_arm_moves_and_without_jumps(kitchen_world, q_work):
    robot = kitchen_world.robot
    motion = straight_motion(kitchen_world, q_work, UP, 0.05, RESOLUTION)
    still = np.setdiff1d(np.arange(len(q_work)), robot.arm.indices)
    assert np.array_equal(
        motion.path[:, still], np.tile(q_work[still], (len(motion.path), 1))
    )
    assert np.abs(np.diff(motion.path, axis=0)).max() < 0.1


def test_joints_keep_their_winding(kitchen_world, q_work):
    robot = kitchen_world.robot
    last = robot.arm.indices[-1]
    turned = q_work.copy()
    turned[last] += 3.5  # beyond half a turn, within the limits of joint 6
    assert robot.arm.lower[-1] < turned[last] < robot.arm.upper[-1]
    motion = straight_motion(kitchen_world, turned, UP, 0.03, RESOLUTION)
    assert motion.complete, motion.message
    assert np.abs(motion.path[:, last] - turned[last]).max() < 0.5


def test_what_stands_in_the_way_is_named(kitchen_world, q_work):
    robot = kitchen_world.robot
    T_world_tool = robot.tool_pose(q_work)
    approach = T_world_tool[:3, 2]
    T_world_object = np.eye(4)
    T_world_object[:3, 3] = T_world_tool[:3, 3] + 0.15 * approach
    blocked = kitchen_world.place("wineglass", T_world_object)
    motion = straight_motion(blocked, q_work, approach, 0.2, RESOLUTION)
    assert not motion.complete
    assert 0.3 < motion.reached < 1.0
    assert " touches " in motion.message
    assert "wineglass" in motion.message
    assert not blocked.any_collision(motion.path)
    # It went as far as it says.
    poses = tool_poses(robot, motion.path)
    gone = (poses[-1, :3, 3] - poses[0, :3, 3]) @ approach
    assert gone == pytest.approx(0.2 * motion.reached, abs=1e-9)


def test_limits_that_end_a_motion_are_named(kitchen_world, q_work):
    motion = straight_motion(kitchen_world, q_work, DOWN, 0.8, RESOLUTION)
    assert not motion.complete
    assert "joint3 is at its limit" in motion.message


def test_the_end_of_reach_is_named(kitchen_world, q_work):
    away = -FORWARD
    motion = straight_motion(kitchen_world, q_work, away, 3.0, RESOLUTION)
    assert not motion.complete
    assert motion.reached < 0.5
    assert motion.message.startswith("ended after ")


def test_a_start_in_collision_goes_nowhere(kitchen_world, q_work):
    inside = q_work.copy()
    inside[kitchen_world.robot.base.indices] = [1.05, 0.2]
    motion = straight_motion(kitchen_world, inside, UP, 0.1, RESOLUTION)
    assert motion.reached == 0.0
    assert len(motion.path) == 1
    assert "touches" in motion.message


def test_the_hand_closes_alone(kitchen_world, q_work):
    robot = kitchen_world.robot
    motion = hand_motion(kitchen_world, q_work, robot.hand_closed, RESOLUTION)
    assert motion.complete
    assert motion.message == "complete"
    assert motion.path[-1, robot.hand.indices] == pytest.approx(robot.hand_closed)
    others = np.setdiff1d(np.arange(len(q_work)), robot.hand.indices)
    assert np.array_equal(motion.path[0, others], motion.path[-1, others])


def test_the_hand_stops_at_what_it_meets(kitchen_world, q_work):
    robot = kitchen_world.robot
    # The stem of the glass between the finger pads, across both of their axes.
    T_tool_object = np.array(
        [[0.0, 0, 1, -0.05], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]
    )
    between = kitchen_world.place("wineglass", robot.tool_pose(q_work) @ T_tool_object)
    motion = hand_motion(between, q_work, robot.hand_closed, RESOLUTION)
    assert not motion.complete
    assert motion.reached == 0.0
    assert "finger" in motion.message
    assert "wineglass" in motion.message
    assert not between.any_collision(q_work[None])
