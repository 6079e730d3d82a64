"""OMPL's state space over the moving joints, and its checks against the world.

States are joint values times the joints' longest lever arms, so that OMPL's distances
are lengths in the workspace (m); joints that wrap have circles of that size.

The objects that Python hands to OMPL must not keep the `SpaceInformation`: OMPL keeps
them, and such a cycle is never freed.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from ompl import base as ob

from mmplan.collision import PlannerSpace
from mmplan.planning.checking import PathChecker
from mmplan.planning.joints import MovingJoints
from mmplan.planning.metric import Metric
from mmplan.planning.turns import Turns
from mmplan.planning.world import QuickAnswers
from mmplan.shapes import Array

# Sampled joint values keep this share of their range away from the joint limits, so
# that rounding and the timing of a path cannot carry it over a limit.
LIMIT_MARGIN = 1e-3


class ScaledStates:
    """Turns OMPL's states into configurations and back.

    States are points of a real space, one coordinate a joint. Where joints wrap, a
    state is compound: a point for the joints that do not, then a place on the circle
    for each joint that does. OMPL adds up the distances of the parts.
    """

    def __init__(self, q_still: Array, joints: MovingJoints, metric: Metric) -> None:
        """Take the still joints' values from `q_still` (nq,)."""
        self._q_still = q_still
        self._joints = joints
        self.metric = metric
        self._straight = joints.indices[~joints.wraps]
        self._round = joints.indices[joints.wraps]
        self._real = not len(self._round)
        self._size = len(self._straight)
        self._places = _as_slice(np.concatenate([self._straight, self._round]))
        self._scales = np.ones_like(q_still)
        self._scales[self._straight] = metric.weights[self._straight]

    def coordinates(self, state: ob.State) -> list[float]:
        """The coordinates of a state, those of joints that wrap last."""
        k = self._size
        if self._real:
            values: list[float] = state[0:k]
            return values
        first = int(k > 0)
        values = state[0][0:k] if k else []
        return values + [state[first + i].value for i in range(len(self._round))]

    def configuration(self, state: ob.State) -> Array:
        """The configuration (nq,) of a state; joints that wrap are in [-π, π]."""
        q = self._q_still.copy()
        q[self._places] = self.coordinates(state)
        q /= self._scales
        return self._joints.with_followers(q)

    def planner_space(self, checker: PathChecker) -> PlannerSpace:
        """What coordinates mean where steps are to be as a checker's."""
        places = np.concatenate([self._straight, self._round])
        wraps = np.zeros(len(self._q_still))
        wraps[self._round] = 1.0
        return PlannerSpace(
            places=places,
            q_still=self._q_still,
            scales=self._scales,
            wraps=wraps,
            levers=checker.sweep.levers,
            followers=self._joints.followers,
            resolution=checker.resolution,
        )

    def write(self, q: Array, state: ob.State) -> None:
        """Set a state to a configuration (nq,)."""
        k = len(self._straight)
        part = state[0] if k and len(self._round) else state
        for i, value in enumerate((q * self._scales)[self._straight]):
            part[i] = float(value)
        for i, angle in enumerate(q[self._round]):
            state[int(k > 0) + i].value = float(
                np.mod(angle + np.pi, 2 * np.pi) - np.pi
            )

    def space(self, ends: Array) -> ob.StateSpace:
        """The space within the joint limits; ends (n, nq) of paths are inside too."""
        k = len(self._straight)
        real = ob.RealVectorStateSpace(k)
        real.setBounds(self._bounds(ends))
        if not len(self._round):
            return real
        compound = ob.CompoundStateSpace()
        if k:
            compound.addSubspace(real, 1.0)
        for weight in self.metric.weights[self._round]:
            compound.addSubspace(ob.SO2StateSpace(), float(weight))
        return compound

    def _bounds(self, ends: Array) -> ob.RealVectorBounds:
        straight = ~self._joints.wraps
        lower, upper = self._joints.lower[straight], self._joints.upper[straight]
        margin = LIMIT_MARGIN * (upper - lower)
        scales = self._scales[self._straight]
        scaled = ends[:, self._straight] * scales
        low = np.vstack([(lower + margin) * scales, scaled]).min(axis=0)
        high = np.vstack([(upper - margin) * scales, scaled]).max(axis=0)
        bounds = ob.RealVectorBounds(len(self._straight))
        for i, (least, most) in enumerate(zip(low, high, strict=True)):
            bounds.setLow(i, float(least))
            bounds.setHigh(i, float(most))
        return bounds


def _as_slice(places: npt.NDArray[np.int64]) -> slice | npt.NDArray[np.int64]:
    """A slice if places follow each other, which is quicker to write to."""
    if len(places) and np.array_equal(places, np.arange(places[0], places[-1] + 1)):
        return slice(int(places[0]), int(places[-1]) + 1)
    return places


class Answers:
    """Answers to OMPL's questions from a world.

    From compiled code, where there is such, without that OMPL's states are put in
    configurations.
    """

    def __init__(self, states: ScaledStates, checker: PathChecker) -> None:
        """Answer from the checker's world."""
        self.states = states
        self.checker = checker
        self._space = states.planner_space(checker)
        self._quick: QuickAnswers | None = None

    def state_free(self, state: ob.State) -> bool:
        """Whether one state is free of collision."""
        states, checker = self.states, self.checker
        quick = self._quick = self._quick or checker.in_space(self._space)
        if quick is None:
            return checker.states_free(states.configuration(state)[None])
        checker.states += 1
        return quick.state_free(states.coordinates(state))

    def edge_free(self, start: ob.State, end: ob.State) -> bool:
        """Whether a whole edge is free of collision, its start taken as checked."""
        states, checker = self.states, self.checker
        quick = self._quick = self._quick or checker.in_space(self._space)
        if quick is None or checker.continuous:
            q_from, q_to = states.configuration(start), states.configuration(end)
            if states.metric.any_wraps:
                q_to = q_to + states.metric.turns(q_to, q_from)
            return checker.edge_free(q_from, q_to)
        free = quick.edge_free(states.coordinates(start) + states.coordinates(end))
        checker.edges += 1
        checker.states += quick.steps
        return free


class WorldValidity(ob.StateValidityChecker):
    """Whether one state is free of collision."""

    def __init__(self, si: ob.SpaceInformation, answers: Answers) -> None:
        """Pass OMPL's questions on."""
        super().__init__(si)
        self.answers = answers

    def isValid(self, state: ob.State) -> bool:
        """OMPL's question."""
        return self.answers.state_free(state)


class WorldMotions(ob.MotionValidator):
    """Whether a whole edge is free of collision, in one call."""

    def __init__(
        self, si: ob.SpaceInformation, answers: Answers, turns: Turns | None
    ) -> None:
        """Pass OMPL's questions on, but those of turns that pass."""
        super().__init__(si)
        self.answers = answers
        self._turns = turns

    def checkMotion(self, start: ob.State, end: ob.State) -> bool:
        """OMPL's question; it takes the start as checked."""
        turns = self._turns
        if turns is None:
            return self.answers.edge_free(start, end)
        if turns.passes:
            return False
        free = self.answers.edge_free(start, end)
        turns.note(free=free)
        return free


def space_information(
    states: ScaledStates,
    ends: Array,
    checker: PathChecker,
    turns: Turns | None = None,
) -> ob.SpaceInformation:
    """The space within the joint limits with its checks, ready to plan in.

    The ends (n, nq) of the wanted path are always inside. `turns` are those of
    RRTConnect.
    """
    si = ob.SpaceInformation(states.space(ends))
    answers = Answers(states, checker)
    si.setStateValidityChecker(WorldValidity(si, answers))
    si.setMotionValidator(WorldMotions(si, answers, turns))
    si.setup()
    return si
