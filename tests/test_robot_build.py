"""What a robot's description says wrongly about its URDF is named, all at once."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from mmplan.assets import robots_folder
from mmplan.exceptions import InputError
from mmplan.robot_build import build_robot, load_robot
from mmplan.robot_file import load_robot_description

PATH = robots_folder() / "puma_mobile" / "robot.yaml"
PUMA = load_robot_description(PATH)
ARM = PUMA.arm_joints
ACCELERATION = dict(PUMA.acceleration)

FAULTS: list[tuple[dict[str, Any], str]] = [
    ({"arm_joints": (*ARM[:5], "joint7")}, "arm: no joint 'joint7' among base_x,"),
    ({"arm_joints": ARM[:5]}, "joint 'joint6' must belong to exactly one of base"),
    ({"base_joints": (*PUMA.base_joints, "joint1")}, "joint 'joint1' must belong to"),
    (
        {"acceleration": {k: v for k, v in ACCELERATION.items() if k != "joint2"}},
        "acceleration: no value for joint 'joint2'",
    ),
    (
        {"acceleration": {**ACCELERATION, "jiont": 1.0}},
        "acceleration: no joint 'jiont'",
    ),
    ({"tool": "tip"}, "tool: no link 'tip' among"),
    ({"tool": "joint6"}, "tool: no link 'joint6' among"),
    ({"disabled_pairs": (("base", "leg", "adjacent"),)}, "no link 'leg' among"),
    ({"ik_solver": "magic"}, "ik.solver: no 'magic' among"),
    (
        {"configurations": {"home": (0.0,) * 5}},
        "home: 6 numbers are needed, one a joint",
    ),
    (
        {"configurations": {"up": (0.0, 0.0, 0.0, 0.0, 1.8, 0.0)}},
        "configurations.up: 1.8 of 'joint5' is outside of -1.74533 .. 1.74533",
    ),
    ({"hand_open": (0.05, 0.06)}, "hand.open: 0.06 of 'finger_right' is outside"),
    ({"hand_closed": (-0.01, 0.0)}, "hand.closed: -0.01 of 'finger_left' is outside"),
]


@pytest.mark.parametrize(("changed", "message"), FAULTS, ids=[m for _, m in FAULTS])
def test_a_fault_is_named(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        build_robot(replace(PUMA, **changed))
    assert message in str(caught.value)
    assert str(PATH) in str(caught.value)


def test_all_faults_are_named_at_once() -> None:
    with pytest.raises(InputError) as caught:
        build_robot(replace(PUMA, tool="tip", ik_solver="magic", acceleration={}))
    assert len(caught.value.diagnostics) == 2 + len(ACCELERATION)


URDF_FAULTS = [
    ('type="revolute"', 'type="floating"', "'joint1' must have one degree of freedom"),
    ('lower="0" upper="0.05"', 'lower="0" upper="0"', "lower below upper"),
    ('velocity="0.8"', 'velocity="0"', "'base_x' needs a velocity limit above 0"),
    ('<link name="tool"', '<link name="tol"', "its URDF cannot be read"),
]


@pytest.mark.parametrize(("good", "bad", "message"), URDF_FAULTS)
def test_a_fault_of_the_urdf_is_named(good: str, bad: str, message: str) -> None:
    assert good in PUMA.urdf
    with pytest.raises(InputError, match=message):
        build_robot(replace(PUMA, urdf=PUMA.urdf.replace(good, bad, 1)))


def test_capsules_stay_capsules() -> None:
    bodies = build_robot(PUMA).geometry.geometryObjects
    shapes = {b.name: type(b.geometry).__name__ for b in bodies}
    assert shapes["forearm_0"] == shapes["wrist_roll_0"] == "Capsule"


def test_disabled_pairs_work_in_either_order() -> None:
    turned = tuple((b, a, why) for a, b, why in PUMA.disabled_pairs)
    pairs = build_robot(replace(PUMA, disabled_pairs=turned)).geometry.collisionPairs
    assert len(pairs) == len(build_robot(PUMA).geometry.collisionPairs)


def test_without_disabled_pairs_all_that_moves_is_checked() -> None:
    robot = build_robot(replace(PUMA, disabled_pairs=()))
    n = len(robot.geometry.geometryObjects)
    same_joint = 1  # the base's chassis and column
    assert len(robot.geometry.collisionPairs) == n * (n - 1) // 2 - same_joint


def test_a_robot_goes_by_its_name_its_file_and_its_folder() -> None:
    for name in ("puma_mobile", str(PATH), str(PATH.parent)):
        assert load_robot(name).name == "puma_mobile"
    with pytest.raises(InputError, match="did you mean 'puma_mobile'"):
        load_robot("puma_mobil")
