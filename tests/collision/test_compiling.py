"""Compiled code: made once, before it is wanted, and at no search's expense."""

from __future__ import annotations

import subprocess
import sys
import time

import numpy as np

from mmplan.collision import compile_motions, kernels, planning_clock
from tests.collision.test_motions import checkers

LOAD = """
import time
from mmplan.collision import compile_motions, planning_clock
from mmplan.collision.compiling import compiled_broadphase
compile_motions()
begin, mine = time.thread_time(), planning_clock()
assert compiled_broadphase() is not None
print(time.thread_time() - begin, planning_clock() - mine)
"""


def test_planning_is_not_charged_for_loading() -> None:
    told = subprocess.run(
        [sys.executable, "-c", LOAD], capture_output=True, text=True, check=True
    )
    spent, charged = map(float, told.stdout.split())
    assert 0.0 <= charged < 0.05 * spent


def test_planning_is_charged_for_work_only() -> None:
    compile_motions()
    begin = planning_clock()
    time.sleep(0.2)
    slept = planning_clock() - begin
    sum(range(1_000_000))
    assert slept < planning_clock() - begin
    assert slept < 0.1


def test_one_version_is_compiled_for_all_arrays() -> None:
    checker, _ = checkers("wineglass", "standing")
    q, dq = np.zeros((2, checker._model.nq))
    frozen = q.copy()
    frozen.flags.writeable = False
    assert checker.steps_collide(frozen, dq, 1) == checker.steps_collide(q, dq, 1)
    assert checker.any_collision(frozen[None]) == checker.any_collision(q[None])
    assert len(kernels.search_motion.signatures) == 1
    assert len(kernels.find_suspects.signatures) == 1


def test_tables_fill_the_arrays_that_hold_them() -> None:
    sizes = kernels.Sizes(joints=3, nq=4, moving=5, static=6, pairs=7, balls=2)
    numbers, integers = (np.zeros(n) for n in kernels.needed(sizes))
    integers = integers.astype(np.int64)
    integers[: len(sizes)] = sizes
    views = kernels.tables(numbers, integers)
    assert views.basis.shape == (3, 4, 3, 4)
    assert views.pairs.shape == (7, 4)
    for view in views:
        view[...] += 1
    assert np.all(numbers == 1.0)
    assert np.all(integers[len(sizes) + 1 :] == 1)
