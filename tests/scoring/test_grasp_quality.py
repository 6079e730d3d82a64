"""Grasp quality of held objects: what makes it better, and where it is 0."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mmplan.collision import HandCloser, Scenery
from mmplan.grasps import Axis, GraspFamily, Poses
from mmplan.pipeline import score_function
from mmplan.problem import Object, Problem, ScoreSettings, Task
from mmplan.scoring import End, Outcome
from mmplan.scoring.grasp_quality import (
    FamilyQuality,
    Hold,
    WrenchQuality,
    weight_wrenches,
)
from mmplan.shapes import Array, Box, Cylinder
from tests.honest import bottle_problem, puma, shift
from tests.tabletop import cup_problem

# A cup on its side turns by half a turn on the way.
FLIPPED = np.diag([1.0, -1.0, -1.0, 1.0])


def rated(
    item: Object, *T_object_tool: Array, quality: str = "epsilon", goal: Array = FLIPPED
) -> Array:
    """G of tool poses in the object's frame."""
    task = Task(item.name, goal)
    problem = replace(
        bottle_problem(),
        objects=(item,),
        tasks=(task,),
        score=ScoreSettings(grasp=1.0, quality=quality),
    )
    closer = HandCloser(puma(), Scenery.solids_of_object(item))
    poses = np.array(T_object_tool)
    hold = Hold(np.zeros((len(poses), 1)), poses, closer.close(poses))
    return WrenchQuality(problem, task, closer)(hold)


def rod(**facts: float) -> Object:
    """A round bar of 30 cm along z."""
    return Object("rod", Cylinder(0.02, 0.3), np.eye(4), **facts)


def across(height: float) -> Array:
    """The hand on the rod at a height, level."""
    return Axis((height, height)).tool_poses(np.array([[height, 0.3]]))[0]


def test_epsilon_falls_with_the_distance_to_the_centre_of_mass() -> None:
    G = rated(rod(), *map(across, (0.0, 0.05, 0.1, 0.13)))
    assert np.all((G > 0.0) & (G <= 1.0))
    assert np.all(np.diff(G) < 0.0)


def test_the_volume_is_the_same_about_all_points() -> None:
    """A shift of the origin shears the wrenches, which leaves their volume alone."""
    G = rated(rod(), *map(across, (0.0, 0.05, 0.1)), quality="volume")
    assert 0.0 < G[0] <= 1.0
    np.testing.assert_allclose(G, G[0], rtol=1e-2)


def test_a_heavy_thing_is_held_in_the_middle_only() -> None:
    light, heavy, too_heavy = (
        rated(rod(mass=m), across(0.0), across(0.12)) for m in (0.01, 1.0, 50.0)
    )
    np.testing.assert_allclose(light, rated(rod(), across(0.0), across(0.12)))
    assert heavy[0] > heavy[1] == 0.0
    np.testing.assert_array_equal(too_heavy, 0.0)


def test_the_weight_is_that_in_all_orientations_on_the_way() -> None:
    item = rod(mass=2.0)
    wrenches = weight_wrenches(item, Task("rod", FLIPPED), force=80.0)
    np.testing.assert_allclose(
        np.linalg.norm(wrenches[:, :3], axis=1), 2.0 * 9.81 / 80.0
    )
    np.testing.assert_array_equal(wrenches[:, 3:], 0.0)
    up = wrenches[:, :3] / np.linalg.norm(wrenches[:, :3], axis=1, keepdims=True)
    np.testing.assert_allclose(up[[0, -1]], [[0, 0, 1], [0, 0, -1]], atol=1e-12)
    np.testing.assert_allclose(up[2, 2], 0.0, atol=1e-12)
    assert len(weight_wrenches(rod(), Task("rod", FLIPPED), force=80.0)) == 0
    assert len(weight_wrenches(item, Task("rod", FLIPPED), force=np.inf)) == 0


def test_pads_that_meet_a_box_aslant_do_not_hold() -> None:
    box = Object("box", Box((0.03, 0.05, 0.2)), np.eye(4), friction=0.2)
    turned = shift(0, 0, 0)
    turned[:2, :2] = [[np.cos(0.2), -np.sin(0.2)], [np.sin(0.2), np.cos(0.2)]]
    square, aslant = rated(box, np.eye(4), turned)
    assert square > 0.0
    assert aslant == 0.0


def test_a_hand_that_does_not_close_has_no_quality() -> None:
    assert rated(rod(), shift(0.2, 0, 0))[0] == 0.0


def test_the_force_of_the_hand_is_that_of_its_joints() -> None:
    assert HandCloser(puma(), Scenery.solids_of_object(rod())).force == 80.0


def test_a_family_may_rate_its_grasps() -> None:
    family = Poses(np.array([across(0.0), across(0.1)]), np.array([0.25, 0.75]))
    genes = family.genes.sample(20, np.random.default_rng(0))
    hold = Hold(genes, family.tool_poses(genes), None)  # type: ignore[arg-type]
    assert set(FamilyQuality(family)(hold)) == {0.25, 0.75}
    too_good = Poses(family.T_object_tool, np.array([0.5, 1.5]))
    with pytest.raises(ValueError, match="Poses"):
        FamilyQuality(too_good)(hold)


@cache
def cup(min_quality: float, weight: float, quality: str) -> Problem:
    settings = ScoreSettings(grasp=weight, min_quality=min_quality, quality=quality)
    return replace(cup_problem(), score=settings)


def some_scores(problem: Problem) -> tuple[Array, Array, Array]:
    """Total, grasp term and outcome of the same candidates."""
    score = score_function(problem)
    family: GraspFamily = score.family
    rng = np.random.default_rng(0)
    grasps = family.genes.sample(200, rng)
    near = score.centre_of_mass(End.START)[:2]
    q_base = near + rng.uniform(-0.9, 0.9, (200, 2))
    found = score(End.START, q_base, grasps)
    return found.total, found.terms[:, 0], found.outcome


def test_a_grasp_below_the_least_quality_scores_nothing() -> None:
    _, terms, free = some_scores(cup(0.0, 1.0, "epsilon"))
    middle = float(np.median(terms[free == Outcome.SCORED]) / 50.0)
    total, terms, outcome = some_scores(cup(middle, 1.0, "epsilon"))
    low = outcome == Outcome.LOW_QUALITY
    assert (low & (free == Outcome.SCORED)).any()
    assert (outcome == Outcome.SCORED).any()
    assert np.all(total[low] == 0.0)
    assert np.all(terms[outcome == Outcome.SCORED] >= middle * 50.0)
    np.testing.assert_array_equal(outcome[~low], free[~low])


def test_quality_is_one_term_of_the_score() -> None:
    plain, no_term, _ = some_scores(cup(0.0, 0.0, "epsilon"))
    total, term, outcome = some_scores(cup(0.0, 1.0, "epsilon"))
    scored = outcome == Outcome.SCORED
    assert np.all(term[scored] > 0.0)
    assert len(set(term[scored])) > 1
    np.testing.assert_array_equal(no_term, 0.0)
    np.testing.assert_allclose(total, plain + term)


def test_measuring_without_weight_changes_no_score() -> None:
    by_family = some_scores(cup(0.0, 0.0, "family"))
    by_wrench = some_scores(cup(0.0, 0.0, "epsilon"))
    for a, b in zip(by_family, by_wrench, strict=True):
        np.testing.assert_array_equal(a, b)
