"""A Dask cluster on loopback: a worker is killed, and every run is there once."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from mmplan.benchmarking import run_benchmark
from mmplan.benchmarking.dask_cluster import DaskCluster
from mmplan.exceptions import InputError
from tests.benchmarking.made import contest_scene, results, wait_until

pytest.importorskip("distributed", reason="needs the extra 'distributed'")

RUNS, BUDGET = 12, 50


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return contest_scene(tmp_path_factory.mktemp("scene"))


@contextlib.contextmanager
def dask(*arguments: str, folder: Path) -> Iterator[subprocess.Popen[str]]:
    """One of Dask's programs while the block runs."""
    with (folder / f"{arguments[0]}.log").open("a") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "dask", *arguments],
            stdout=log,
            stderr=log,
            text=True,
            cwd=folder,
        )
        try:
            yield process
        finally:
            process.kill()
            process.wait()


@contextlib.contextmanager
def scheduler(folder: Path) -> Iterator[str]:
    """The address of a scheduler on a port that was free."""
    where = folder / "scheduler.json"
    options = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    place = ("--scheduler-file", str(where))
    with dask("scheduler", *options, *place, folder=folder):
        wait_until(where.exists)
        log = folder / "scheduler.log"
        wait_until(lambda: "Scheduler at:" in log.read_text())
        (line,) = (s for s in log.read_text().splitlines() if "Scheduler at:" in s)
        yield line.split()[-1]


def worker(
    address: str, folder: Path
) -> contextlib.AbstractContextManager[subprocess.Popen[str]]:
    """A worker that nobody starts again when it dies."""
    options = ("--nthreads", "1", "--no-nanny", "--no-dashboard")
    return dask("worker", address, *options, "--host", "127.0.0.1", folder=folder)


def test_a_cluster_that_loses_a_worker_gives_what_one_process_gives(
    scene: Path, tmp_path: Path
) -> None:
    run_benchmark([scene], tmp_path / "local", runs=RUNS, evaluations=[BUDGET])
    with (
        scheduler(tmp_path) as address,
        worker(address, tmp_path) as victim,
        worker(address, tmp_path),
    ):
        told: list[int] = []

        def kill_in_the_middle(done: int, _of: int) -> None:
            told.append(done)
            if done == RUNS // 2:
                victim.kill()

        outcome = run_benchmark(
            [scene],
            tmp_path / "cluster",
            runs=RUNS,
            evaluations=[BUDGET],
            scheduler=DaskCluster(address),
            progress=kill_in_the_middle,
        )
        assert victim.poll() is not None
    assert (outcome.done, outcome.left) == (2 * RUNS, 0)
    assert told == list(range(1, 2 * RUNS + 1))
    assert results(tmp_path / "cluster") == results(tmp_path / "local")


def test_a_refusal_of_a_worker_is_raised_here(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mmplan.benchmarking.benchmark.software", lambda: "mmplan 9")
    with (
        scheduler(tmp_path) as address,
        worker(address, tmp_path),
        pytest.raises(InputError, match="a run was made for mmplan 9, but here"),
    ):
        run_benchmark(
            [scene],
            tmp_path / "results",
            runs=1,
            evaluations=[BUDGET],
            scheduler=DaskCluster(address),
        )


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nothing://at-all"])
def test_an_address_without_a_scheduler_is_refused(
    scene: Path, tmp_path: Path, address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mmplan.benchmarking.dask_cluster._PATIENCE", 1)
    with pytest.raises(InputError, match=f"no Dask scheduler at {address}"):
        run_benchmark([scene], tmp_path, runs=1, scheduler=DaskCluster(address))


def test_a_scheduler_without_workers_is_refused(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mmplan.benchmarking.dask_cluster._PATIENCE", 1)
    with (
        scheduler(tmp_path) as address,
        pytest.raises(InputError, match="has no workers"),
    ):
        run_benchmark([scene], tmp_path, runs=1, scheduler=DaskCluster(address))
