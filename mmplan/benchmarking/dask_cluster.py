"""Runs on the workers of an existing Dask cluster. The one door to Dask."""

from __future__ import annotations

import asyncio
import threading
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mmplan.benchmarking.records import Job, Record
from mmplan.exceptions import InputError, MmplanError

if TYPE_CHECKING:
    from distributed import Client

_PATIENCE = 30  # s to wait for the scheduler, and then for its first worker
# Jobs that lie with the cluster for each of its threads: one is done, one waits.
_AHEAD = 2

# OMPL's random numbers belong to the process, and so does its CPU time.
_one_at_a_time = threading.Lock()


@dataclass(frozen=True)
class DaskCluster:
    """The workers of a Dask scheduler.

    They need this mmplan and the scene files under the same paths. A run whose worker
    is lost is done again by another.
    """

    address: str

    def __call__(self, jobs: Iterator[Job]) -> Iterator[Record]:
        """What came of the jobs, as they finish.

        Raises:
            InputError: There is no such scheduler, or it has no workers.
            MmplanError: A run was refused, or killed several workers.
        """
        client = self._connect()
        try:
            yield from _do(client, jobs)
        finally:
            client.close()  # forgets what is left; the cluster drops it then

    def _connect(self) -> Client:
        try:
            from distributed import Client
        except ImportError:
            raise InputError(
                "a Dask scheduler needs Dask: pip install 'mmplan[distributed]'"
            ) from None
        try:
            client = Client(self.address, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError, asyncio.TimeoutError) as error:
            raise InputError(f"no Dask scheduler at {self.address}: {error}") from None
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except asyncio.TimeoutError:
            client.close()
            raise InputError(
                f"the Dask scheduler at {self.address} has no workers"
            ) from None
        return client


def _do(client: Client, jobs: Iterator[Job]) -> Iterator[Record]:
    from distributed import KilledWorker, as_completed

    session = uuid.uuid4().hex
    futures = as_completed(loop=client.loop)
    while True:
        while futures.count() < _AHEAD * max(1, sum(client.nthreads().values())):
            job = next(jobs, None)
            if job is None:
                break
            name = f"mmplan-{session}-{job.key.digest}"
            futures.add(client.submit(_run_alone, job, key=name, pure=False))
        if futures.is_empty():
            return
        future = next(futures)
        try:
            yield future.result()
        except KilledWorker as error:
            raise MmplanError(str(error)) from None


def _run_alone(job: Job) -> Record:
    """Do a run while nothing else of this kind goes on in the process."""
    from mmplan.benchmarking.runs import run

    with _one_at_a_time:
        return run(job)
