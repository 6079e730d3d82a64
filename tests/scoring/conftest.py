"""Evaluations at both ends of the shipped scene `wineglass`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from mmplan.optimizers import search_space
from mmplan.pipeline import score_function
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.scoring import End, ScoreFunction, Scores
from mmplan.shapes import Array


class Evaluated(NamedTuple):
    """Bases and grasps that were drawn at random, and what they are worth."""

    end: End
    q_base: Array
    grasps: Array
    scores: Scores


@pytest.fixture(scope="session")
def kitchen() -> Problem:
    return load_problem("wineglass")


@pytest.fixture(scope="session")
def kitchen_score(kitchen: Problem) -> ScoreFunction:
    return score_function(kitchen)


@pytest.fixture(scope="session", params=list(End), ids=lambda end: end.name.lower())
def evaluated(
    request: pytest.FixtureRequest, kitchen_score: ScoreFunction
) -> Evaluated:
    end, rng = request.param, np.random.default_rng(1)
    space = search_space(kitchen_score)
    q_base = space.bases[end].q_base(space.bases[end].sample(400, rng))
    grasps = space.grasps.sample(400, rng)
    return Evaluated(end, q_base, grasps, kitchen_score(end, q_base, grasps))
