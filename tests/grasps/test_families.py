"""Laws of all grasp families, and what each of the two of the paper means."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.grasps import Axis, GraspFamily, Mixture, Rim
from mmplan.shapes import Array

AXIS = Axis(along=(0.02, 0.2))
RIM = Rim(radius=0.12, height=0.03, spread=0.8)
MIXTURE = Mixture((AXIS, RIM, Axis(along=(-0.3, -0.1))))
FAMILIES = {"axis": AXIS, "rim": RIM, "mixture": MIXTURE}
SEEDS = st.integers(0, 10_000)
BATCH = 8

each_family = pytest.mark.parametrize("name", FAMILIES)


def draw(family: GraspFamily, seed: int) -> Array:
    return family.genes.sample(BATCH, np.random.default_rng(seed))


@each_family
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
@given(seed=SEEDS)
def test_a_batch_is_the_same_as_its_rows(name: str, seed: int) -> None:
    family = FAMILIES[name]
    genes = draw(family, seed)
    rows = [family.tool_poses(g[None])[0] for g in genes]
    np.testing.assert_array_equal(family.tool_poses(genes), rows)
    rows = [family.quality(g[None])[0] for g in genes]
    np.testing.assert_array_equal(family.quality(genes), rows)


@each_family
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


@pytest.mark.parametrize("name", ["axis", "rim"])
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
