"""robot.yaml files, shipped and faulty."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from mmplan import assets
from mmplan.exceptions import InputError
from mmplan.robot_file import load_robot_description


@pytest.fixture
def robot_yaml(tmp_path: Path) -> Path:
    folder = tmp_path / "puma_mobile"
    shutil.copytree(assets.robots_folder() / "puma_mobile", folder)
    return folder / assets.ROBOT_FILE


@pytest.mark.parametrize("name", assets.robot_names())
def test_a_shipped_robot_is_described(name: str, tmp_path: Path) -> None:
    path = assets.find_robot(name, tmp_path)
    assert path is not None
    description = load_robot_description(path)
    assert description.name == name
    assert description.description
    assert all(file.is_file() for file in description.files.values())
    assert set(description.acceleration) == {
        *description.base_joints,
        *description.arm_joints,
        *description.hand_joints,
    }


@pytest.mark.parametrize(
    ("good", "bad", "message"),
    [
        ("type: xy", "type: plane", "base.type: unknown name 'plane'; did you mean"),
        ("type: xy", "type: planar", "base: a base of type planar has 3 joints"),
        ("joint3, joint4", "jiont3, joint4", "arm.joints[2]: unknown joint 'jiont3'"),
        ("tool: tool", "tool: tol", "tool: unknown link 'tol'; did you mean 'tool'?"),
        ("radius: 0.28", "radius: -1", "base.radius: must be greater than 0"),
        ("  joint1: 3.0\n", "", "acceleration: no limit for joint 'joint1'"),
        ("joint1: 3.0", "joint1: 0", "acceleration.joint1: must be greater than 0"),
        ("solver: puma", "slover: puma", "ik: missing key 'solver'"),
        ("a2: 0.4318", "a2: long", "ik.a2: expected a number, got 'long'"),
        ("[0.0, 2.0, -3.4", "[0.0, 7.0, -3.4", "configurations.home[1]: 7 is outside"),
        ("open: [0.05, 0.05]", "open: [0.05]", "hand.open: expected 2 numbers"),
        ("- [base, shoulder,", "- [base, sholder,", "disabled_pairs[0][1]: unknown"),
        ("urdf: puma_mobile.urdf", "urdf: puma.urdf", "urdf: no such file"),
        ("urdf: puma_mobile.urdf", "urdf: robot.yaml", "is not XML"),
        ("urdf: puma_mobile.urdf", "urdf: 3", "urdf: expected a file name or"),
        ("mmplan_robot: 1", "mmplan_robot: 2", "mmplan_robot: this mmplan reads"),
    ],
)
def test_a_faulty_robot_file_names_the_fault(
    robot_yaml: Path, good: str, bad: str, message: str
) -> None:
    text = robot_yaml.read_text()
    assert good in text
    robot_yaml.write_text(text.replace(good, bad, 1))
    with pytest.raises(InputError) as caught:
        load_robot_description(robot_yaml)
    found = caught.value.diagnostics
    assert any(d.message.startswith(message) for d in found), found
    assert all(d.line and d.file == str(robot_yaml) for d in found)


def test_a_robot_of_example_robot_data(robot_yaml: Path) -> None:
    if assets.example_robots() is None:
        pytest.skip("example-robot-data is not installed")
    text = robot_yaml.read_text().replace(
        "urdf: puma_mobile.urdf",
        "urdf: {example_robot_data: ur_description/urdf/ur10_robot.urdf}",
    )
    robot_yaml.write_text(text)
    with pytest.raises(InputError) as caught:
        load_robot_description(robot_yaml)
    messages = [d.message for d in caught.value.diagnostics]
    assert any("shoulder_pan_joint" in m for m in messages), "its joints are known"
    robot_yaml.write_text(text.replace("ur10_robot", "ur11_robot"))
    with pytest.raises(InputError, match=r"urdf\.example_robot_data: no such file"):
        load_robot_description(robot_yaml)
