"""Grasps, base placements and verified motions for mobile manipulators.

The method is that of Berenson, Kuffner and Choset, "An Optimization Approach to
Planning for Mobile Manipulation", ICRA 2008.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from mmplan.exceptions import (
    Diagnostic,
    InputError,
    MmplanError,
    NoPlanError,
    VerificationError,
)

if TYPE_CHECKING:
    from mmplan.explanation import explain
    from mmplan.pipeline import solve
    from mmplan.plan import Plan
    from mmplan.problem import Problem
    from mmplan.robot_build import load_robot
    from mmplan.scene_file import load_problem
    from mmplan.schema import scene_schema
    from mmplan.verification import examine, verify

__all__ = [
    "Diagnostic",
    "InputError",
    "MmplanError",
    "NoPlanError",
    "Plan",
    "Problem",
    "VerificationError",
    "examine",
    "explain",
    "load_problem",
    "load_robot",
    "scene_schema",
    "solve",
    "verify",
]

# Where names come from that are imported when they are first used, as Pinocchio and
# OMPL take their time.
_LATE = {
    "Plan": "mmplan.plan",
    "Problem": "mmplan.problem",
    "examine": "mmplan.verification",
    "explain": "mmplan.explanation",
    "load_problem": "mmplan.scene_file",
    "load_robot": "mmplan.robot_build",
    "scene_schema": "mmplan.schema",
    "solve": "mmplan.pipeline",
    "verify": "mmplan.verification",
}


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _LATE:
        raise AttributeError(f"module 'mmplan' has no attribute '{name}'")
    value = getattr(import_module(_LATE[name]), name)
    globals()[name] = value
    return value
