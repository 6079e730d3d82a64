"""Which outlines bound a solid of revolution."""

from __future__ import annotations

import pytest

from mmplan.files.profile import profile_fault

GLASS = [(0.0, 0.0), (0.034, 0.0), (0.0045, 0.02), (0.035, 0.1), (0.0, 0.02)]


@pytest.mark.parametrize("shift", range(len(GLASS)))
@pytest.mark.parametrize("step", [1, -1])
def test_a_simple_outline_is_good_from_any_point_either_way(
    shift: int, step: int
) -> None:
    outline = (GLASS[shift:] + GLASS[:shift])[::step]
    assert profile_fault(outline) is None


@pytest.mark.parametrize(
    ("outline", "message"),
    [
        ([(0.0, 0.0), (1.0, 1.0)], "at least 3 points"),
        ([(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 1.0)], "point 2 is repeated"),
        ([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)], "crosses itself"),
        ([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 0.0)], "crosses itself"),
        ([(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0)], "crosses itself"),
        ([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)], "on a line"),
        ([(0.0, 0.0), (1e-6, 0.0), (0.0, 1e-6)], "no area"),
        ([(float(i), float(i * i)) for i in range(501)], "at most 500 points"),
    ],
)
def test_faulty_outlines(outline: list[tuple[float, float]], message: str) -> None:
    assert message in (profile_fault(outline) or "")
