"""Legs and candidates planned at once come to what they come to one by one."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Generator, Mapping
from dataclasses import replace
from functools import cache
from typing import TypeAlias

import numpy as np
import pytest

from mmplan import pipeline
from mmplan.candidate import Candidate
from mmplan.collision import CollisionWorld
from mmplan.exceptions import MmplanError
from mmplan.motion import Blocked, Outcome, TaskMotion
from mmplan.motion.connections import Connection, Connector
from mmplan.motion.parts import BlockedError, Part
from mmplan.scoring import End, ScoreFunction
from mmplan.shapes import Array
from tests.tabletop import cup_problem, walled_in

pytestmark = pytest.mark.skipif(
    "fork" not in multiprocessing.get_all_start_methods(),
    reason="processes cannot be forked here",
)
CANDIDATES = 3
WALLED = Blocked("transit", "no way out")


@cache
def optimized() -> tuple[ScoreFunction, list[Candidate]]:
    problem = cup_problem()
    few = replace(problem.optimizer, evaluations=1500)
    score = pipeline.score_function(replace(problem, optimizer=few))
    found = pipeline._optimize(score, np.random.default_rng(0), pipeline._ignore)
    triples = found.candidates[:CANDIDATES]
    return score, [Candidate.of_triple(triple, score) for triple in triples]


def motion(jobs: int) -> TaskMotion:
    score, _ = optimized()
    return TaskMotion(score.problem, score.task, score.worlds[End.START], True, jobs)


def planned(jobs: int, number: int = 0, seed: int = 1) -> Outcome:
    _, candidates = optimized()
    outcome = motion(jobs).plan(candidates[number], np.random.default_rng(seed))
    assert not multiprocessing.active_children()
    return outcome


def bits(outcome: Outcome) -> object:
    if isinstance(outcome, Blocked):
        return outcome
    return [
        (
            s.name,
            *(
                (x.tobytes(), x.flags.writeable)
                for x in (s.times, s.positions, s.velocities)
            ),
            {name: T.tobytes() for name, T in s.attached.items()},
        )
        for s in outcome
    ]


Connect: TypeAlias = Callable[
    [
        Connector,
        str,
        CollisionWorld,
        Array,
        Mapping[int, Connection],
        np.random.Generator,
    ],
    tuple[int, Part, list[Part]],
]


@pytest.fixture
def before(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Has something happen before a leg is planned, in either process."""
    connect: Connect = Connector.connect

    def patch(**happens: Callable[[np.random.Generator], object]) -> None:
        def patched(
            self: Connector,
            name: str,
            world: CollisionWorld,
            q_start: Array,
            ways: Mapping[int, Connection],
            rng: np.random.Generator,
        ) -> tuple[int, Part, list[Part]]:
            if name in happens:
                happens[name](rng)
            return connect(self, name, world, q_start, ways, rng)

        monkeypatch.setattr(Connector, "connect", patched)

    return patch


def blocked(segment: str) -> Callable[[np.random.Generator], None]:
    def raising(rng: np.random.Generator) -> None:  # noqa: ARG001
        raise BlockedError(segment, "no way out")

    return raising


def draw(rng: np.random.Generator) -> None:
    rng.random(7)


def sleep(rng: np.random.Generator) -> None:  # noqa: ARG001
    time.sleep(600.0)


def be_killed(rng: np.random.Generator) -> None:  # noqa: ARG001
    if multiprocessing.parent_process() is not None:
        os.kill(os.getpid(), signal.SIGKILL)


def interrupt(rng: np.random.Generator) -> None:  # noqa: ARG001
    raise KeyboardInterrupt


def divide_by_zero(rng: np.random.Generator) -> None:  # noqa: ARG001
    raise ZeroDivisionError("no such transfer")


@pytest.mark.parametrize("number", range(CANDIDATES))
def test_two_processes_plan_what_one_plans(number: int) -> None:
    one, two = (planned(jobs, number) for jobs in (1, 2))
    assert bits(one) == bits(two)


def test_a_leg_draws_nothing_from_the_other(before: Callable[..., None]) -> None:
    usual = planned(1)
    before(transit=draw)
    other = planned(1)
    assert not isinstance(usual, Blocked)
    assert not isinstance(other, Blocked)
    names = [segment.name for segment in usual]
    transfer = names.index("transfer")
    assert bits(usual[transfer:]) == bits(other[transfer:])
    before(transfer=draw)
    assert bits(planned(1)[:transfer]) == bits(usual[:transfer])


def test_a_transit_that_ends_on_another_winding_is_met(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    usual = planned(1)
    arm = cup_problem().robot.arm.indices

    def unlikely(self: Connector, way: Connection, q_start: Array) -> Array:  # noqa: ARG001
        turn = np.zeros(len(q_start))
        turn[arm[-1]] = 2.0 * np.pi
        return turn

    monkeypatch.setattr(Connector, "likely_turn", unlikely)
    assert bits(planned(1)) == bits(planned(2)) == bits(usual)


def test_the_other_process_does_plan_the_transfer(before: Callable[..., None]) -> None:
    def only_there(rng: np.random.Generator) -> None:  # noqa: ARG001
        assert multiprocessing.parent_process() is not None

    before(transfer=only_there)
    assert not isinstance(planned(2), Blocked)
    with pytest.raises(AssertionError):
        planned(1)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_transit_that_fails_is_told_at_once(
    jobs: int, before: Callable[..., None]
) -> None:
    before(transit=blocked("transit"), transfer=sleep)  # by far longer than this test
    assert planned(jobs) == WALLED


@pytest.mark.parametrize("jobs", [1, 2])
def test_of_two_legs_that_fail_the_first_is_told(
    jobs: int, before: Callable[..., None]
) -> None:
    before(transit=blocked("transit"), transfer=blocked("transfer"))
    assert planned(jobs) == WALLED
    before(transfer=blocked("transfer"))
    assert planned(jobs) == Blocked("transfer", "no way out")


def test_what_stands_in_the_way_is_the_same() -> None:
    _, (candidate, *_) = optimized()
    problem = walled_in()
    brief = replace(problem, planner=replace(problem.planner, iterations=99))
    score = pipeline.score_function(brief)
    world = score.worlds[End.START]
    one, two = (
        TaskMotion(brief, score.task, world, jobs=jobs).plan(
            candidate, np.random.default_rng(1)
        )
        for jobs in (1, 2)
    )
    assert isinstance(one, Blocked)
    assert one == two
    assert one.segment == "transit"


@pytest.mark.parametrize("jobs", [1, 2])
def test_what_is_raised_comes_through(jobs: int, before: Callable[..., None]) -> None:
    before(transfer=divide_by_zero)
    with pytest.raises(ZeroDivisionError, match="no such transfer"):
        planned(jobs)


def test_a_process_that_is_killed_is_told(
    before: Callable[..., None], capfd: pytest.CaptureFixture[str]
) -> None:
    before(transfer=be_killed)
    with pytest.raises(MmplanError) as caught:
        planned(2)
    assert str(caught.value) == (
        "the process that plans the transfer was ended; try without --jobs"
    )
    assert not multiprocessing.active_children()
    assert capfd.readouterr() == ("", "")


def test_an_interrupt_leaves_nothing_behind(
    before: Callable[..., None], capfd: pytest.CaptureFixture[str]
) -> None:
    before(transit=interrupt, transfer=sleep)
    with pytest.raises(KeyboardInterrupt):
        planned(2)
    assert not multiprocessing.active_children()
    assert capfd.readouterr() == ("", "")


def in_turn(jobs: int) -> Generator[tuple[int, Outcome]]:
    _, candidates = optimized()
    return motion(jobs).plan_in_turn(candidates, np.random.default_rng(1))


def test_candidates_planned_at_once_come_to_the_same() -> None:
    one, two = (list(in_turn(jobs)) for jobs in (1, 2))
    assert [number for number, _ in one] == list(range(CANDIDATES))
    assert [(k, bits(outcome)) for k, outcome in one] == [
        (k, bits(outcome)) for k, outcome in two
    ]
    assert not multiprocessing.active_children()


def test_the_other_process_plans_the_next_but_one(
    before: Callable[..., None],
) -> None:
    def fail(rng: np.random.Generator) -> None:  # noqa: ARG001
        there = multiprocessing.parent_process() is not None
        raise BlockedError("transit", "there" if there else "here")

    before(transit=fail, transfer=sleep)
    told = {jobs: [x.message for _, x in in_turn(jobs)] for jobs in (1, 2)}
    assert told == {1: ["here", "here", "here"], 2: ["here", "here", "there"]}


def test_nobody_waits_for_a_candidate_that_is_not_needed(
    before: Callable[..., None],
) -> None:
    def fail(rng: np.random.Generator) -> None:
        if multiprocessing.parent_process() is not None:
            sleep(rng)
        raise BlockedError(WALLED.segment, WALLED.message)

    before(transit=fail)
    outcomes = in_turn(2)
    assert [next(outcomes), next(outcomes)] == [(0, WALLED), (1, WALLED)]
    assert multiprocessing.active_children()
    outcomes.close()
    assert not multiprocessing.active_children()
