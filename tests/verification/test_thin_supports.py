"""A support that is thinner than the tolerance may be touched, and not passed."""

from __future__ import annotations

from functools import cache

import pytest

from mmplan.collision import TOUCH_TOLERANCE
from mmplan.plan import Plan
from mmplan.problem import Obstacle
from mmplan.shapes import Box
from mmplan.verification import examine
from tests.honest import COUNTER_TOP, MOVED, bottle_plan, bottle_problem, shift

THICKNESS = 0.0005  # m


@cache
def plan() -> Plan:
    """The bottle is lifted by 8 cm, carried along y, and put down."""
    return bottle_plan()


def sheet(y: float, above_counter: float) -> Obstacle:
    """A sheet whose lower side is so high (m) above the counter."""
    z = COUNTER_TOP + above_counter + THICKNESS / 2
    return Obstacle("sheet", Box((0.1, 0.1, THICKNESS)), shift(0.9, y, z))


def test_the_sheet_is_thinner_than_the_tolerance() -> None:
    assert THICKNESS < TOUCH_TOLERANCE


@pytest.mark.parametrize("y", [0.0, MOVED])
def test_a_sheet_under_the_bottle_carries_it(y: float) -> None:
    """The bottle is a fifth of a millimetre deep in it at rest, less than half."""
    assert examine(plan(), bottle_problem(sheet(y, 0.0002 - THICKNESS))).ok


@pytest.mark.parametrize("y", [0.0, MOVED])
@pytest.mark.parametrize("above_counter", [0.0, 0.0004, 0.002, 0.009, 0.05])
def test_a_sheet_through_the_bottle_does_not(y: float, above_counter: float) -> None:
    """Also within the contact zone, and where the depth is within the tolerance."""
    report = examine(plan(), bottle_problem(sheet(y, above_counter)))
    assert {fault.kind for fault in report.faults} == {"collision"}
    assert all("sheet and bottle" in fault.message for fault in report.faults)


@pytest.mark.parametrize("above_counter", [0.0798, 0.1, 0.15])
def test_a_sheet_on_the_way_is_no_support(above_counter: float) -> None:
    """Outside the contact zones the least touch is a collision."""
    report = examine(plan(), bottle_problem(sheet(MOVED / 2, above_counter)))
    assert {fault.kind for fault in report.faults} == {"collision"}
    assert any("sheet and bottle" in fault.message for fault in report.faults)
