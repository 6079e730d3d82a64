"""A copy of an object in another process, that works while this one does too."""

from __future__ import annotations

import multiprocessing
import pickle
import signal
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, Concatenate, Generic, ParamSpec, TypeVar

from mmplan.exceptions import MmplanError

if TYPE_CHECKING:
    from multiprocessing.context import ForkProcess

T = TypeVar("T")
P = ParamSpec("P")
R = TypeVar("R")

# What a pipe raises whose other end is closed.
_GONE = (EOFError, BrokenPipeError, ConnectionResetError)


class Copy(Generic[T]):
    """Does with a copy of an object what it is asked to, in another process, at once.

    Functions, what they take and what they give must be such as can be pickled.
    """

    def __init__(self, pipe: Connection, task: str) -> None:
        """Ask through an end of a pipe; `task` is what the process does, in words."""
        self._pipe = pipe
        self._ended = f"the process that {task} was ended; try without --jobs"

    def ask(
        self, do: Callable[Concatenate[T, P], R], *args: P.args, **named: P.kwargs
    ) -> Callable[[], R]:
        """Begin to call a function of the object; what is returned gives its answer.

        Calls are made one after the other, and answers are fetched in the same order.
        What the function raises is raised there.

        Raises:
            MmplanError: The process has ended; also where the answer is fetched.
        """
        try:
            self._pipe.send((do, args, named))
        except _GONE:
            raise MmplanError(self._ended) from None
        return self._answer

    def _answer(self) -> Any:
        """What the next call gave, whatever its type."""
        try:
            answer, error = self._pipe.recv()
        except _GONE:
            raise MmplanError(self._ended) from None
        if error is not None:
            raise error
        return answer


@contextmanager
def copied(subject: T, jobs: int, task: str) -> Iterator[Copy[T] | None]:
    """A copy of an object in another process while the context lasts.

    What it is still working on when the context ends is given up. There is none with
    one job, nor where processes cannot be forked.
    """
    if jobs < 2 or not _can_fork():
        yield None
        return
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(subject, theirs, ours), daemon=True)
    with warnings.catch_warnings():
        # The threads that Python warns of show progress: the copy has no use for them.
        warnings.simplefilter("ignore", DeprecationWarning)
        _start_without_interrupts(process)
    theirs.close()
    try:
        yield Copy(ours, task)
    finally:
        process.kill()
        process.join()
        ours.close()


def _start_without_interrupts(process: ForkProcess) -> None:
    """Start a process that Ctrl-C is kept from: who asks is interrupted as well."""
    usual = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        process.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, usual)


def _can_fork() -> bool:
    """Whether there is a fork here; processes of a pool may have no others."""
    forks = "fork" in multiprocessing.get_all_start_methods()
    return forks and not multiprocessing.current_process().daemon


def _serve(subject: T, pipe: Connection, other_end: Connection) -> None:
    """Answer until there is nobody left to ask."""
    other_end.close()
    with suppress(*_GONE):
        while True:
            do, args, named = pipe.recv()
            pipe.send(_outcome(partial(do, subject, *args, **named)))


def _outcome(call: Callable[[], R]) -> tuple[R | None, Exception | None]:
    """What a call gives and what it raises, one of which is None."""
    try:
        return call(), None
    except Exception as error:  # noqa: BLE001
        return None, _portable(error)


def _portable(error: Exception) -> Exception:
    """An error that another process can raise: itself, or one that tells of it."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # noqa: BLE001
        return RuntimeError(repr(error))
    return error
