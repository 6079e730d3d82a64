"""Laws of all grasp families, and what each of them means."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mmplan.grasps import (
    Axis,
    BoxFaces,
    CylinderSide,
    CylinderTop,
    GraspFamily,
    Handle,
    Mixture,
    Poses,
    Rim,
    SphereGrasps,
    TaskSpaceRegion,
)
from mmplan.grasps.tsr import displacements
from mmplan.shapes import Array

AXIS = Axis(along=(0.02, 0.2))
RIM = Rim(radius=0.12, height=0.03, spread=0.8)
MIXTURE = Mixture((AXIS, RIM, Axis(along=(-0.3, -0.1))))
WALL = Rim(radius=0.08, height=0.05, spread=0.3, tilt=0.5 * np.pi)
SIDE = CylinderSide(along=(0.02, 0.1), tilt=0.4)
TOP = CylinderTop(end=0.1, depth=(0.01, 0.03))
BOTTOM = CylinderTop(end=-0.1, depth=(0.01, 0.03), below=True)
BALL = SphereGrasps(centre=(0.1, 0.2, 0.3))
BAR = Handle(start=(0.05, 0, 0.02), end=(0.05, 0, 0.08), outward=(1, 0, 0.5))
BOX = BoxFaces(size=(0.2, 0.1, 0.05), widest=0.1)


def rigid(seed: int, n: int) -> Array:
    """Poses (n, 4, 4), anyhow."""
    rng = np.random.default_rng(seed)
    return displacements(rng.uniform(-1.5, 1.5, (n, 6)))


POSES = Poses(rigid(0, 40), qualities=np.linspace(0, 1, 40))
BOUNDS = np.array([[0, 0], [0, 0], [-0.02, 0.02], [0, 0], [-0.1, 0.2], [-np.pi, np.pi]])
REGION = TaskSpaceRegion(*rigid(1, 2), bounds=BOUNDS)
FAMILIES: dict[str, GraspFamily] = {
    "axis": AXIS,
    "rim": RIM,
    "wall": WALL,
    "cylinder_side": SIDE,
    "cylinder_top": TOP,
    "cylinder_bottom": BOTTOM,
    "sphere": BALL,
    "handle": BAR,
    "box_faces": BOX,
    "poses": POSES,
    "tsr": REGION,
    "mixture": MIXTURE,
    "all": Mixture((SIDE, TOP, BALL, BAR, BOX, POSES, REGION)),
}
SEEDS = st.integers(0, 10_000)
BATCH = 8

each_family = pytest.mark.parametrize("name", FAMILIES)


def draw(family: GraspFamily, seed: int) -> Array:
    return family.genes.sample(BATCH, np.random.default_rng(seed))


@each_family
@settings(max_examples=25)
@given(seed=SEEDS)
def test_poses_are_rigid_transforms(name: str, seed: int) -> None:
    family = FAMILIES[name]
    T = family.tool_poses(draw(family, seed))
    assert T.shape == (BATCH, 4, 4)
    R = T[:, :3, :3]
    np.testing.assert_allclose(
        R @ R.transpose(0, 2, 1), [np.eye(3)] * BATCH, atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(R), 1.0)
    np.testing.assert_array_equal(T[:, 3], [[0, 0, 0, 1]] * BATCH)


@each_family
@settings(max_examples=25)
@given(seed=SEEDS)
def test_a_batch_is_the_same_as_its_rows(name: str, seed: int) -> None:
    family = FAMILIES[name]
    genes = draw(family, seed)
    rows = [family.tool_poses(g[None])[0] for g in genes]
    np.testing.assert_array_equal(family.tool_poses(genes), rows)
    rows = [family.quality(g[None])[0] for g in genes]
    np.testing.assert_array_equal(family.quality(genes), rows)


@each_family
@settings(max_examples=25)
@given(seed=SEEDS)
def test_qualities_are_shares(name: str, seed: int) -> None:
    family = FAMILIES[name]
    quality = family.quality(draw(family, seed))
    assert quality.shape == (BATCH,)
    assert np.all((quality >= 0.0) & (quality <= 1.0))


@each_family
def test_no_genes_have_no_poses(name: str) -> None:
    family = FAMILIES[name]
    assert family.tool_poses(np.empty((0, len(family.genes)))).shape == (0, 4, 4)


@pytest.mark.parametrize(
    "name", ["axis", "rim", "wall", "cylinder_side", "cylinder_top", "sphere", "tsr"]
)
@given(seed=SEEDS, turns=st.integers(-3, 3))
def test_a_whole_turn_changes_nothing(name: str, seed: int, turns: int) -> None:
    family = FAMILIES[name]
    genes = draw(family, seed)
    turned = genes + 2 * np.pi * turns * family.genes.periodic
    np.testing.assert_allclose(
        family.tool_poses(turned), family.tool_poses(genes), atol=1e-12
    )
    assert family.genes.range[family.genes.periodic] == pytest.approx(2 * np.pi)


@given(SEEDS)
def test_axis_approaches_its_target_across_the_axis(seed: int) -> None:
    genes = draw(AXIS, seed)
    T = AXIS.tool_poses(genes)
    closing, approach, target = T[:, :3, 1], T[:, :3, 2], T[:, :3, 3]
    np.testing.assert_array_equal(target[:, :2], 0.0)
    assert np.all((target[:, 2] >= 0.02) & (target[:, 2] <= 0.2))
    np.testing.assert_allclose(approach[:, 2], 0.0, atol=1e-15)
    np.testing.assert_allclose(closing[:, 2], 0.0, atol=1e-15)
    # The hand stands on the side that the second gene names.
    side = np.stack([np.cos(genes[:, 1]), np.sin(genes[:, 1])], axis=1)
    np.testing.assert_allclose(approach[:, :2], -side, atol=1e-12)


@given(SEEDS)
def test_rim_approaches_the_lip_in_its_plane(seed: int) -> None:
    genes = draw(RIM, seed)
    T = RIM.tool_poses(genes)
    closing, approach, target = T[:, :3, 1], T[:, :3, 2], T[:, :3, 3]
    np.testing.assert_allclose(np.hypot(*target[:, :2].T), 0.12)
    np.testing.assert_array_equal(target[:, 2], 0.03)
    np.testing.assert_array_equal(closing, [[0.0, 0.0, 1.0]] * BATCH)
    np.testing.assert_allclose(approach[:, 2], 0.0, atol=1e-15)
    inward = -target[:, :2] / 0.12
    cosine = np.einsum("ni,ni->n", approach[:, :2], inward)
    np.testing.assert_allclose(cosine, np.cos(genes[:, 1]), atol=1e-12)
    assert np.all(cosine >= np.cos(0.8) - 1e-12)


def test_rim_without_turn_points_at_the_axis() -> None:
    T = RIM.tool_poses(np.array([[0.5 * np.pi, 0.0]]))[0]
    np.testing.assert_allclose(T[:3, 3], [0.0, 0.12, 0.03], atol=1e-15)
    np.testing.assert_allclose(T[:3, 2], [0.0, -1.0, 0.0], atol=1e-15)


@given(SEEDS)
def test_a_mixture_is_its_families(seed: int) -> None:
    genes = draw(MIXTURE, seed)
    poses, which = MIXTURE.tool_poses(genes), MIXTURE.family_of(genes)
    for row, number in enumerate(which):
        family = MIXTURE.families[number]
        unit = genes[row, 1 : 1 + len(family.genes)]
        own = family.genes.lower + unit * family.genes.range
        expected = family.tool_poses(own[None])[0]
        np.testing.assert_allclose(poses[row], expected, atol=1e-12)


def test_a_mixture_draws_each_family_alike() -> None:
    genes = MIXTURE.genes.sample(6000, np.random.default_rng(0))
    shares = np.bincount(MIXTURE.family_of(genes)) / 6000
    np.testing.assert_allclose(shares, 1 / 3, atol=0.03)


def test_the_upper_bound_belongs_to_the_last_family() -> None:
    assert MIXTURE.family_of(MIXTURE.genes.upper[None])[0] == 2
    assert MIXTURE.family_of(MIXTURE.genes.lower[None])[0] == 0


@given(SEEDS)
def test_cylinder_side_closes_across_the_axis_however_inclined(seed: int) -> None:
    genes = draw(SIDE, seed)
    T = SIDE.tool_poses(genes)
    closing, approach, target = T[:, :3, 1], T[:, :3, 2], T[:, :3, 3]
    np.testing.assert_array_equal(target[:, :2], 0.0)
    assert np.all((target[:, 2] >= 0.02) & (target[:, 2] <= 0.1))
    np.testing.assert_allclose(closing[:, 2], 0.0, atol=1e-15)
    np.testing.assert_allclose(approach[:, 2], -np.sin(genes[:, 2]), atol=1e-12)
    assert np.all(np.abs(approach[:, 2]) <= np.sin(0.4) + 1e-12)
    # The hand stands on the side that the second gene names.
    side = np.stack([np.cos(genes[:, 1]), np.sin(genes[:, 1])], axis=1)
    assert np.all(np.einsum("ni,ni->n", approach[:, :2], side) < 0.0)


def test_cylinder_side_without_inclination_is_axis() -> None:
    genes = draw(Axis(along=(0.02, 0.1)), 3)
    level = np.column_stack([genes, np.zeros(BATCH)])
    expected = Axis(along=(0.02, 0.1)).tool_poses(genes)
    np.testing.assert_allclose(SIDE.tool_poses(level), expected, atol=1e-15)


@pytest.mark.parametrize(("family", "end", "down"), [(TOP, 0.1, -1), (BOTTOM, -0.1, 1)])
@given(seed=SEEDS)
def test_cylinder_top_reaches_inside_the_end(
    family: CylinderTop, end: float, down: int, seed: int
) -> None:
    genes = draw(family, seed)
    T = family.tool_poses(genes)
    np.testing.assert_array_equal(T[:, :3, 2], [[0.0, 0.0, down]] * BATCH)
    np.testing.assert_array_equal(T[:, :2, 3], 0.0)
    inside = down * (T[:, 2, 3] - end)
    assert np.all((inside >= 0.01 - 1e-12) & (inside <= 0.03 + 1e-12))


@given(SEEDS)
def test_sphere_points_at_the_middle_from_any_side(seed: int) -> None:
    T = BALL.tool_poses(draw(BALL, seed))
    np.testing.assert_array_equal(T[:, :3, 3], [[0.1, 0.2, 0.3]] * BATCH)


def test_sphere_draws_all_directions_alike() -> None:
    genes = BALL.genes.sample(20_000, np.random.default_rng(0))
    approach = BALL.tool_poses(genes)[:, :3, 2]
    np.testing.assert_allclose(approach.mean(axis=0), 0.0, atol=0.02)
    np.testing.assert_allclose(np.cov(approach.T), np.eye(3) / 3, atol=0.02)


@given(SEEDS)
def test_handle_is_taken_across_from_its_free_side(seed: int) -> None:
    T = BAR.tool_poses(draw(BAR, seed))
    closing, approach, target = T[:, :3, 1], T[:, :3, 2], T[:, :3, 3]
    np.testing.assert_array_equal(target[:, :2], [[0.05, 0.0]] * BATCH)
    assert np.all((target[:, 2] >= 0.02) & (target[:, 2] <= 0.08))
    np.testing.assert_allclose(approach[:, 2], 0.0, atol=1e-15)
    np.testing.assert_allclose(closing[:, 2], 0.0, atol=1e-15)
    assert np.all(-approach[:, 0] >= np.cos(np.pi / 3) - 1e-12)


def test_a_box_is_closed_on_where_it_is_narrow_enough() -> None:
    ways = {(axis, closing) for axis, _, closing, _, _ in BOX.ways.tolist()}
    assert ways == {(0, 1), (0, 2), (1, 2), (2, 1)}
    assert len(BOX.ways) == 4 * 2 * 2
    assert len(BoxFaces(size=(0.2, 0.2, 0.2), widest=0.1).ways) == 0
    top = BoxFaces(size=(0.05, 0.05, 0.05), widest=0.1, faces=("+z",))
    assert len(top.ways) == 4
    np.testing.assert_array_equal(top.tool_poses(draw(top, 0))[:, 2, 2] < 0, True)


@given(SEEDS)
def test_box_faces_target_lies_in_the_box_below_the_face(seed: int) -> None:
    genes = draw(BOX, seed)
    T = BOX.tool_poses(genes)
    axis, sign, closing, turn, sliding = BOX.ways[BOX.way_of(genes)].T
    rows, half = np.arange(BATCH), np.array(BOX.size) / 2
    target = T[:, :3, 3]
    assert np.all(np.abs(target) <= half + 1e-12)
    np.testing.assert_allclose(target[rows, closing], 0.0, atol=1e-15)
    assert np.all(np.abs(target[rows, sliding]) <= half[sliding] - 0.01 + 1e-12)
    below = half[axis] + sign * target[rows, axis]
    low, high = np.minimum(0.01, half[axis]), np.minimum(0.05, half[axis])
    assert np.all((below >= low - 1e-12) & (below <= high + 1e-12))
    np.testing.assert_array_equal(T[rows, closing, 1], turn)
    inward = sign * T[rows, axis, 2]
    np.testing.assert_allclose(inward, np.cos(genes[:, 3]), atol=1e-12)


@given(SEEDS)
def test_a_wall_is_taken_from_above(seed: int) -> None:
    T = WALL.tool_poses(draw(WALL, seed))
    np.testing.assert_allclose(T[:, :3, 2], [[0, 0, -1]] * BATCH, atol=1e-15)
    np.testing.assert_allclose(T[:, 2, 1], 0.0, atol=1e-15)
    inward = -T[:, :2, 3] / 0.08
    across = np.einsum("ni,ni->n", T[:, :2, 1], inward)
    assert np.all(across >= np.cos(0.3) - 1e-12)


def test_every_pose_of_a_list_is_drawn_about_as_often() -> None:
    genes = POSES.genes.sample(40_000, np.random.default_rng(0))
    drawn = np.bincount(POSES.number_of(genes), minlength=len(POSES)) / 1000
    assert np.all((drawn > 0.6) & (drawn < 1.5))
    numbers = POSES.number_of(genes[:9])
    np.testing.assert_array_equal(
        POSES.tool_poses(genes[:9]), POSES.T_object_tool[numbers]
    )
    np.testing.assert_array_equal(
        POSES.quality(genes[:9]), np.linspace(0, 1, 40)[numbers]
    )


@pytest.mark.parametrize("n", [1, 2, 7, 8, 9, 26, 27, 100])
def test_no_pose_of_a_list_is_out_of_reach(n: int) -> None:
    family = Poses(rigid(n, n))
    genes = family.genes.sample(400 * n, np.random.default_rng(n))
    genes[0], genes[1] = family.genes.lower, family.genes.upper
    assert set(family.number_of(genes).tolist()) == set(range(n))


def test_near_genes_mean_near_poses() -> None:
    """A small mutation of a list's genes leads nearer than another draw would."""
    axis = Axis(along=(0.0, 0.2))
    rng = np.random.default_rng(0)
    family = Poses(axis.tool_poses(axis.genes.sample(1000, rng)))
    genes = family.genes.sample(2000, rng)
    step = family.genes.contain(genes + rng.uniform(-0.05, 0.05, genes.shape))
    here, there, anywhere = (
        family.tool_poses(g)[:, :3, 2:] for g in (genes, step, genes[::-1])
    )
    near = np.linalg.norm(here - there, axis=(1, 2)).mean()
    assert near < 0.5 * np.linalg.norm(here - anywhere, axis=(1, 2)).mean()


def test_a_region_without_room_is_its_frames() -> None:
    region = TaskSpaceRegion(REGION.T_object_w, REGION.T_w_tool, np.zeros((6, 2)))
    T = region.tool_poses(draw(region, 0))
    expected = REGION.T_object_w @ REGION.T_w_tool
    np.testing.assert_allclose(T, [expected] * BATCH, atol=1e-12)


@given(SEEDS)
def test_a_region_keeps_its_bounds(seed: int) -> None:
    genes = draw(REGION, seed)
    T = REGION.tool_poses(genes)
    w = np.linalg.inv(REGION.T_object_w) @ T @ np.linalg.inv(REGION.T_w_tool)
    np.testing.assert_allclose(w[:, :3, 3], genes[:, :3], atol=1e-12)
    assert np.all(np.abs(w[:, 2, 3]) <= 0.02 + 1e-12)
    # Fixed axes x, y, z: the displaced x axis rises by minus the sine of the pitch.
    np.testing.assert_allclose(-w[:, 2, 0], np.sin(genes[:, 4]), atol=1e-12)
    yaw = np.arctan2(w[:, 1, 0], w[:, 0, 0])
    np.testing.assert_allclose(yaw, genes[:, 5], atol=1e-9)
