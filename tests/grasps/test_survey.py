"""`mmplan grasps`: what the grasps of an object are worth."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mmplan.cli import main
from mmplan.grasp_exchange import family_of_file
from mmplan.grasp_survey import object_of, samples, survey
from mmplan.grasps import Poses
from mmplan.problem import Object
from mmplan.shapes import Cylinder, Sphere
from tests.honest import puma, shift
from tests.tabletop import SCENE, cup_problem, two_tasks


def test_each_family_is_surveyed() -> None:
    problem = two_tasks()
    rows = survey(problem, object_of(problem, "bottle"), n=20, bases=10, seed=0)
    assert [(row.name, row.family, row.genes) for row in rows] == [
        ("low", "Axis", 2),
        ("high", "Axis", 2),
    ]
    for row in rows:
        assert row.closes == 1.0
        assert 0.0 < row.quality_median <= row.quality_best <= 1.0
        assert set(row.feasible) == {"start", "goal"}
        assert 0.0 < row.feasible["start"] <= 1.0


def test_an_object_that_stays_has_grasps_but_no_ends() -> None:
    ball = Object("ball", Sphere(0.03), shift(0.4, 0.8, 0.84))
    problem = cup_problem()
    problem = replace(problem, objects=(*problem.objects, ball))
    (row,) = survey(problem, object_of(problem, "ball"), n=10, bases=2, seed=0)
    assert (row.name, row.closes, row.feasible) == ("ball", 1.0, {})


def test_the_same_seed_draws_the_same_samples() -> None:
    item = Object("can", Cylinder(0.03, 0.1), np.eye(4))
    problem = replace(cup_problem(), objects=(item,), tasks=())
    family = object_of(problem, "can").grasps["body"]
    a, b = (samples(problem, item, family, 10, 3) for _ in range(2))
    np.testing.assert_array_equal(a.T_object_tool, b.T_object_tool)
    np.testing.assert_array_equal(a.quality, b.quality)


def test_the_command_prints_and_saves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "cup.yaml"
    command = ["grasps", str(SCENE), "--object", "cup", "--samples", "10"]
    assert main([*command, "--bases", "4", "--json", "--save", str(path)]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["object"] == "cup"
    assert report["hand_opens"] == pytest.approx(0.1)
    assert [family["name"] for family in report["families"]] == ["side"]
    saved = family_of_file(path, puma())
    assert isinstance(saved, Poses)
    assert len(saved) == 10
    assert np.all(np.diff(saved.qualities) <= 0.0)
    assert main([*command, "--bases", "2"]) == 0
    assert "side" in capsys.readouterr().out


def test_an_unknown_object_is_guessed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["grasps", str(SCENE), "--object", "cupp"]) == 2
    assert "did you mean 'cup'?" in capsys.readouterr().err
