"""Of scenes that are broken on purpose, the known cause is the first one named."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from mmplan.explanation import Explanation, explain, explanation_lines
from mmplan.scene_file import load_problem
from mmplan.scoring import End

BROKEN = Path(__file__).parents[1] / "broken"


@dataclass(frozen=True)
class Known:
    """What is wrong with a scene: the test, the end, the culprit, a way out."""

    kind: str
    end: End | None
    culprit: str | None
    helps: str
    paths: bool = False


KNOWN = {
    "bowl_only": Known(
        "collision", End.GOAL, "dishwasher/lower_rack", "`dishwasher/lower_rack`"
    ),
    "closed_doors": Known(
        "collision", End.GOAL, "wall_cabinet/left_door", "`wall_cabinet/left_door`"
    ),
    "crowd": Known("collision", End.GOAL, "can_", "with the goal "),
    "four_posts": Known("hand opened", End.GOAL, "post_", "obstacle `post_"),
    "long_approach": Known("approach", None, None, "of approach instead of 80 cm"),
    "long_lift": Known("lift", None, None, "of lift instead of 30 cm"),
    "low_board": Known("collision", End.GOAL, "board", "obstacle `board` removed"),
    "short_floor": Known("base bounds", End.START, None, "beyond its bounds"),
    "no_go": Known("base bounds", End.START, None, "with the base allowed in zone"),
    "shut_box": Known("collision", End.GOAL, "front", "obstacle `front` removed"),
    "too_deep": Known("base", End.GOAL, "table", "obstacle `table` removed"),
    "too_high": Known("reach", End.GOAL, None, "with the goal 40 cm lower"),
    "turned_over": Known("common grasp", None, None, "with the goal "),
    "walled_in": Known("transit", None, "pen_", "obstacle `pen_", paths=True),
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
    assert any(KNOWN[name].helps in r.text for r in helps)
    assert [r.size for r in helps] == sorted(r.size for r in helps)
    lines = list(explanation_lines(found))
    assert lines[0].endswith("no solution found")
    assert lines[1].startswith("cause: ")
    assert all(f"  {r.text}" in lines for r in helps)


@pytest.mark.parametrize("name", ["bowl_only", "low_board", "shut_box"])
def test_the_nearest_miss_is_an_overlap_of_a_link_with_something(name: str) -> None:
    found = explained(name)
    miss = found.near_miss
    assert miss is not None
    assert miss.end == KNOWN[name].end
    assert miss.amount > 0.0
    robot = load_problem(BROKEN / f"{name}.yaml").robot
    links = {robot.link_of(body) for body in robot.geometry.geometryObjects}
    assert miss.first in links
    assert f"by -{miss.amount * 1000:.1f} mm" in str(miss)
