"""A copy of an object works in another process, and nothing of it is left behind."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Iterator

import pytest

from mmplan.exceptions import InputError, MmplanError
from mmplan.processes import Copy, copied

pytestmark = pytest.mark.skipif(
    "fork" not in multiprocessing.get_all_start_methods(),
    reason="processes cannot be forked here",
)


@pytest.fixture
def copy() -> Iterator[Copy[list[int]]]:
    with copied([1], 2, "counts") as other:
        assert other is not None
        yield other
    assert not multiprocessing.active_children()


def extended(numbers: list[int], number: int) -> list[int]:
    numbers.append(number)
    return numbers


def process_of(numbers: list[int]) -> int:  # noqa: ARG001
    return os.getpid()


def sleeping(numbers: list[int]) -> None:  # noqa: ARG001
    time.sleep(600.0)


class CannotTravelError(Exception):
    def __init__(self, first: int, second: int) -> None:
        super().__init__(f"{first} and {second}")


def failing(numbers: list[int], *, travels: bool) -> None:  # noqa: ARG001
    raise InputError("too few") if travels else CannotTravelError(1, 2)


def test_answers_come_in_the_order_of_the_questions(copy: Copy[list[int]]) -> None:
    answers = [copy.ask(extended, number) for number in (2, 3)]
    assert [answer() for answer in answers] == [[1, 2], [1, 2, 3]]
    assert copy.ask(process_of)() != os.getpid()


def test_what_is_raised_comes_through(copy: Copy[list[int]]) -> None:
    with pytest.raises(InputError, match="too few"):
        copy.ask(failing, travels=True)()
    with pytest.raises(RuntimeError, match=r"CannotTravelError.*1 and 2"):
        copy.ask(failing, travels=False)()
    assert copy.ask(extended, 2)() == [1, 2]  # and work goes on


def test_a_process_that_is_killed_is_told(copy: Copy[list[int]]) -> None:
    answer = copy.ask(sleeping)
    (child,) = multiprocessing.active_children()
    assert child.pid is not None
    os.kill(child.pid, signal.SIGKILL)
    child.join()
    message = "the process that counts was ended; try without --jobs"
    with pytest.raises(MmplanError, match=message):
        answer()
    with pytest.raises(MmplanError, match=message):
        copy.ask(sleeping)


def test_an_interrupt_is_left_to_who_asks(copy: Copy[list[int]]) -> None:
    os.kill(copy.ask(process_of)(), signal.SIGINT)
    assert copy.ask(extended, 2)() == [1, 2]


def test_work_that_nobody_wants_any_more_is_given_up() -> None:
    def interrupted() -> None:
        with copied([1], 2, "counts") as other:
            assert other is not None
            other.ask(sleeping)  # would outlast this test by far
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not multiprocessing.active_children()


def test_with_one_job_there_is_no_copy() -> None:
    with copied([1], 1, "counts") as other:
        assert other is None
    assert not multiprocessing.active_children()


def without_children(numbers: list[int]) -> bool:
    with copied(numbers, 2, "counts") as other:
        return other is None


def test_a_process_that_may_have_no_children_has_none(copy: Copy[list[int]]) -> None:
    assert copy.ask(without_children)()
