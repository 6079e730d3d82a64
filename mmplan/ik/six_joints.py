"""Which closed form an arm of six turning joints has, by how its axes lie."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from mmplan.ik.branches import Candidates, Pruning
from mmplan.ik.chain import Chain
from mmplan.ik.lines import meeting, parallel
from mmplan.ik.parallel_axes import ParallelAxes
from mmplan.ik.poses import Poses
from mmplan.ik.spherical_wrist import (
    Placing,
    Shoulder,
    SphericalWrist,
    place_meeting_12,
    place_meeting_23,
    place_parallel_12,
    place_parallel_23,
)
from mmplan.ik.wrist import Wrist
from mmplan.shapes import Array

# How far (m) a point may be missed by rounding, and by axes that deviate: so many
# times the deviation.
_ROUNDING = 1e-11
_LEVERAGE = 20.0


class ClosedForm(Protocol):
    """All solutions of an arm of six joints, from how the tool has moved."""

    def solve(self, displacement: Poses, pruning: Pruning) -> Candidates:
        """The joints (6, m) whose motion from 0 moves the tool as given."""
        ...


class Found(NamedTuple):
    """A closed form, why it applies, and how far the axes are from what it assumes."""

    form: ClosedForm
    reason: str
    deviation: float  # m or rad


@dataclass(frozen=True, eq=False)
class FromTool:
    """A closed form of the same arm seen from the tool, joint 6 first."""

    form: ClosedForm

    def solve(self, displacement: Poses, pruning: Pruning) -> Candidates:
        """The joints (6, m) whose motion from 0 moves the tool as given."""
        turned = Pruning(pruning.lower[::-1], pruning.upper[::-1])
        found = self.form.solve(displacement.inverse(), turned)
        return Candidates(found.pose, found.q[::-1])


def closed_form(chain: Chain, number: int = 1) -> Found | None:
    """The closed form of an arm, seen from its base or from its tool, if it has one.

    `number` is what its first joint is called in the reason.
    """
    if len(chain) != 6 or chain.prismatic.any():
        return None
    numbers = tuple(range(number, number + 6))
    forward = _Lines(chain.axes, chain.points, np.mean(chain.ranges, axis=0), numbers)
    # Seen from the tool each joint turns the other way.
    backward = _Lines(
        -chain.axes[::-1],
        chain.points[::-1],
        forward.middles[::-1],
        forward.numbers[::-1],
    )
    seen_from_tool = (
        Found(FromTool(found.form), found.reason, found.deviation)
        for found in _closed_forms(backward)
    )
    found = [*_closed_forms(forward), *seen_from_tool]
    # What deviates least: of two forms that apply the other may be a coincidence.
    return min(found, key=lambda f: round(f.deviation, 9), default=None)


class _Lines(NamedTuple):
    """The axes of six joints in an order, and what the joints are called there."""

    axes: Array  # (6, 3)
    points: Array  # (6, 3)
    middles: Array  # (6,), the middle of each joint's limits
    numbers: tuple[int, ...]

    def called(self, *joints: int) -> str:
        """The numbers of some joints, in the arm's order."""
        *most, last = sorted(self.numbers[i] for i in joints)
        return f"{', '.join(map(str, most))} and {last}"


def _closed_forms(lines: _Lines) -> Iterator[Found]:
    found = _three_parallel(lines)
    if found is not None:
        yield found
    yield from _spherical_wrists(lines)


def _spherical_wrists(lines: _Lines) -> Iterator[Found]:
    axes, points = lines.axes, lines.points
    centre = meeting(list(axes[3:]), list(points[3:]))
    if centre is None:
        return
    wrist = Wrist(axes[3], axes[4], axes[5])
    idle = float(lines.middles[3])
    name = f"spherical wrist (axes {lines.called(3, 4, 5)} meet)"
    for placing, pair, reason, shifted, deviation in _placings(lines):
        total = deviation + centre.deviation
        shoulder = Shoulder(*shifted, centre.point, _ROUNDING + _LEVERAGE * total)
        form = SphericalWrist(shoulder, placing, wrist, idle)
        yield Found(form, f"{name}, axes {lines.called(*pair)} {reason}", total)


def _placings(
    lines: _Lines,
) -> Iterator[tuple[Placing, tuple[int, int], str, tuple[Array, Array], float]]:
    """Ways of placing the wrist's centre: the pair of axes, and what is made exact."""
    parallels = {(1, 2): place_parallel_23, (0, 1): place_parallel_12}
    meetings = {(0, 1): place_meeting_12, (1, 2): place_meeting_23}
    for pair, placing in parallels.items():
        angle = parallel(*lines.axes[list(pair)])
        if angle is not None:
            axes = _aligned(lines.axes[:3], pair)
            yield placing, pair, "parallel", (axes, lines.points[:3]), angle
    for pair, placing in meetings.items():
        index = list(pair)
        met = meeting(list(lines.axes[index]), list(lines.points[index]))
        if met is not None:
            points = lines.points[:3].copy()
            points[index] = met.point
            yield placing, pair, "meet", (lines.axes[:3], points), met.deviation


def _three_parallel(lines: _Lines) -> Found | None:
    axes, points = lines.axes, lines.points
    angles = [parallel(axes[1], axes[i]) for i in (2, 3)]
    centre = meeting(list(axes[4:]), list(points[4:]))
    if centre is None or angles[0] is None or angles[1] is None:
        return None
    if parallel(axes[0], axes[1]) is not None:
        return None
    deviation = angles[0] + angles[1] + centre.deviation
    exact_axes = _aligned(axes, (1, 2, 3))
    exact_points = points.copy()
    exact_points[4:] = centre.point
    wrist = Wrist(exact_axes[1], exact_axes[4], exact_axes[5])
    form = ParallelAxes(
        exact_axes, exact_points, wrist, _ROUNDING + _LEVERAGE * deviation
    )
    reason = f"axes {lines.called(1, 2, 3)} parallel, {lines.called(4, 5)} meet"
    return Found(form, reason, deviation)


def _aligned(axes: Array, joints: Sequence[int]) -> Array:
    """The axes with some of them made exactly parallel to the first of these."""
    exact = axes.copy()
    first = axes[joints[0]]
    for joint in joints[1:]:
        exact[joint] = np.sign(axes[joint] @ first) * first
    return exact
