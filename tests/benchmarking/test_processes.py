"""Local processes: the same results as one, and what happens when one dies."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from mmplan.benchmarking import run_benchmark
from mmplan.benchmarking.processes import LocalProcesses
from mmplan.exceptions import InputError, MmplanError
from mmplan.optimizers import CoEvolution, OptimizerFactory
from tests.benchmarking.made import (
    children,
    contest_scene,
    has_runs,
    is_alive,
    results,
    start,
    stored,
    wait_until,
)

BUDGET = 50
# Where the optimizer below finds the file that tells whether it died before.
DIED = "MMPLAN_TEST_DIED"


class DiesOnce(CoEvolution):
    """Takes its process with it, the first time that there is one."""

    def __init__(self, *arguments: object) -> None:
        try:
            os.close(os.open(os.environ[DIED], os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            super().__init__(*arguments)  # type: ignore[arg-type]
        else:
            os._exit(3)


class DiesAlways(CoEvolution):
    """Takes its process with it."""

    def __init__(self, *_: object) -> None:
        os._exit(3)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return contest_scene(tmp_path_factory.mktemp("scene"))


def test_two_processes_give_what_one_gives(scene: Path, tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    for jobs in (1, 2):
        run_benchmark(
            [scene],
            tmp_path / str(jobs),
            runs=5,
            evaluations=[BUDGET, 90],
            scheduler=None if jobs == 1 else LocalProcesses(jobs),
            progress=lambda done, of: told.append((done, of)),
        )
    assert results(tmp_path / "1") == results(tmp_path / "2")
    assert told == 2 * [(i, 20) for i in range(1, 21)]


def test_a_run_whose_process_dies_is_done_again(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(DIED, str(tmp_path / "died"))
    outcomes = [
        run_benchmark(
            [scene],
            tmp_path / name,
            runs=4,
            evaluations=[BUDGET],
            optimizers={"mine": factory},
            scheduler=LocalProcesses(2),
        )
        for name, factory in (("dying", DiesOnce), ("living", CoEvolution))
    ]
    assert (tmp_path / "died").exists()
    assert outcomes[0] == outcomes[1]
    dying, living = (stored(tmp_path / name) for name in ("dying", "living"))
    assert [replace(r, label="").result for r in dying] == [
        replace(r, label="").result for r in living
    ]


def test_a_run_that_kills_every_process_is_named(scene: Path, tmp_path: Path) -> None:
    contenders: dict[str, OptimizerFactory] = {"bad": DiesAlways}
    with pytest.raises(MmplanError, match=r"tabletop by bad, 50 .*exit code 3"):
        run_benchmark(
            [scene],
            tmp_path,
            runs=1,
            evaluations=[BUDGET],
            optimizers=contenders,
            scheduler=LocalProcesses(1),
        )


def test_a_refusal_in_another_process_is_raised_here(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mmplan.benchmarking.benchmark.software", lambda: "mmplan 9")
    with pytest.raises(InputError, match="a run was made for mmplan 9, but here"):
        run_benchmark(
            [scene], tmp_path, runs=1, evaluations=[9], scheduler=LocalProcesses(2)
        )


def test_processes_end_with_the_one_that_was_killed(
    scene: Path, tmp_path: Path
) -> None:
    process = start(scene, "-o", tmp_path / "results", "--jobs", 2, "--evaluations", 50)
    wait_until(lambda: has_runs(tmp_path / "results"))
    workers = children(process.pid)
    assert len(workers) >= 2
    process.kill()
    process.communicate()
    wait_until(lambda: not any(map(is_alive, workers)))
