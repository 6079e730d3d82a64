"""Grasps of other programs: their hand frame is not our tool frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mmplan.exceptions import InputError
from mmplan.files.grasp_files import (
    ListedGrasps,
    Region,
    isaac_text,
    read_grasp_file,
    regions_text,
)
from mmplan.grasp_exchange import family_of_file, hand_frame, listed, region
from mmplan.grasps import Mixture, Poses, TaskSpaceRegion
from mmplan.grasps.tsr import displacements
from mmplan.scene_file import load_problem
from mmplan.shapes import Array
from tests.honest import puma
from tests.tabletop import cup_scene

# A hand whose own frame stands 70 mm behind the tool and closes along its x: as in a
# file in the convention of another program, turned by 90 degrees against ours.
T_HAND_TOOL = np.array(
    [[0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.07], [0, 0, 0, 1]]
)
# Taken from above at a point 0.1 m up; the hand closes along the object's y.
ISAAC = """
format: isaac_grasp
format_version: 1.0
object_frame: /World/mug
gripper_frame: /World/robot/{frame}
grasps:
  "from_above":
    confidence: 0.75
    position: [0.0, 0.0, {height}]
    orientation: {{w: 0.0, xyz: [{x}, {y}, 0.0]}}
    cspace_position: {{finger_left: 0.02}}
    pregrasp_cspace_position: {{finger_left: 0.05}}
"""
TSR = """
name: side
T_ref_tsr: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.05], [0, 0, 0, 1]]
Tw_e: [[0, 0, 1, -0.04], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
Bw: [[0, 0], [0, 0], [-0.01, 0.01], [0, 0], [0, 0], [-3.14159265, 3.14159265]]
task: grasp
"""


def isaac(folder: Path, frame: str, height: float, x: float, y: float) -> Path:
    path = folder / "grasps.yaml"
    path.write_text(ISAAC.format(frame=frame, height=height, x=x, y=y))
    return path


def only_pose(family: object) -> Array:
    assert isinstance(family, Poses)
    (T,) = family.T_object_tool
    return T


def assert_from_above_closing_along_y(T: Array) -> None:
    np.testing.assert_allclose(T[:3, 3], [0, 0, 0.1], atol=1e-9)
    np.testing.assert_allclose(T[:3, 2], [0, 0, -1], atol=1e-9)
    np.testing.assert_allclose(np.abs(T[:3, 1]), [0, 1, 0], atol=1e-9)


def test_a_hand_frame_that_is_a_link_of_the_robot_is_converted(tmp_path: Path) -> None:
    """The Puma's `hand` has our axes, 0.1858 m behind the tool (see the URDF)."""
    path = isaac(tmp_path, "hand", 0.1 + 0.1858, 1.0, 0.0)
    family = family_of_file(path, puma())
    assert_from_above_closing_along_y(only_pose(family))
    assert family.quality(family.genes.lower[None])[0] == 0.75


def test_a_hand_turned_by_a_quarter_is_converted_where_the_scene_says_so(
    tmp_path: Path,
) -> None:
    """In the file the hand closes along its x, which lies along the object's y."""
    s = np.sqrt(0.5)
    path = isaac(tmp_path, "gripper", 0.17, s, s)
    T_object_hand = read_grasp_file(path).T_object_hand[0]  # type: ignore[union-attr]
    np.testing.assert_allclose(T_object_hand[:3, 0], [0, 1, 0], atol=1e-9)
    assert_from_above_closing_along_y(
        only_pose(family_of_file(path, puma(), T_HAND_TOOL))
    )
    unconverted = only_pose(family_of_file(path, puma(), np.eye(4)))
    with pytest.raises(AssertionError):
        assert_from_above_closing_along_y(unconverted)


@pytest.mark.parametrize(
    ("frame", "why"),
    [("panda_hand", "is no link"), ("finger_left", "moves against the tool")],
)
def test_a_hand_frame_that_is_not_known_is_refused(
    tmp_path: Path, frame: str, why: str
) -> None:
    path = isaac(tmp_path, frame, 0.1, 1.0, 0.0)
    with pytest.raises(InputError, match=why) as caught:
        family_of_file(path, puma())
    assert str(path) in str(caught.value)
    assert "tool" in str(caught.value)


def test_isaac_grasps_come_back_as_they_were_saved(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    T = displacements(rng.uniform(-3, 3, (30, 6)))
    quality = rng.random(30)
    hands = [{"finger_left": 0.05}] * 30
    path = tmp_path / "saved.yaml"
    path.write_text(isaac_text(listed(T, quality, T_HAND_TOOL, "gripper"), hands))
    family = family_of_file(path, puma(), T_HAND_TOOL)
    assert isinstance(family, Poses)
    np.testing.assert_allclose(family.T_object_tool, T, atol=1e-7)
    np.testing.assert_allclose(family.qualities, quality, atol=1e-8)
    found = read_grasp_file(path)
    assert isinstance(found, ListedGrasps)
    assert found.hand_frame == "gripper"


def test_regions_come_back_as_they_were_saved(tmp_path: Path) -> None:
    frames = displacements(np.random.default_rng(1).uniform(-1, 1, (4, 6)))
    bounds = np.array([[-0.1, 0.1]] * 3 + [[0.0, 0.0]] * 2 + [[-1.0, 1.0]])
    families = [TaskSpaceRegion(a, b, bounds) for a, b in (frames[:2], frames[2:])]
    path = tmp_path / "regions.yaml"
    regions = [region(str(i), f, T_HAND_TOOL) for i, f in enumerate(families)]
    path.write_text(regions_text(regions))
    found = family_of_file(path, puma(), T_HAND_TOOL)
    assert isinstance(found, Mixture)
    for saved, read in zip(families, found.families, strict=True):
        genes = saved.genes.sample(5, np.random.default_rng(2))
        np.testing.assert_allclose(
            read.tool_poses(genes), saved.tool_poses(genes), atol=1e-7
        )


def test_a_region_of_another_program_means_what_it_says(tmp_path: Path) -> None:
    """From -x, 4 cm before the axis; turned by a quarter about z it is from -y."""
    path = tmp_path / "side.yaml"
    path.write_text(TSR)
    (read,) = read_grasp_file(path)
    assert isinstance(read, Region)
    family = family_of_file(path, puma())
    T = family.tool_poses(np.array([[0, 0, 0.01, 0, 0, 0.5 * np.pi]]))[0]
    np.testing.assert_allclose(T[:3, 3], [0, -0.04, 0.06], atol=1e-9)
    np.testing.assert_allclose(T[:3, 2], [0, 1, 0], atol=1e-9)
    assert family.genes.periodic.tolist() == [False] * 5 + [True]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("grasps: {{}}", "no file of grasps"),
        ("format: other\ngrasps: {{a: {{}}}}", "isaac_grasp"),
        (ISAAC.replace("1.0\nobject", "2.0\nobject"), "version 1.0 is read"),
        (ISAAC.replace("w: 0.0", "w: 3.0"), "norm"),
        (ISAAC.replace("0.75", "1.75"), "confidence"),
        (TSR.replace("[0, 0, 1, -0.04]", "[0, 0, 2, -0.04]"), "rigid"),
        (TSR.replace("Bw: [[0, 0], ", "Bw: ["), "Bw"),
    ],
)
def test_a_faulty_file_is_refused_with_the_place(
    tmp_path: Path, text: str, fault: str
) -> None:
    path = tmp_path / "faulty.yaml"
    path.write_text(text.format(frame="hand", height=0.1, x=1.0, y=0.0))
    with pytest.raises(InputError, match=fault) as caught:
        read_grasp_file(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("shorthand", [True, False])
def test_a_scene_takes_its_grasps_from_a_file(tmp_path: Path, shorthand: bool) -> None:
    isaac(tmp_path, "hand", 0.1858 + 0.05, 1.0, 0.0)
    path = cup_scene(tmp_path)
    named = "{file: grasps.yaml}"
    if not shorthand:
        named = (
            "{theirs: {family: file, file: grasps.yaml, tool: {xyz: [0, 0, 0.1858]}}}"
        )
    path.write_text(
        path.read_text().replace("{side: {family: axis, along: [-0.04, 0.07]}}", named)
    )
    problem = load_problem(path)
    (family,) = problem.objects[0].grasps.values()
    np.testing.assert_allclose(only_pose(family)[:3, 3], [0, 0, 0.05], atol=1e-9)
    before = problem.fingerprint
    isaac(tmp_path, "hand", 0.1858 + 0.06, 1.0, 0.0)
    assert load_problem(path).fingerprint != before


def test_the_tool_link_itself_may_be_the_hand_frame() -> None:
    np.testing.assert_allclose(hand_frame(Path("x"), puma(), "tool"), np.eye(4))
