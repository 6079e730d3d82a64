import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mmplan.collision import coarse_to_fine


@given(st.integers(1, 3000))
def test_every_step_comes_once_and_the_end_first(steps):
    order = coarse_to_fine(steps)[:, 0]
    assert order[0] == steps
    assert np.array_equal(np.sort(order), np.arange(1, steps + 1))


@given(st.integers(4, 3000))
def test_early_steps_are_spread_over_the_motion(steps):
    early = np.sort(coarse_to_fine(steps)[:4, 0])
    assert np.diff(early).min() >= steps // 8
