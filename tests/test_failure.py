"""The account of a failure adds up and names what was in the way."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from mmplan.failure import Attempt, FailureReport, failure_report
from mmplan.grasps import Axis
from mmplan.motion import Blocked
from mmplan.optimizers import OPTIMIZERS, Optimization, optimize, search_space
from mmplan.pipeline import score_function
from mmplan.scene_file import load_problem
from mmplan.scoring import End, Outcome, ScoreFunction

EVALUATIONS = 1200


@pytest.fixture(scope="module")
def score() -> ScoreFunction:
    """The wineglass with grasps of the bowl alone, which do not fit into the rack."""
    problem = load_problem("wineglass")
    (glass,) = problem.objects
    bowl = replace(glass, grasps={"bowl": Axis((0.13, 0.2))})
    return score_function(replace(problem, objects=(bowl,)))


@pytest.fixture(scope="module")
def found(score: ScoreFunction) -> Optimization:
    settings = score.problem.optimizer
    rng = np.random.default_rng(0)
    optimizer = OPTIMIZERS["coevolution"](search_space(score), settings, rng)
    return optimize(score, optimizer, EVALUATIONS, candidates=5)


@pytest.fixture(scope="module")
def report(score: ScoreFunction, found: Optimization) -> FailureReport:
    return failure_report(0, score, found, ())


def test_every_evaluation_is_accounted_for(
    report: FailureReport, found: Optimization
) -> None:
    counts = [sum(end.outcomes.values()) for end in report.ends]
    assert sum(counts) == report.evaluations == EVALUATIONS
    for end in End:
        at_end = np.count_nonzero(found.evaluated.end == end)
        assert counts[end] == at_end > 0
        assert set(report.ends[end].outcomes) == {o.label for o in Outcome}
    feasible = Outcome.SCORED.label
    assert report.ends[End.START].outcomes[feasible] > 0
    assert report.ends[End.GOAL].outcomes[feasible] == 0


def test_what_collides_is_named_most_frequent_first(
    report: FailureReport, score: ScoreFunction
) -> None:
    problem = score.problem
    links = {problem.robot.link_of(b) for b in problem.robot.geometry.geometryObjects}
    owners = {body.owner for body in score.worlds[End.START].bodies}
    for end in report.ends:
        assert 1 <= len(end.collisions) <= 5
        shares = [share for _, _, share in end.collisions]
        assert shares == sorted(shares, reverse=True)
        assert all(0.0 < share <= 1.0 for share in shares)
        for first, second, _ in end.collisions:
            assert first in links
            assert second in owners
    at_goal = {second for _, second, _ in report.ends[End.GOAL].collisions}
    assert any(name.startswith("dishwasher/") for name in at_goal)


def test_collisions_named_are_those_that_happen(
    report: FailureReport, score: ScoreFunction, found: Optimization
) -> None:
    q_base, grasps, end = found.evaluated.q_base, found.evaluated.grasps, End.GOAL
    rows = np.flatnonzero(found.evaluated.end == end)
    hit = np.isin(
        score(end, q_base[rows], grasps[rows]).outcome,
        [Outcome.BASE_COLLISION, Outcome.COLLISION, Outcome.HAND_OPEN_COLLISION],
    )
    assert 10 < hit.sum() <= 300  # so few that all are looked at again
    seen: Counter[tuple[str, str]] = Counter()
    for row in rows[hit]:
        contacts = score.contacts(end, q_base[row], grasps[row])
        assert contacts
        seen.update({(c.first, c.second) for c in contacts})
    for first, second, share in report.ends[end].collisions:
        assert share == pytest.approx(seen[first, second] / hit.sum())
    most = max(seen.values()) / hit.sum()
    assert report.ends[end].collisions[0][2] == pytest.approx(most)


def test_the_report_as_json(report: FailureReport) -> None:
    content = json.loads(json.dumps(report.to_json(), allow_nan=False))
    assert content["object"] == "wineglass"
    assert content["evaluations"] == EVALUATIONS
    ends = content["ends"].values()
    assert sum(sum(end["outcomes"].values()) for end in ends) == EVALUATIONS
    assert content["grasps"]["start_only"] > 0
    assert content["grasps"]["both"] == content["grasps"]["goal_only"] == 0
    first = content["ends"]["goal"]["collisions"][0]
    assert {"first", "second", "share"} == set(first)


def test_the_report_in_lines(report: FailureReport) -> None:
    lines = list(report.lines())
    assert lines[0] == "task 1 (wineglass): no grasp works at the goal"
    assert lines[1].startswith(f"of {EVALUATIONS} evaluations ")
    assert max(map(len, lines)) <= 100
    text = "\n".join(lines)
    for end in report.ends:
        for label, count in end.outcomes.items():
            assert (label in text) or count == 0
        for first, second, share in end.collisions:
            assert f"  {first} / {second} ({share:.0%})" in lines
    start_only, _, _ = report.grasps_by_end
    assert f"grasps that work: {start_only} at the start only, 0 at the goal" in text


@pytest.mark.parametrize(
    ("grasps", "reason"),
    [
        ((0, 0, 0), "no grasp works at either end"),
        ((3, 0, 0), "no grasp works at the goal"),
        ((0, 3, 0), "no grasp works at the start"),
        ((3, 2, 0), "no single grasp works at both ends"),
        ((3, 2, 1), "no grasp of the last population works at both ends"),
    ],
)
def test_the_reason_follows_from_where_grasps_work(
    grasps: tuple[int, int, int],
    reason: str,
    score: ScoreFunction,
    found: Optimization,
) -> None:
    counted = replace(found, grasps_by_end=grasps)
    assert failure_report(0, score, counted, ()).reason == reason


def test_attempts_are_told_one_by_one(
    score: ScoreFunction, found: Optimization
) -> None:
    attempts = (
        Attempt(150.25, Blocked("transfer", "no way through")),
        Attempt(140.0, Blocked("transit", "walled in")),
        Attempt(130.0, Blocked("transfer", "no way through either")),
    )
    report = failure_report(1, score, found, attempts)
    assert report.reason == (
        "all 3 candidates failed on the way: transfer (2), transit (1)"
    )
    lines = list(report.lines())
    assert lines[0].startswith("task 2 (wineglass): all 3 candidates")
    assert lines[-3] == "candidate 1 (score 150.2): transfer: no way through"
    told = report.to_json()["attempts"]
    assert told[1] == {"score": 140.0, "segment": "transit", "message": "walled in"}


def test_nothing_in_collision_names_nothing(
    score: ScoreFunction, found: Optimization
) -> None:
    nothing = replace(found, evaluated=found.evaluated.head(0))
    report = failure_report(0, score, nothing, ())
    assert [end.collisions for end in report.ends] == [(), ()]
