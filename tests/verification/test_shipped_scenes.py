"""Plans that mmplan makes for its own scenes, proven and then sampled densely."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mmplan
from mmplan import assets
from mmplan.collision import TOUCH_TOLERANCE, CollisionWorld, supports
from mmplan.hermite import HermiteCurve
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.replay import Stage, replay
from mmplan.shapes import Array

STEP = 0.001  # s


@pytest.fixture(scope="module", params=["wineglass", "plate"])
def solved(request: pytest.FixtureRequest) -> tuple[Plan, Problem]:
    problem = mmplan.load_problem(assets.scenes_folder() / f"{request.param}.yaml")
    return mmplan.solve(problem, seed=1), problem


def world_of(problem: Problem, stage: Stage, *, resting: bool) -> CollisionWorld:
    """The world of a segment, with touch permitted by the collision world itself."""
    world, name = CollisionWorld.of_problem(problem), stage.task.object
    for item, T_world_object in stage.standing.items():
        world = world.place(item, T_world_object)
    for item, T_tool_object in stage.attached.items():
        world = world.attach(item, T_tool_object)
    if stage.segment.name in ("grasp", "release"):
        world = world.permit_touch(name, fingers=True)
    for T in (stage.T_world_start, stage.T_world_goal) if resting else ():
        touched = supports(world.scenery, name, T, TOUCH_TOLERANCE, stage.standing)
        world = world.permit_touch(name, supports=touched)
    return world


def samples(stage: Stage) -> Array:
    segment = stage.segment
    curve = HermiteCurve(segment.times, segment.positions, segment.velocities)
    return curve.positions(np.arange(0.0, segment.duration, STEP))


def rests(problem: Problem, stage: Stage, q: Array) -> np.ndarray:
    """Whether the object's middle is within 1 cm of where it rests, (n,)."""
    poses = [stage.object_poses(problem.robot.tool_pose(row)) for row in q]
    middle = np.array([pose[stage.task.object][:3, 3] for pose in poses])
    ends = np.array([T[:3, 3] for T in (stage.T_world_start, stage.T_world_goal)])
    return np.linalg.norm(middle[:, None] - ends, axis=2).min(axis=1) <= 0.01


def test_no_dense_sample_of_a_proven_plan_collides(
    solved: tuple[Plan, Problem],
) -> None:
    plan, problem = solved
    assert mmplan.verify(plan, problem).ok
    for stage in replay(problem, plan.tasks):
        q = samples(stage)
        near = rests(problem, stage, q)
        assert not world_of(problem, stage, resting=True).any_collision(q[near])
        assert not world_of(problem, stage, resting=False).any_collision(q[~near])


def test_a_plan_is_proven_the_same_from_its_file(
    solved: tuple[Plan, Problem], tmp_path: Path
) -> None:
    plan, problem = solved
    plan.save(tmp_path / "plan.json")
    loaded = Plan.load(tmp_path / "plan.json")
    report = mmplan.verify(loaded, problem)
    assert report == plan.verification == loaded.verification
    assert loaded.path is not None
    assert loaded.path.samefile(assets.scenes_folder() / f"{plan.scene}.yaml")
