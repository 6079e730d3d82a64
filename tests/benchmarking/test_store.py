"""The store: what goes in comes out, what does not belong is refused."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from mmplan.benchmarking import Record, Store
from mmplan.benchmarking.store import STORE_FILE
from mmplan.exceptions import InputError
from tests.benchmarking.made import entry, failed, made_up


def a_job(record: Record) -> Any:
    """All that the store looks at in a job."""
    return SimpleNamespace(key=record.key)


def test_records_come_back_as_they_went_in(tmp_path: Path) -> None:
    plan = {"verified": True, "tried": 1, "refuted": 0, "attempts": []}
    records = [
        made_up(score=0.1 + 0.2, seed=0),
        failed(seed=1, failure="there is no room", cycles=None),
        made_up(seed=2, plan=plan, planner="RRTConnect"),
    ]
    with Store(tmp_path / "new" / "folder", create=True) as store:
        for record in records:
            store.add(record)
    with Store(tmp_path / "new" / "folder") as store:
        assert sorted(store.records(), key=lambda r: r.seed) == records


def test_a_run_is_stored_once_and_stays_as_it_is(tmp_path: Path) -> None:
    with Store(tmp_path, create=True) as store:
        store.add(made_up(score=80.0))
        store.add(made_up(score=90.0))
        assert [r.score for r in store.records()] == [80.0]


@pytest.mark.parametrize(
    "change",
    [
        {"problem": "plate"},
        {"optimizer": "random"},
        {"evaluations": 500},
        {"planner": "PRM"},
        {"seed": 1},
        {"settings": '{"bases": 7}'},
    ],
)
def test_runs_that_differ_in_what_they_are_are_kept_apart(
    tmp_path: Path, change: dict[str, Any]
) -> None:
    with Store(tmp_path, create=True) as store:
        store.add(made_up())
        other = a_job(made_up(**change))
        assert store.missing([other, a_job(made_up())]) == [other]
        store.add(made_up(**change))
        assert store.missing([other]) == []


def test_the_best_score_counts_every_run_of_a_problem(tmp_path: Path) -> None:
    with Store(tmp_path, create=True) as store:
        assert store.best() == {}
        store.add(made_up(score=80.0))
        store.add(made_up(score=95.0, evaluations=20_000, optimizer="random"))
        store.add(failed(problem="plate"))
        assert store.best() == {"wineglass": 95.0}


def test_a_changed_scene_is_refused(tmp_path: Path) -> None:
    with Store(tmp_path, create=True) as store:
        store.register(entry(), "mmplan 1")
        store.register(entry(), "mmplan 1")
        with pytest.raises(InputError, match="or of this one before it was changed"):
            store.register(replace(entry(), fingerprint="0" * 64), "mmplan 1")
        store.register(entry("plate"), "mmplan 1")
        assert [p.name for p in store.problems()] == ["wineglass", "plate"]
        assert store.problems()[0] == entry()


def test_other_software_is_refused(tmp_path: Path) -> None:
    with Store(tmp_path, create=True) as store:
        store.register(entry(), "mmplan 1")
        with pytest.raises(InputError, match="there: mmplan 1\n  here:  mmplan 2"):
            store.register(entry("plate"), "mmplan 2")
        assert [p.name for p in store.problems()] == ["wineglass"]
        assert store.software() == "mmplan 1"


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no results"):
        Store(tmp_path)


def test_a_file_that_is_no_store_is_refused(tmp_path: Path) -> None:
    (tmp_path / STORE_FILE).write_text("something else altogether " * 99)
    with pytest.raises(InputError, match="not a database"):
        Store(tmp_path)


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="file/results"):
        Store(tmp_path / "file" / "results", create=True)


def test_a_store_of_another_format_is_refused(tmp_path: Path) -> None:
    Store(tmp_path, create=True).close()
    database = sqlite3.connect(tmp_path / STORE_FILE)
    database.execute("PRAGMA user_version = 99")
    database.close()
    with pytest.raises(InputError, match="has format 99; this mmplan reads 1"):
        Store(tmp_path)


def test_a_transaction_that_fails_leaves_nothing(tmp_path: Path) -> None:
    with Store(tmp_path, create=True) as store:
        with pytest.raises(TypeError):
            store.add(made_up(plan={"not": {"JSON"}}))
        with pytest.raises(sqlite3.Error):
            store.add(made_up(host=object()))
        assert store.records() == []
        store.add(made_up())
        assert len(store.records()) == 1


OTHER_PROCESS = """
import sys
from types import SimpleNamespace
from mmplan.benchmarking import Store
from tests.benchmarking.made import made_up
store = Store(sys.argv[1])
print(store.claim(SimpleNamespace(key=made_up().key)), flush=True)
sys.stdin.read()
"""


def claimed_elsewhere(folder: Path) -> subprocess.Popen[str]:
    """A process that claims the made-up run and holds on to it."""
    return subprocess.Popen(
        [sys.executable, "-c", OTHER_PROCESS, str(folder)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[2],
    )


def test_a_claim_lasts_as_long_as_its_process(tmp_path: Path) -> None:
    job = a_job(made_up())
    with Store(tmp_path, create=True) as store:
        with claimed_elsewhere(tmp_path) as other:
            assert other.stdout is not None
            assert other.stdout.readline() == "True\n"
            assert not store.claim(job)
            assert store.claim(a_job(made_up(seed=1)))
            other.kill()
        assert store.claim(job)
        with claimed_elsewhere(tmp_path) as other:
            assert other.communicate("")[0] == "False\n"


def test_a_stored_run_cannot_be_claimed(tmp_path: Path) -> None:
    with Store(tmp_path, create=True) as store:
        assert store.claim(a_job(made_up()))
        store.add(made_up())
        assert not store.claim(a_job(made_up()))
        with claimed_elsewhere(tmp_path) as other:
            assert other.communicate("")[0] == "False\n"
