"""The cubic curve that a plan is made of, between its samples."""

from __future__ import annotations

import numpy as np


def hermite(
    time: float, times: np.ndarray, positions: np.ndarray, velocities: np.ndarray
) -> np.ndarray:
    """Joint positions (joints,) at a time; times (n,), the others (n, joints)."""
    k = int(np.clip(np.searchsorted(times, time, "right") - 1, 0, len(times) - 2))
    h = times[k + 1] - times[k]
    s = (time - times[k]) / h
    start = (2 * s**3 - 3 * s**2 + 1) * positions[k]
    start += (s**3 - 2 * s**2 + s) * h * velocities[k]
    end = (3 * s**2 - 2 * s**3) * positions[k + 1]
    return start + end + (s**3 - s**2) * h * velocities[k + 1]
