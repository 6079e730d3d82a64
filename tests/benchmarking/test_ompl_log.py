"""The log in OMPL's format, read by OMPL's own converter."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from mmplan.benchmarking import Store, run_benchmark
from mmplan.benchmarking.contests import Contest, contests
from mmplan.benchmarking.ompl_log import ompl_log
from mmplan.benchmarking.records import Record
from tests.benchmarking.made import contest_scene, converted, entry, failed, made_up

BUDGET = 150


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> tuple[Contest, str]:
    """A small contest of optimizers with RRTConnect, and its log."""
    folder = tmp_path_factory.mktemp("contest")
    scene = contest_scene(folder)
    options = {"runs": 2, "evaluations": [BUDGET], "planners": ["RRTConnect"]}
    run_benchmark([scene], folder / "results", **options)  # type: ignore[arg-type]
    with Store(folder / "results") as store:
        (contest,) = contests(store)
        return contest, ompl_log(contest, store.software())


def test_the_converter_reads_back_what_was_stored(
    planned: tuple[Contest, str], tmp_path: Path
) -> None:
    contest, log = planned
    with closing(converted(log, tmp_path)) as database:
        rows = database.execute(
            "SELECT p.name AS planner, runs.* FROM runs"
            " JOIN plannerConfigs p ON p.id = plannerid"
        ).fetchall()
    names = ["CoEvolution+RRTConnect", "RandomSampling+RRTConnect"]
    assert sorted({row["planner"] for row in rows}) == names
    assert list(contest.contenders) == names
    assert len(rows) == 4
    for row in rows:
        by_seed = {r.seed: r for r in contest.contenders[row["planner"]]}
        check_row(row, by_seed[row["seed"]])


def check_row(row: sqlite3.Row, record: Record) -> None:
    assert record.plan is not None
    assert row["score"] == record.score
    assert row["evaluations"] == record.used == BUDGET
    assert row["cycles"] == record.cycles
    assert row["solved"] == int(record.plan["verified"])
    assert row["feasible"] == int(record.success)
    assert row["candidates_tried"] == record.plan["tried"]
    assert row["motion_time"] == record.plan.get("duration")
    assert row["time"] == pytest.approx(sum(t["wall"] for t in record.times.values()))
    assert row["cpu_inverse_kinematics"] == record.times["inverse kinematics"]["cpu"]
    if record.success:
        assert row["base_start_x"] == record.ends["start"]["base"][0]
        assert row["base_goal_y"] == record.ends["goal"]["base"][1]
        ends = row["score_start"] + row["score_goal"]
        assert ends == pytest.approx(record.score)


def test_columns_have_the_types_that_the_arena_wants(
    planned: tuple[Contest, str], tmp_path: Path
) -> None:
    with closing(converted(planned[1], tmp_path)) as database:
        columns = database.execute("PRAGMA table_info(runs)").fetchall()
        types = {c["name"]: c["type"] for c in columns}
        experiment = database.execute("SELECT * FROM experiments").fetchone()
    assert types["score"] == "REAL"
    assert types["evaluations"] == "INTEGER"
    assert types["solved"] == "BOOLEAN"
    assert types["status"] == "ENUM"
    assert experiment["name"] == f"tabletop_{BUDGET}"
    assert experiment["version"] == "mmplan 0.1.0"
    assert experiment["runcount"] == 2
    assert float(experiment["best_score"]) == planned[0].best
    assert planned[0].problem.fingerprint in experiment["setup"]


def test_the_progress_is_the_history(tmp_path: Path) -> None:
    record = made_up(
        history=[[5, 10.0], [9, 30.0], [6940, 30.0]], seconds=[0.25, 0.25, 1.5]
    )
    contest = Contest(entry(), 6940, 100.0, {"CoEvolution": [record]})
    with closing(converted(ompl_log(contest, "mmplan"), tmp_path)) as database:
        rows = database.execute("SELECT * FROM progress ORDER BY time").fetchall()
    # Both first scores were known at the same time: the second counts.
    assert [(r["time"], r["evaluations"], r["best_score"]) for r in rows] == [
        (0.25, 9, 30.0),
        (1.5, 6940, 30.0),
    ]


def test_failed_runs_have_gaps_instead_of_numbers(tmp_path: Path) -> None:
    runs = [failed(seed=0, cycles=None), made_up(seed=1)]
    contest = Contest(entry(), 6940, 80.0, {"CoEvolution": runs})
    with closing(converted(ompl_log(contest, "mmplan"), tmp_path)) as database:
        bad, good = database.execute("SELECT * FROM runs ORDER BY seed").fetchall()
        statuses = database.execute("SELECT * FROM enums").fetchall()
        settings = database.execute("SELECT settings FROM plannerConfigs").fetchone()
    assert (bad["solved"], bad["score"], bad["cycles"]) == (0, 0.0, None)
    assert (bad["base_start_x"], bad["score_start"]) == (None, 0.0)
    assert (good["solved"], good["normalized_score"]) == (1, 100.0)
    meaning = {s["value"]: s["description"] for s in statuses}
    assert meaning[good["status"]] == "Exact solution"
    assert meaning[bad["status"]] == "Timeout"
    assert json.dumps({}) in settings["settings"]
