"""Inverse kinematics in closed form, for arms of six joints."""

from __future__ import annotations

from dataclasses import dataclass, field

from mmplan.ik import Solutions
from mmplan.ik.branches import Pruning, pack
from mmplan.ik.chain import Chain
from mmplan.ik.polish import polish
from mmplan.ik.poses import components
from mmplan.ik.six_joints import ClosedForm
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Closed:
    """A solver for six joints that turn: all solutions, each measured on the chain."""

    chain: Chain
    form: ClosedForm
    explanation: str
    complete: bool = field(default=True, init=False)

    def solve(self, T_base_tool: Array) -> Solutions:
        """All solutions for tool poses (n, 4, 4) in the frame of the base."""
        displacement = components(T_base_tool @ self.chain.T_tool_home)
        found = self.form.solve(displacement, Pruning.none(len(self.chain)))
        found = polish(self.chain, found, components(T_base_tool))
        return pack(self.chain, found, len(T_base_tool))
