"""Benchmarks that are killed at random moments, or run twice at once."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from mmplan.benchmarking import run_benchmark
from mmplan.exceptions import InputError
from tests.benchmarking.made import (
    contest_scene,
    has_runs,
    is_group_alive,
    results,
    start,
    stored,
    wait_until,
)

RUNS, BUDGET = 35, 50
INTERRUPTIONS = 20

# Forks processes that do what is missing, and kills each at a random moment: some
# while they start, some in the middle of their first run or of a later one.
KILLER = """
import os, random, signal, sys, time
from mmplan.benchmarking.benchmark import run_benchmark, scheduler_of

def work(scene, folder, runs, budget, jobs, told):
    run_benchmark([scene], folder, runs=int(runs), evaluations=[int(budget)],
                  scheduler=scheduler_of(jobs, None),
                  progress=lambda done, of: os.write(told, b"."))

if __name__ == "__main__":
    *arguments, interruptions = sys.argv[1:]
    moments = random.Random(0)
    for i in range(int(interruptions)):
        read, told = os.pipe()
        process = os.fork()
        if process == 0:
            work(*arguments, jobs=2 if i % 10 == 9 else 1, told=told)
            os._exit(0)
        for _ in range(i % 3):
            os.read(read, 1)
        time.sleep(moments.uniform(0.0, 0.3))
        os.kill(process, signal.SIGKILL)
        _, status = os.waitpid(process, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)
        os.close(read), os.close(told)
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return contest_scene(tmp_path_factory.mktemp("scene"))


@pytest.fixture(scope="module")
def undisturbed(scene: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of the whole benchmark, done in one go in this process."""
    folder = tmp_path_factory.mktemp("undisturbed")
    outcome = run_benchmark([scene], folder, runs=RUNS, evaluations=[BUDGET])
    assert (outcome.before, outcome.done, outcome.left) == (0, 2 * RUNS, 0)
    return folder


def test_interrupted_twenty_times_it_ends_with_the_same(
    scene: Path, undisturbed: Path, tmp_path: Path
) -> None:
    program, folder = tmp_path / "killer.py", tmp_path / "results"
    program.write_text(KILLER)
    arguments = [program, scene, folder, RUNS, BUDGET, INTERRUPTIONS]
    done = subprocess.run(
        [sys.executable, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    codes = [int(line) for line in done.stdout.split()]
    assert codes == INTERRUPTIONS * [-signal.SIGKILL]
    before = len(stored(folder))
    assert INTERRUPTIONS / 2 < before < 2 * RUNS
    outcome = run_benchmark([scene], folder, runs=RUNS, evaluations=[BUDGET])
    assert (outcome.before, outcome.done) == (before, 2 * RUNS - before)
    assert results(folder) == results(undisturbed)


def test_a_finished_benchmark_does_nothing_again(
    scene: Path, undisturbed: Path
) -> None:
    before = stored(undisturbed)
    outcome = run_benchmark([scene], undisturbed, runs=RUNS, evaluations=[BUDGET])
    assert (outcome.before, outcome.done) == (2 * RUNS, 0)
    assert stored(undisturbed) == before


def test_more_runs_are_added_to_those_that_are_there(
    scene: Path, undisturbed: Path, tmp_path: Path
) -> None:
    run_benchmark([scene], tmp_path, runs=3, evaluations=[BUDGET])
    outcome = run_benchmark([scene], tmp_path, runs=5, evaluations=[BUDGET])
    assert (outcome.before, outcome.done) == (6, 4)
    assert results(tmp_path) == [r for r in results(undisturbed) if r["seed"] < 5]


def test_two_processes_share_the_work_of_one_store(
    scene: Path, undisturbed: Path, tmp_path: Path
) -> None:
    arguments = ("--runs", str(RUNS), "--evaluations", str(BUDGET), "--json")
    folder = tmp_path / "results"
    both = [start(scene, "-o", folder, *arguments) for _ in range(2)]
    outcomes = []
    for process in both:
        output, errors = process.communicate(timeout=120)
        assert (process.returncode, errors) == (0, "")
        outcomes.append(json.loads(output))
    assert sum(outcome["done"] for outcome in outcomes) == 2 * RUNS
    assert all(outcome["done"] > 0 for outcome in outcomes)
    assert results(folder) == results(undisturbed)


def test_a_scene_changed_in_between_is_refused(scene: Path, tmp_path: Path) -> None:
    copy = tmp_path / "cup.yaml"
    copy.write_text(scene.read_text())
    run_benchmark([copy], tmp_path, runs=1, evaluations=[BUDGET])
    copy.write_text(scene.read_text() + "# another word\n")
    with pytest.raises(InputError, match="give another folder"):
        run_benchmark([copy], tmp_path, runs=2, evaluations=[BUDGET])
    assert len(stored(tmp_path)) == 2


def test_code_changed_in_between_is_refused(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_benchmark([scene], tmp_path, runs=1, evaluations=[BUDGET])
    changed = "mmplan.benchmarking.benchmark.software"
    monkeypatch.setattr(changed, lambda: "mmplan 0.1.0 (code of tomorrow)")
    with pytest.raises(InputError, match="holds runs of other software"):
        run_benchmark([scene], tmp_path, runs=2, evaluations=[BUDGET])


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_ctrl_c_ends_it_cleanly(scene: Path, tmp_path: Path, jobs: str) -> None:
    folder = tmp_path / "results"
    process = start(scene, "-o", folder, "--evaluations", BUDGET, "--jobs", jobs)
    wait_until(lambda: has_runs(folder))
    os.killpg(process.pid, signal.SIGINT)
    output, errors = process.communicate(timeout=20)
    assert process.returncode == 130
    assert output == ""
    assert errors == "mmplan: interrupted\n"
    wait_until(lambda: not is_group_alive(process.pid))
    done = len(stored(folder))
    assert 0 < done < 400
