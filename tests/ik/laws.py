"""Laws of inverse kinematics, judged by Pinocchio's forward kinematics."""

from __future__ import annotations

import numpy as np

from benchmarks._wheel_arms import Arm
from mmplan.ik import InverseKinematics, Solutions
from mmplan.shapes import Array

ACCURACY = 1e-9


def turn_apart(q: Array, other: Array) -> Array:
    """The largest joint difference up to whole turns, over the last axis."""
    return np.abs((q - other + np.pi) % (2 * np.pi) - np.pi).max(axis=-1)


def assert_reached(arm: Arm, T: Array, solutions: Solutions) -> None:
    """Every solution puts the tool where it was asked for."""
    row, branch = np.nonzero(solutions.exists)
    found = arm.tool_poses(solutions.q[row, branch])
    np.testing.assert_allclose(found, T[row], rtol=0, atol=ACCURACY)


def assert_no_duplicates(solutions: Solutions) -> None:
    for q in (row[e] for row, e in zip(solutions.q, solutions.exists, strict=True)):
        apart = turn_apart(q[:, None], q[None, :]) + 10 * np.eye(len(q))
        assert apart.min(initial=10.0) > 1e-7


def assert_masks(solutions: Solutions, lower: Array, upper: Array) -> None:
    """`within` is exactly within the limits, and only what exists has numbers."""
    assert np.isnan(solutions.q[~solutions.exists]).all()
    assert np.isfinite(solutions.q[solutions.exists]).all()
    inside = ((solutions.q >= lower) & (solutions.q <= upper)).all(axis=2)
    np.testing.assert_array_equal(solutions.within, inside)


def assert_batch_is_single(solver: InverseKinematics, T: Array) -> None:
    batch = solver.solve(T)
    for i in range(len(T)):
        single = solver.solve(T[i : i + 1])
        b = single.exists.shape[1]
        np.testing.assert_array_equal(single.exists[0], batch.exists[i, :b])
        np.testing.assert_array_equal(single.within[0], batch.within[i, :b])
        np.testing.assert_allclose(single.q[0], batch.q[i, :b], rtol=0, atol=1e-9)
        assert not batch.exists[i, b:].any()


def source_found(solutions: Solutions, q: Array, near: float = 1e-6) -> np.ndarray:
    """Whether the configurations q (n, k) are among the solutions, (n,)."""
    apart = np.where(solutions.exists, turn_apart(solutions.q, q[:, None]), np.inf)
    return np.asarray(apart.min(axis=1) < near)
