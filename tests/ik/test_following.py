"""Laws of following tool poses with arms that have a freedom left."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._wheel_arms import load_arm
from mmplan.assets import example_robots
from mmplan.ik.chain import arm_chain
from mmplan.ik.following import follow
from tests.ik.laws import ACCURACY

pytestmark = pytest.mark.skipif(
    example_robots() is None, reason="example-robot-data is not installed"
)
SPACING = 0.004


@pytest.mark.parametrize("name", ["panda", "tiago_torso", "pr2", "baxter"])
def test_the_tool_follows_a_line_in_small_steps(name: str) -> None:
    arm = load_arm(name)
    chain = arm_chain(arm.model, arm.joints, arm.frame)
    whole = 0
    for q in arm.draw(12, seed=1):
        T = np.tile(arm.tool_poses(q[None]), (26, 1, 1))
        T[:, 2, 3] += SPACING * np.arange(26)
        path, ended = follow(chain, q, T)
        np.testing.assert_allclose(arm.tool_poses(path), T[: len(path)], atol=ACCURACY)
        assert np.all((path >= chain.lower) & (path <= chain.upper))
        assert bool(ended) == (len(path) < len(T))
        whole += not ended
        if len(path) == len(T):
            steps = np.abs(np.diff(path, axis=0)).max(axis=1)
            assert np.median(steps) < 0.05
            assert steps.max() < 20 * np.median(steps)
    assert whole >= 6


def test_a_line_ends_where_the_arm_does() -> None:
    arm = load_arm("panda")
    chain = arm_chain(arm.model, arm.joints, arm.frame)
    q = np.array([0.0, 0.3, 0.0, -1.5, 0.0, 1.8, 0.7])
    T = np.tile(arm.tool_poses(q[None]), (200, 1, 1))
    T[:, 0, 3] += 0.02 * np.arange(200)
    path, ended = follow(chain, q, T)
    assert 1 < len(path) < 100
    assert ended == "out of reach" or ended.endswith("is at its limit")


def test_a_joint_at_its_limit_is_named() -> None:
    arm = load_arm("tiago_torso")
    chain = arm_chain(arm.model, arm.joints, arm.frame).part([0])
    path, ended = follow(chain, np.array([0.34]), _raised(chain.T_home, 0.34, 10))
    assert len(path) < 10
    assert ended == "torso_lift_joint is at its limit"


def _raised(T: np.ndarray, start: float, count: int) -> np.ndarray:
    poses = np.tile(T, (count, 1, 1))
    poses[:, 2, 3] += start + SPACING * np.arange(count)
    return poses
