"""OMPL's state space over the moving joints, and its checks against the world.

States are joint values times the joints' longest lever arms, so that OMPL's distances
are lengths in the workspace (m).

The objects that Python hands to OMPL must not keep the `SpaceInformation`: OMPL keeps
them, and such a cycle is never freed.
"""

from __future__ import annotations

import numpy as np
from ompl import base as ob

from mmplan.planning.checking import PathChecker
from mmplan.planning.joints import MovingJoints
from mmplan.shapes import Array

# Sampled joint values keep this share of their range away from the joint limits, so
# that rounding and the timing of a path cannot carry it over a limit.
LIMIT_MARGIN = 1e-3


class ScaledStates:
    """Turns OMPL's states into configurations and back."""

    def __init__(self, q_still: Array, joints: MovingJoints, weights: Array) -> None:
        """Take the still joints' values from `q_still` (nq,); weights (nq,)."""
        self._q_still = q_still
        self._indices = joints.indices
        self._weights = weights[joints.indices]
        self.dimension = len(joints.indices)

    def configuration(self, state: ob.State) -> Array:
        """The configuration (nq,) of a state."""
        q: Array = self.configurations(np.array([state[0 : self.dimension]]))[0]
        return q

    def configurations(self, scaled: Array) -> Array:
        """The configurations (n, nq) of coordinates (n, dimension)."""
        q = np.tile(self._q_still, (len(scaled), 1))
        q[:, self._indices] = scaled / self._weights
        return q

    def scaled(self, q: Array) -> Array:
        """The coordinates (..., dimension) of configurations (..., nq)."""
        return q[..., self._indices] * self._weights

    def write(self, q: Array, state: ob.State) -> None:
        """Set a state to a configuration (nq,)."""
        for i, value in enumerate(self.scaled(q)):
            state[i] = float(value)


class WorldValidity(ob.StateValidityChecker):
    """Whether one state is free of collision."""

    def __init__(
        self, si: ob.SpaceInformation, states: ScaledStates, checker: PathChecker
    ) -> None:
        """Check states against the checker's world."""
        super().__init__(si)
        self._states = states
        self._checker = checker

    def isValid(self, state: ob.State) -> bool:
        """OMPL's question."""
        return self._checker.states_free(self._states.configuration(state)[None])


class WorldMotions(ob.MotionValidator):
    """Whether a whole edge is free of collision, in one call."""

    def __init__(
        self, si: ob.SpaceInformation, states: ScaledStates, checker: PathChecker
    ) -> None:
        """Check edges against the checker's world."""
        super().__init__(si)
        self._states = states
        self._checker = checker

    def checkMotion(self, start: ob.State, end: ob.State) -> bool:
        """OMPL's question; it takes the start as checked."""
        return self._checker.edge_free(
            self._states.configuration(start), self._states.configuration(end)
        )


def space_information(
    states: ScaledStates, joints: MovingJoints, ends: Array, checker: PathChecker
) -> ob.SpaceInformation:
    """The space within the joint limits with its checks, ready to plan in.

    The ends (n, nq) of the wanted path are always inside.
    """
    dimension = states.dimension
    space = ob.RealVectorStateSpace(dimension)
    space.setBounds(_bounds(joints, states, ends))
    si = ob.SpaceInformation(space)
    si.setStateValidityChecker(WorldValidity(si, states, checker))
    si.setMotionValidator(WorldMotions(si, states, checker))
    si.setup()
    return si


def _bounds(
    joints: MovingJoints, states: ScaledStates, ends: Array
) -> ob.RealVectorBounds:
    margin = LIMIT_MARGIN * (joints.upper - joints.lower)
    corners = np.tile(ends[0], (2, 1))
    corners[:, joints.indices] = joints.lower + margin, joints.upper - margin
    scaled = states.scaled(np.vstack([corners, ends]))
    inside = np.vstack([scaled[:1], scaled[2:]]).min(axis=0)
    beyond = scaled[1:].max(axis=0)
    bounds = ob.RealVectorBounds(states.dimension)
    for i, (low, high) in enumerate(zip(inside, beyond, strict=True)):
        bounds.setLow(i, float(low))
        bounds.setHigh(i, float(high))
    return bounds
