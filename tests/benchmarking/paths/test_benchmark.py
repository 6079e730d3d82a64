"""Runs of path planners, and their store."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mmplan.benchmarking.benchmark import Outcome
from mmplan.benchmarking.paths.arena import Arena
from mmplan.benchmarking.paths.benchmark import (
    Competitor,
    own_competitor,
    run_path_benchmark,
)
from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.benchmarking.paths.records import (
    Answer,
    PathRecord,
    PathStore,
    Prepared,
)
from mmplan.exceptions import InputError
from mmplan.problem import PlannerSettings
from tests.benchmarking.paths.made import panda, problem, problem_file


def compete(folder: Path, *competitors: Competitor, **options: Any) -> Outcome:
    path = problem_file(folder, problem(), problem(index=2, objects=[]))
    options = {"runs": 2} | options
    found = load_path_problems(path)
    return run_path_benchmark(found, panda(), competitors, folder / "out", **options)


def stored(folder: Path) -> list[PathRecord]:
    with PathStore(folder / "out") as store:
        return store.records()


class Straight:
    """A planner that looks at nothing, and counts how often it is asked."""

    def __init__(self, name: str, **settings: object) -> None:
        self.asked = 0
        self.competitor = Competitor(name, self.prepare, settings)

    def prepare(self, arena: Arena) -> Prepared:
        def plan(seed: int) -> Answer:
            self.asked += 1
            path = np.stack([arena.q_start, arena.q_goal])
            return Answer(path, 0.25 + seed, path, 0.5 + seed, message="blind")

        return Prepared(plan, 0.125)


def test_own_planners_go_around_and_are_proven(tmp_path: Path) -> None:
    settings = PlannerSettings(shortcuts=5)
    own = [own_competitor(name, settings) for name in ("RRTConnect", "BKPIECE1")]
    assert compete(tmp_path, *own, runs=1) == Outcome(0, 4, 0)
    for record in stored(tmp_path):
        assert (record.solved, record.valid_first, record.valid) == (True, True, True)
        assert record.fault == ""
        assert record.first_length is not None
        assert record.length is not None
        assert 1.6 <= record.length <= record.first_length + 1e-9
        assert record.seconds is not None
        assert 0.0 < record.first_seconds <= record.seconds
        assert record.states is not None
        assert record.states > 0
        assert record.step is not None
        assert 0.0 < record.step < 0.1


def test_what_collides_is_found_whatever_the_planner_says(tmp_path: Path) -> None:
    compete(tmp_path, Straight("blind").competitor, runs=1)
    blocked, free = stored(tmp_path)
    assert (blocked.number, blocked.solved) == (1, True)
    assert (blocked.valid_first, blocked.valid, blocked.collides) == (
        False,
        False,
        True,
    )
    assert "pillar (0) overlap" in blocked.fault
    assert (free.number, free.valid, free.collides, free.fault) == (2, True, False, "")
    assert (free.setup_seconds, free.first_seconds, free.seconds) == (0.125, 0.25, 0.5)


def test_an_interrupted_benchmark_goes_on_where_it_was(tmp_path: Path) -> None:
    def interrupt(done: int, total: int) -> None:
        assert total == 6
        if done == 2:
            raise KeyboardInterrupt

    planner = Straight("blind")
    with pytest.raises(KeyboardInterrupt):
        compete(tmp_path, planner.competitor, runs=3, progress=interrupt)
    before = stored(tmp_path)
    assert len(before) == planner.asked == 2
    outcome = compete(tmp_path, planner.competitor, runs=3)
    assert outcome == Outcome(before=2, done=4, left=0)
    assert planner.asked == 6
    after = stored(tmp_path)
    assert all(record in after for record in before)
    assert {(r.number, r.seed) for r in after} == {
        (n, s) for n in (1, 2) for s in (0, 1, 2)
    }


def test_other_settings_are_other_runs(tmp_path: Path) -> None:
    compete(tmp_path, Straight("blind", range=1).competitor)
    outcome = compete(tmp_path, Straight("blind", range=2).competitor)
    assert outcome == Outcome(before=0, done=4, left=0)


def test_families_can_be_chosen(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"unknown family 'piller'; did you mean"):
        compete(tmp_path, Straight("blind").competitor, families=["piller"])
    assert not (tmp_path / "out").exists()
    outcome = compete(tmp_path, Straight("blind").competitor, families=["pillar"])
    assert outcome.done == 4


def test_changed_problems_are_not_mixed_with_old_ones(tmp_path: Path) -> None:
    compete(tmp_path, Straight("blind").competitor)
    path = problem_file(tmp_path, problem(objects=[]))
    with pytest.raises(InputError, match="give another folder"):
        run_path_benchmark(
            load_path_problems(path),
            panda(),
            [Straight("blind").competitor],
            tmp_path / "out",
            runs=1,
        )
