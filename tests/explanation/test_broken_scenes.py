"""Of scenes that are broken on purpose, the known cause is the first one named."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from mmplan.collision import CollisionWorld
from mmplan.explanation import Explanation, NearMiss, explain, explanation_lines
from mmplan.explanation.drawing import MISS, exhibit_of_miss
from mmplan.pipeline import grasp_family
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.scoring import End
from mmplan.visualization.part import SCENE

BROKEN = Path(__file__).parents[1] / "broken"


@dataclass(frozen=True)
class Known:
    """What is wrong with a scene: test, end, culprit, ways out, nearest miss."""

    kind: str
    end: End | None
    culprit: str | None
    helps: tuple[str, ...]
    miss: str | None = None
    paths: bool = False


KNOWN = {
    "bowl_only": Known(
        "collision",
        End.GOAL,
        "dishwasher/lower_rack",
        ("`dishwasher/lower_rack`", "another grasp family: axis (`stem`"),
        "overlap",
    ),
    "closed_doors": Known(
        "collision",
        End.GOAL,
        "wall_cabinet/left_door",
        ("`wall_cabinet/left_door`",),
        "overlap",
    ),
    "crowd": Known("collision", End.GOAL, "can_", ("with the goal ",), "overlap"),
    "four_posts": Known(
        "hand opened", End.GOAL, "post_", ("obstacle `post_",), "overlap"
    ),
    "long_approach": Known("approach", None, None, ("of approach instead of 80 cm",)),
    "long_lift": Known("lift", None, None, ("of lift instead of 30 cm",)),
    "low_board": Known(
        "collision", End.GOAL, "board", ("obstacle `board` removed",), "overlap"
    ),
    "low_hook": Known(
        "joint limits",
        End.START,
        None,
        ("with the limits of `joint5` 20 degrees wider", "with the start 40 cm higher"),
        "turn",
    ),
    "narrow_slot": Known(
        "collision", End.GOAL, "", ("with the hand 2 cm narrower",), "overlap"
    ),
    "no_go": Known(
        "base bounds", End.START, None, ("with the base allowed in zone",), "reach"
    ),
    "short_floor": Known(
        "base bounds", End.START, None, ("beyond its bounds",), "reach"
    ),
    "shut_box": Known(
        "collision", End.GOAL, "front", ("obstacle `front` removed",), "overlap"
    ),
    "too_deep": Known(
        "base", End.GOAL, "table", ("obstacle `table` removed",), "reach"
    ),
    "too_high": Known("reach", End.GOAL, None, ("with the goal 40 cm lower",), "reach"),
    "turned_over": Known("common grasp", None, None, ("with the goal ",), "overlap"),
    "walled_in": Known("transit", None, "pen_", ("obstacle `pen_",), paths=True),
}


@cache
def explained(name: str) -> Explanation:
    problem = load_problem(BROKEN / f"{name}.yaml")
    (found,) = explain(problem, paths=KNOWN[name].paths)
    return found


def test_every_broken_scene_has_a_known_cause() -> None:
    assert set(KNOWN) == {path.stem for path in BROKEN.glob("*.yaml")}
    assert len(KNOWN) >= 12


@pytest.mark.parametrize("name", KNOWN)
def test_the_known_cause_is_named_first(name: str) -> None:
    found, known = explained(name), KNOWN[name]
    assert not found.solvable
    cause = found.causes[0]
    assert (cause.kind, cause.end) == (known.kind, known.end)
    if known.culprit is not None:
        assert cause.culprits[0][0].startswith(known.culprit)


@pytest.mark.parametrize("name", KNOWN)
def test_what_would_help_was_tried_and_comes_smallest_first(name: str) -> None:
    found = explained(name)
    helps = [r for r in found.relaxations if r.solvable]
    for way in KNOWN[name].helps:
        assert any(way in r.text for r in helps)
    assert [r.size for r in helps] == sorted(r.size for r in helps)
    lines = list(explanation_lines(found))
    assert lines[0].endswith("no solution found")
    assert lines[1].startswith("cause: ")
    assert all(f"  {r.text}" in lines for r in helps)


@pytest.mark.parametrize("name", KNOWN)
def test_the_nearest_miss_is_as_it_says(name: str) -> None:
    miss, known = explained(name).near_miss, KNOWN[name]
    if known.miss is None:
        assert miss is None
        return
    assert miss is not None
    assert (miss.kind, miss.end) == (known.miss, known.end or miss.end)
    assert (miss.works_at is None) == (known.kind != "common grasp")
    assert miss.amount > 0.0
    problem = load_problem(BROKEN / f"{name}.yaml")
    _CHECKS[miss.kind](problem, _world(problem, miss), miss)


def _world(problem: Problem, miss: NearMiss) -> CollisionWorld:
    world, (task,) = CollisionWorld.of_problem(problem), problem.tasks
    if miss.end == End.GOAL:
        world = world.place(task.object, task.T_world_goal)
    return world.permit_touch(task.object, fingers=True)


def _check_overlap(_: Problem, world: CollisionWorld, miss: NearMiss) -> None:
    """Nothing overlaps deeper than what is named, which lies between the points."""
    deepest = world.contacts(np.array(miss.q))[0]
    assert (deepest.first, deepest.second) == (miss.first, miss.second)
    assert deepest.depth == pytest.approx(miss.amount, abs=1e-6)
    assert _length(miss) == pytest.approx(miss.amount, abs=1e-3)
    assert f"misses {miss.second} by -{miss.amount * 1000:.1f} mm" in str(miss)


def _check_turn(problem: Problem, _: CollisionWorld, miss: NearMiss) -> None:
    arm = problem.robot.arm
    q = np.array(miss.q)[arm.indices]
    excess = dict(zip(arm.names, np.maximum(arm.lower - q, q - arm.upper), strict=True))
    assert max(excess.values()) == excess[miss.first] == pytest.approx(miss.amount)


def _check_reach(problem: Problem, world: CollisionWorld, miss: NearMiss) -> None:
    """The tool is turned as the grasp wants it, and short of it by the amount."""
    robot, (task,) = problem.robot, problem.tasks
    q = np.array(miss.q)
    assert np.all(q >= robot.model.lowerPositionLimit - 1e-9)
    assert np.all(q <= robot.model.upperPositionLimit + 1e-9)
    assert not world.base_alone().in_collision(q[None])[0]
    _, family = grasp_family(problem.object(task.object))
    T_object_tool = family.tool_poses(np.array(miss.grasp)[None])[0]
    wanted = world.standing[task.object] @ T_object_tool
    tool = robot.tool_pose(q)
    assert tool[:3, :3] == pytest.approx(wanted[:3, :3], abs=1e-6)
    missing = float(np.linalg.norm(tool[:3, 3] - wanted[:3, 3]))
    assert missing == pytest.approx(miss.amount) == pytest.approx(_length(miss))


_CHECKS = {"overlap": _check_overlap, "turn": _check_turn, "reach": _check_reach}


def _length(miss: NearMiss) -> float:
    assert miss.line is not None
    start, end = miss.line
    return float(np.linalg.norm(np.subtract(start, end)))


@pytest.mark.parametrize("name", ["bowl_only", "low_hook", "too_high"])
def test_the_nearest_miss_is_drawn_with_what_is_missing(name: str) -> None:
    miss, problem = explained(name).near_miss, load_problem(BROKEN / f"{name}.yaml")
    assert miss is not None
    exhibit = exhibit_of_miss(problem, miss)
    assert exhibit.film.q[0] == pytest.approx(np.array(miss.q))
    drawn = {part.name: part for part in exhibit.parts if part.layer == MISS}
    assert ("what is missing" in drawn) == (miss.line is not None)
    assert (f"{miss.first}, highlighted" in drawn) == (miss.kind != "reach")
    if miss.line is not None:
        line = drawn["what is missing"].surface.vertices
        for point in miss.line:
            assert np.linalg.norm(line - point, axis=1).min() < 0.01
    seen = {part.name for part in exhibit.parts if part.layer == SCENE}
    assert str(miss.second) not in seen, "it would hide the place"
