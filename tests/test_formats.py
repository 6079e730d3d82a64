"""What docs/formats.md and the scene format say agrees with the rest of mmplan."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest

from mmplan.files.robot_sections import RobotSection
from mmplan.files.scene_sections import SceneSection
from mmplan.files.settings_sections import OptimizerName, PlannerName
from mmplan.optimizers import OPTIMIZERS
from mmplan.planning.planners import available_planners
from mmplan.robot_build import load_robot
from mmplan.scene_file import load_problem

DOCUMENT = Path(__file__).parents[1] / "docs" / "formats.md"
GRASPS = DOCUMENT.with_name("grasps.md")  # where formats.md sends its reader


def test_the_example_of_a_scene_loads(tmp_path: Path) -> None:
    section = DOCUMENT.read_text().partition("\n## Scene\n")[2]
    example = re.search(r"```yaml\n(.*?)```", section, re.DOTALL)
    assert example
    path = tmp_path / "cup.yaml"
    path.write_text(example.group(1))
    assert load_problem(path).name == "cup"


def test_the_example_of_a_robot_loads(tmp_path: Path) -> None:
    section = DOCUMENT.read_text().partition("\n## Robot\n")[2]
    example = re.search(r"```yaml\n(.*?)```", section, re.DOTALL)
    assert example
    path = tmp_path / "robot.yaml"
    path.write_text(example.group(1))
    assert load_robot(path).name == "my_robot"


@pytest.mark.parametrize("model", [SceneSection, RobotSection])
def test_every_key_is_documented(
    model: type[SceneSection] | type[RobotSection],
) -> None:
    text = DOCUMENT.read_text() + GRASPS.read_text()
    words = set(re.findall(r"\w+", " ".join(re.findall("`.*?`", text))))
    assert set(_keys(model.model_json_schema())) <= words


def test_the_planners_are_those_of_mmplan() -> None:
    assert set(get_args(PlannerName)) == set(available_planners())


def test_the_optimizers_are_those_of_mmplan() -> None:
    assert set(get_args(OptimizerName)) == set(OPTIMIZERS)


def _keys(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        yield from node.get("properties", {})
        for value in node.values():
            yield from _keys(value)
