"""Every faulty robot.yaml of the corpus is refused with the faults it announces."""

from __future__ import annotations

from pathlib import Path

import pytest

from mmplan import assets
from mmplan.exceptions import InputError
from mmplan.robot_build import build_robot
from mmplan.robot_file import load_robot_description
from tests.test_faulty_scenes import assert_expected, expectations

CORPUS = Path(__file__).parent / "faulty_robots"
SOUND = CORPUS / "sound.yaml"
FAULTY = [path for path in sorted(CORPUS.glob("*.yaml")) if path != SOUND]


def faults_of(path: Path) -> InputError:
    with pytest.raises(InputError) as caught:
        load_robot_description(path)
    return caught.value


@pytest.mark.parametrize("path", FAULTY, ids=lambda path: path.stem)
def test_a_faulty_robot_names_exactly_its_faults(path: Path) -> None:
    if path.stem == "example_missing" and assets.example_robots() is None:
        pytest.skip("example-robot-data is not installed")
    expected = expectations(path)
    assert expected, "every file of the corpus says what it expects"
    assert_expected(expected, faults_of(path))


def test_the_robot_that_the_faulty_ones_are_made_from_is_sound() -> None:
    assert build_robot(load_robot_description(SOUND)).name == "sound"


def test_a_missing_package_is_named_with_the_command_that_installs_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(assets, "example_robots", lambda: None)
    (fault,) = faults_of(assets.robots_folder() / "tiago" / "robot.yaml").diagnostics
    assert fault.message.startswith("urdf.example_robot_data: needs example-robot-data")
    assert "pip install 'mmplan[robots]'" in fault.message
    assert fault.line
