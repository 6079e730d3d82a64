"""What an explanation counts adds up, and changes do what they say."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.cli import main
from mmplan.collision import CollisionWorld, local_bounds
from mmplan.collision.hand_width import narrowed
from mmplan.explanation import explain, explanation_json, explanation_lines
from mmplan.explanation.robot_changes import wider_limits
from mmplan.explanation.settings import Setting
from mmplan.explanation.slimming import slimmed
from mmplan.robot_build import load_robot, with_arm_limits
from mmplan.shapes import Box, Capsule, Cylinder, Revolve, Shape, read_only
from tests.explanation.test_broken_scenes import BROKEN
from tests.tabletop import SCENE, cup_problem, two_tasks


def test_a_problem_that_can_be_solved_has_no_cause() -> None:
    first, second = explain(two_tasks())
    assert (first.object, second.object) == ("cup", "bottle")
    for found in (first, second):
        assert found.solvable
        assert found.relaxations == ()
        assert found.first_free is not None
        assert 1 <= found.first_free <= found.candidates
        assert found.planned is None
    line = next(iter(explanation_lines(first)))
    assert line.startswith("task 1 (cup): solvable; of pairs drawn at random ")


def test_the_funnel_only_narrows_and_ends_in_what_is_feasible() -> None:
    (found,) = explain(cup_problem())
    for end in (0, 1):
        left = [stage.left[end] for stage in found.stages]
        assert left == sorted(left, reverse=True)
        assert left[0] >= 1000
        assert left[-1] > 0
    assert sum(found.grasps_by_end) > 0
    assert min(found.feasible) > 0


def test_the_same_seed_gives_the_same_explanation() -> None:
    problem = cup_problem()
    texts = [
        json.dumps(explanation_json(found), allow_nan=False)
        for seed in (1, 1, 2)
        for found in explain(problem, seed=seed)
    ]
    assert texts[0] == texts[1] != texts[2]


def test_paths_are_planned_where_asked_for() -> None:
    (found,) = explain(cup_problem(), paths=True)
    assert found.planned is True
    assert "a verified plan was found" in next(iter(explanation_lines(found)))


def test_wider_limits_let_the_arm_reach_more_and_lose_nothing() -> None:
    robot = cup_problem().robot
    arm, rng = robot.arm, np.random.default_rng(0)
    wider = with_arm_limits(robot, arm.lower - 0.3, arm.upper + 0.3)
    q = np.tile(robot.q_neutral, (300, 1))
    q[:, arm.indices] = rng.uniform(arm.lower - 0.3, arm.upper + 0.3, (300, len(arm)))
    T = np.array([robot.tool_pose(row) for row in q])
    before, after = robot.ik.solve(T).within, wider.ik.solve(T).within
    assert not np.any(before & ~after)
    assert after.any(axis=1).all()
    assert not before.any(axis=1).all()


def test_limits_of_a_lift_are_lengths_and_those_of_other_joints_angles() -> None:
    robot = load_robot("tiago")
    setting = Setting(
        replace(cup_problem(), robot=robot), CollisionWorld.of_problem(cup_problem())
    )
    lift = wider_limits(setting, "torso_lift_joint", 0.1)
    assert lift.text == "with the limits of `torso_lift_joint` 10 cm wider"
    assert lift.size == 0.1
    turn = wider_limits(setting, "arm_1_joint", np.radians(10.0))
    assert turn.text == "with the limits of `arm_1_joint` 10 degrees wider"
    assert turn.size == pytest.approx(np.radians(10.0) * robot.reach)
    changed = turn.apply(setting)
    assert changed is not None
    more = changed.problem.robot.arm.upper - robot.arm.upper
    assert dict(zip(robot.arm.names, more, strict=True)) == {
        name: pytest.approx(np.radians(10.0) if name == "arm_1_joint" else 0.0)
        for name in robot.arm.names
    }


def test_a_cup_wider_than_the_hand_opens_is_told() -> None:
    problem = cup_problem()
    cup = replace(problem.object("cup"), shape=Cylinder(0.07, 0.16))
    others = tuple(o for o in problem.objects if o.name != "cup")
    (found,) = explain(replace(problem, objects=(cup, *others)))
    assert [(cause.kind, cause.end) for cause in found.causes] == [("hand", None)]
    (helps,) = [r.text for r in found.relaxations if r.solvable]
    assert helps == "with the cup 5 cm slimmer"


@pytest.mark.parametrize("by", [0.01, 0.02, 0.04])
def test_a_narrower_hand_hits_no_more_than_before(by: float) -> None:
    problem = cup_problem()
    robot = narrowed(problem.robot, by)
    world = CollisionWorld.of_problem(problem)
    slim = replace(world, robot=robot)
    rng = np.random.default_rng(0)
    q = rng.uniform(-1.0, 1.0, (400, robot.model.nq))
    q[:, robot.hand.indices] = robot.hand_open
    before, after = world.in_collision(q), slim.in_collision(q)
    assert not np.any(after & ~before)
    pairs = zip(
        problem.robot.geometry.geometryObjects,
        robot.geometry.geometryObjects,
        strict=True,
    )
    changed = {problem.robot.link_of(a) for a, b in pairs if _volume(b) < _volume(a)}
    assert changed == {"hand", "finger_left", "finger_right"}


def _volume(body: object) -> float:
    half = local_bounds(body.geometry).half  # type: ignore[attr-defined]
    return float(np.prod(half))


SHAPES = [
    Box((0.1, 0.2, 0.3)),
    Cylinder(0.1, 0.2),
    Capsule(0.1, 0.2),
    Revolve(read_only([[0.0, 0.0], [0.1, 0.0], [0.05, 0.2]])),
]


@given(st.sampled_from(SHAPES), st.floats(0.1, 1.0))
def test_slimmed_shapes_are_scaled_across_their_axis(
    shape: Shape, factor: float
) -> None:
    twice = slimmed(slimmed(shape, factor), 1.0 / factor)
    assert type(twice) is type(shape)
    for a, b in zip(_numbers(shape), _numbers(twice), strict=True):
        assert a == pytest.approx(b)
    thin = _numbers(slimmed(shape, factor))
    assert all(a <= b for a, b in zip(thin, _numbers(shape), strict=True))


def _numbers(shape: Shape) -> list[float]:
    values = [np.ravel(v) for v in vars(shape).values()]
    return np.concatenate(values).tolist()


def test_the_command_says_by_its_exit_code_whether_there_is_a_solution(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    page = tmp_path / "miss.html"
    assert main(["explain", str(SCENE), "--json", "-o", str(page)]) == 0
    out, err = capsys.readouterr()
    told = json.loads(out)
    assert told["solvable"] is True
    assert len(told["tasks"]) == 2
    assert err == f"mmplan: {page} not written: no miss to draw\n"
    assert main(["explain", str(BROKEN / "short_floor.yaml"), "-o", str(page)]) == 1
    out, err = capsys.readouterr()
    assert "the arm reaches grasps only from where the base may not go" in out
    assert out.endswith(f"written to {page}\n")
    assert err == ""
    assert "leaves the tool" in page.read_text(encoding="utf-8")
    assert main(["explain", "no_such_scene"]) == 2
