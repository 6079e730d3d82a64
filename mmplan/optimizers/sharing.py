"""The goal's scores in a process of its own, while this one does the start's."""

from __future__ import annotations

import multiprocessing
import signal
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from typing import TypeAlias

from mmplan.exceptions import MmplanError
from mmplan.scoring import End, ScoreFunction, Scores
from mmplan.shapes import Array

# Bases (n, b) and grasps (n, g) to score at the goal.
_Question: TypeAlias = tuple[Array, Array]
# What a pipe raises whose other end is closed.
_GONE = (EOFError, BrokenPipeError, ConnectionResetError)
_ENDED = "the process that scores the goal was ended; try without --jobs"


class GoalProcess:
    """A copy of a score function that answers for the goal, in another process.

    It does the same in the same order as the score function itself would, so that the
    answers are the same to the last bit.
    """

    def __init__(self, pipe: Connection) -> None:
        """Ask through an end of a pipe."""
        self._pipe = pipe

    def ask(self, q_base: Array, grasps: Array) -> None:
        """Let it begin to score bases (n, b) with grasp genes (n, g).

        Raises:
            MmplanError: The process has ended.
        """
        try:
            self._pipe.send((q_base, grasps))
        except _GONE:
            raise MmplanError(_ENDED) from None

    def answer(self) -> Scores:
        """The scores of what was asked for last.

        Raises:
            MmplanError: The process ended before.
            Exception: What a term of the score raised.
        """
        try:
            answer: Scores | Exception = self._pipe.recv()
        except _GONE:
            raise MmplanError(_ENDED) from None
        if isinstance(answer, Exception):
            raise answer
        return answer


@contextmanager
def goal_process(score: ScoreFunction, jobs: int) -> Iterator[GoalProcess | None]:
    """Another process for the goal while the context lasts; None with one job.

    There is none either where processes cannot be forked.
    """
    if jobs < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield None
        return
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(score, theirs, ours), daemon=True)
    with warnings.catch_warnings():
        # The threads that Python warns of show progress: the copy has no use for them.
        warnings.simplefilter("ignore", DeprecationWarning)
        process.start()
    theirs.close()
    try:
        yield GoalProcess(ours)
    finally:
        ours.close()
        process.join()


def _serve(score: ScoreFunction, pipe: Connection, other_end: Connection) -> None:
    """Answer until there is nobody left to ask."""
    other_end.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who asks is interrupted as well
    with suppress(*_GONE):
        while True:
            question: _Question = pipe.recv()
            pipe.send(_answer(score, *question))


def _answer(score: ScoreFunction, q_base: Array, grasps: Array) -> Scores | Exception:
    """The scores at the goal, or what is to be raised where they were asked for."""
    try:
        return score(End.GOAL, q_base, grasps)
    except Exception as error:  # noqa: BLE001
        return error
