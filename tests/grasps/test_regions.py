"""Families as task space regions: the same grasps, no more and no fewer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mmplan.cli import main
from mmplan.grasp_exchange import family_of_file
from mmplan.grasps import GraspFamily, Mixture, TaskSpaceRegion, regions
from mmplan.shapes import Array
from tests.grasps.test_families import AXIS, BOX
from tests.grasps.test_families import FAMILIES as EVERY
from tests.honest import puma
from tests.tabletop import SCENE

NO_REGIONS = ("rim", "wall", "poses", "mixture", "all")
FAMILIES: dict[str, GraspFamily] = {
    **{name: family for name, family in EVERY.items() if name not in NO_REGIONS},
    "mixture": Mixture((AXIS, BOX)),
}
NEAR = 1e-7


def displacement(region: TaskSpaceRegion, T_object_tool: Array) -> Array:
    """The x, y, z, roll, pitch, yaw (n, 6) at which a region has tool poses."""
    before, after = np.linalg.inv(region.T_object_w), np.linalg.inv(region.T_w_tool)
    D = before @ T_object_tool @ after
    pitch = -np.arcsin(np.clip(D[:, 2, 0], -1.0, 1.0))
    roll = np.arctan2(D[:, 2, 1], D[:, 2, 2])
    yaw = np.arctan2(D[:, 1, 0], D[:, 0, 0])
    found: Array = np.column_stack([D[:, :3, 3], roll, pitch, yaw])
    return found


@pytest.mark.parametrize("name", FAMILIES)
def test_regions_hold_the_grasps_of_the_family_and_no_others(name: str) -> None:
    """All poses are in one of them, and they go to all bounds of each."""
    family, rng = FAMILIES[name], np.random.default_rng(0)
    parts = regions(family)
    assert parts is not None
    T = family.tool_poses(family.genes.sample(400 * len(parts), rng))
    left = np.ones(len(T), np.bool_)
    for part in parts:
        moved = displacement(part, T)
        low, high = part.bounds.T
        inside = np.all((moved >= low - NEAR) & (moved <= high + NEAR), axis=1)
        left &= ~inside
        span = np.ptp(moved[inside], axis=0)
        np.testing.assert_array_less(0.9 * (high - low) - NEAR, span)
    assert not left.any()


@pytest.mark.parametrize("name", NO_REGIONS)
def test_lists_and_rims_are_no_regions(name: str) -> None:
    assert regions(EVERY[name]) is None


def test_the_command_saves_regions_that_say_the_same(tmp_path: Path) -> None:
    path = tmp_path / "cup.yaml"
    command = ["grasps", str(SCENE), "--object", "cup", "--samples", "4"]
    assert main([*command, "--bases", "1", "--save", str(path), "--as", "tsr"]) == 0
    read = family_of_file(path, puma())
    T = read.tool_poses(read.genes.sample(20, np.random.default_rng(0)))
    np.testing.assert_allclose(T[:, :2, 3], 0.0, atol=1e-9)  # `along` the axis
    assert np.all((T[:, 2, 3] >= -0.04) & (T[:, 2, 3] <= 0.07))
    np.testing.assert_allclose(T[:, 2, 1:3], 0.0, atol=1e-9)  # level


def test_what_is_no_region_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "plate.yaml"
    command = ["grasps", "plate", "--object", "plate", "--save", str(path)]
    assert main([*command, "--as", "tsr"]) == 2
    error = capsys.readouterr().err
    assert "is a Rim family, which is no task space region" in error
    assert "isaac_grasp" in error
    assert not path.exists()
