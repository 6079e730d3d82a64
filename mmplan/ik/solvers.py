"""The inverse-kinematics solvers by the names that robot.yaml gives them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

import pinocchio as pin

from mmplan.ik import InverseKinematics
from mmplan.ik.any_arm import auto, numeric, subproblems
from mmplan.ik.puma import puma

# From a model, the arm's joints, the id of the tool frame, and the solver's settings.
Solver: TypeAlias = Callable[
    [pin.Model, Sequence[str], int, Mapping[str, float]], InverseKinematics
]

SOLVERS: dict[str, Solver] = {
    "auto": auto,
    "numeric": numeric,
    "puma": puma,
    "subproblems": subproblems,
}
