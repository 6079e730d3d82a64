"""Runs in this process, or in several of this machine."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any, Protocol

from mmplan.benchmarking.records import Job, Record
from mmplan.exceptions import MmplanError

# A run whose process died is given to another this often.
_RETRIES = 1


class Scheduler(Protocol):
    """Does jobs somewhere; takes the next one only when there is somebody to do it."""

    def __call__(self, jobs: Iterator[Job]) -> Iterator[Record]:
        """What came of the jobs, as they finish."""
        ...


class InThisProcess:
    """One run after the other."""

    def __call__(self, jobs: Iterator[Job]) -> Iterator[Record]:
        """What came of the jobs, in their order."""
        from mmplan.benchmarking.runs import run

        for job in jobs:
            yield run(job)


@dataclass(frozen=True)
class LocalProcesses:
    """As many processes of this machine, each doing one run after the other.

    They end with this one, however it ends: their pipes break.
    """

    number: int

    def __call__(self, jobs: Iterator[Job]) -> Iterator[Record]:
        """What came of the jobs, as they finish.

        Raises:
            MmplanError: A run was refused, or killed two processes.
        """
        todo = _Queue(jobs)
        busy: list[_Worker] = []
        idle: list[_Worker] = []
        try:
            while True:
                while len(busy) < self.number and (task := todo.next()):
                    busy.append(idle.pop() if idle else _Worker())
                    busy[-1].begin(task)
                if not busy:
                    return
                for worker in _with_answers(busy):
                    busy.remove(worker)
                    idle.append(worker)
                    record = worker.answer()
                    if record is None:
                        idle.remove(worker)
                        todo.again(worker.task, worker.end())
                    else:
                        yield record
        finally:
            for worker in busy + idle:
                worker.end()


@dataclass(frozen=True)
class _Task:
    job: Job
    failures: int = 0


class _Queue:
    """Jobs to do, those of processes that died first."""

    def __init__(self, jobs: Iterator[Job]) -> None:
        self._jobs = jobs
        self._again: list[_Task] = []

    def next(self) -> _Task | None:
        if self._again:
            return self._again.pop()
        job = next(self._jobs, None)
        return None if job is None else _Task(job)

    def again(self, task: _Task, code: int | None) -> None:
        if task.failures == _RETRIES:
            raise MmplanError(
                f"{task.job.key}: the processes that did this run died, the last with "
                f"exit code {code}"
            )
        self._again.append(_Task(task.job, task.failures + 1))


class _Worker:
    """A process that does jobs, seen from the one that hands them out."""

    task: _Task

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()

    def begin(self, task: _Task) -> None:
        self.task = task
        try:
            self.pipe.send(task.job)
        except BrokenPipeError:
            return  # it died; reading its answer will tell

    def answer(self) -> Record | None:
        """What came of the task, None if the process died of it."""
        try:
            answer = self.pipe.recv()
        except (EOFError, ConnectionResetError):
            return None
        if isinstance(answer, MmplanError):
            raise answer
        assert isinstance(answer, Record)
        return answer

    def end(self) -> int | None:
        """End the process, whatever it is doing; its exit code."""
        self._process.terminate()
        self._process.join()
        self.pipe.close()
        return self._process.exitcode


def _with_answers(workers: list[_Worker]) -> list[_Worker]:
    """Those whose task is done, or who died, once there is one."""
    ready = wait([worker.pipe for worker in workers])
    return [worker for worker in workers if worker.pipe in ready]


def _serve(pipe: Connection[Any, Any]) -> None:
    """Do one job after the other until nobody is there any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for who hands them out
    from mmplan.benchmarking.runs import run

    while True:
        try:
            job = pipe.recv()
        except (EOFError, ConnectionResetError):
            return
        try:
            answer: Record | MmplanError = run(job)
        except MmplanError as error:
            answer = error
        try:
            pipe.send(answer)
        except BrokenPipeError:
            return
