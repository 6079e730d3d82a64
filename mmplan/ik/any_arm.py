"""The solver for an arm, chosen by how the axes of its joints lie to each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mmplan.exceptions import InputError
from mmplan.ik import InverseKinematics
from mmplan.ik.chain import Chain, arm_chain
from mmplan.ik.closed import Closed
from mmplan.ik.numeric import Numeric
from mmplan.ik.redundant import Redundant
from mmplan.ik.sampling import lattice
from mmplan.ik.settings import IkSettings, ik_settings
from mmplan.ik.six_joints import Found, closed_form
from mmplan.shapes import Array

# Solutions of an arm with a freedom left are the same motion of it when nearer than
# this (rad or m); other solutions are isolated.
_SAME_MOTION = 0.1
_SAME_POINT = 1e-4
# The second attempt at poses that samples do not solve is short, as most of these are
# out of reach: starts, size of their table, steps and patience.
_RESCUE = (4, 1024, 25, 3)


class _Held(NamedTuple):
    """A choice of joints to hold such that the others have a closed form."""

    front: int
    found: Found


def auto(
    model: pin.Model,
    joints: Sequence[str],
    tool_frame: int,
    settings: Mapping[str, float],
) -> InverseKinematics:
    """A closed form if the arm has one, with joints held if need be; else iteration."""
    chosen = ik_settings(settings)
    chain = arm_chain(model, joints, tool_frame)
    return _by_subproblems(chain, chosen) or _by_iteration(
        chain, chosen, f"no closed form is known for this arm of {len(chain)} joints"
    )


def subproblems(
    model: pin.Model,
    joints: Sequence[str],
    tool_frame: int,
    settings: Mapping[str, float],
) -> InverseKinematics:
    """The solver in closed form.

    Raises:
        InputError: None is known for this arm.
    """
    chosen = ik_settings(settings)
    solver = _by_subproblems(arm_chain(model, joints, tool_frame), chosen)
    if solver is None:
        raise InputError(
            f"ik: the solver 'subproblems' knows no closed form for the axes of "
            f"{', '.join(joints)}; use 'numeric' or 'auto'"
        )
    return solver


def numeric(
    model: pin.Model,
    joints: Sequence[str],
    tool_frame: int,
    settings: Mapping[str, float],
) -> InverseKinematics:
    """The solver by iteration, for any arm."""
    chain = arm_chain(model, joints, tool_frame)
    return _by_iteration(chain, ik_settings(settings), "as robot.yaml asks for")


def _by_iteration(chain: Chain, settings: IkSettings, why: str) -> Numeric:
    isolated = len(chain) <= 6
    return Numeric(
        chain=chain,
        seeds=settings.seeds,
        table=settings.table,
        steps=settings.steps,
        patience=10,
        apart=_SAME_POINT if isolated else _SAME_MOTION,
        explanation=f"by iteration from {settings.seeds} starts: {why}; "
        "cannot prove a pose unreachable",
    )


def _by_subproblems(chain: Chain, settings: IkSettings) -> Closed | Redundant | None:
    held = _held(chain)
    if held is None:
        return None
    reason = held.found.reason
    if held.found.deviation > 1e-9:
        reason += f" to {held.found.deviation:.1g}, polished"
    if len(chain) == 6:
        return Closed(chain, held.found.form, f"closed form: {reason}")
    return _redundant(chain, settings, held, reason)


def _held(chain: Chain) -> _Held | None:
    """The joints to hold: the first ones rather than the last, if either will do."""
    spare = len(chain) - 6
    for front in range(spare, -1, -1):
        found = closed_form(chain.part(range(front, front + 6)), front + 1)
        if found is not None:
            return _Held(front, found)
    return None


def _redundant(
    chain: Chain, settings: IkSettings, held: _Held, reason: str
) -> Redundant:
    joints = [*range(held.front), *range(held.front + 6, len(chain))]
    values = _samples(chain.part(joints), settings)
    rescue = Numeric(chain, *_RESCUE, _SAME_MOTION, "a second attempt")
    names = ", ".join(chain.names[i] for i in joints)
    return Redundant(
        chain=chain,
        form=held.found.form,
        front=held.front,
        held=values,
        deviation=held.found.deviation,
        most=settings.solutions,
        rescue=rescue,
        explanation=f"closed form at {len(values)} samples of {names}: {reason}",
    )


def _samples(held: Chain, settings: IkSettings) -> Array:
    """Values of the joints held, (samples, joints), spread evenly over their ranges."""
    count = settings.samples * settings.lift_samples ** (len(held) - 1)
    spread = lattice(count, len(held))
    spread[:, -1] = (np.arange(count) + 0.5) / count
    lower, upper = held.ranges
    return lower + (upper - lower) * spread
