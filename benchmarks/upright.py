"""Two ways of planning with an object upright, on the same transfers.

    python benchmarks/upright.py [--scenes wineglass_upright plate_flat] [--seeds 3]

One is mmplan's own: two trees to which only projected configurations are added, with
half of the samples in the regions where the object may turn. The other is OMPL's
RRTConnect on its `ProjectedStateSpace`, the rule being a constraint of one equation:
the excess of the tilt, 0 where the rule holds, from Python, and its Jacobian by
differences. CPU seconds until a first path; OMPL has `--limit` of these.
"""

from __future__ import annotations

import argparse
import time
from unittest.mock import patch

import numpy as np
import pinocchio as pin
from ompl import base as ob
from ompl import geometric as og

import mmplan
from mmplan.planning import PathChecker
from mmplan.planning.joints import MovingJoints
from mmplan.planning.metric import Metric
from mmplan.planning.path_finder import PathFinder
from mmplan.planning.search import Search, own_randomness
from mmplan.planning.upright import UprightRule, UprightWorld
from mmplan.shapes import Array

DELTA = 0.05  # m of weighted length between two projected states
RANGE = 1.5  # m
STEP = 1e-5  # m, of the differences


class Tilt(ob.Constraint):
    """The excess of the tilt, as a constraint of OMPL's scaled joints."""

    def __init__(
        self, rule: UprightRule, q: Array, joints: MovingJoints, scales: Array
    ) -> None:
        """Take the rule, and the joints that do not move from q (nq,)."""
        super().__init__(len(scales), 1, 1e-3)
        self._rule, self._q = rule, q.copy()
        self._index, self._scales = joints.indices, scales
        self._model = rule.robot.model
        self._data = self._model.createData()

    def configuration(self, x: Array) -> Array:
        """The configuration (nq,) of a state (k,), until the next call."""
        self._q[self._index] = x / self._scales
        return self._q

    def excess(self, x: Array) -> float:
        """By how much (rad) the tilt is too large, at least 0."""
        rule = self._rule
        pin.forwardKinematics(self._model, self._data, self.configuration(x))
        T_world_joint = self._data.oMi[rule.robot.tool_joint].homogeneous
        T = (T_world_joint @ rule.T_joint_object)[None]
        if rule.upright.depths(T[:, :3, 3])[0] >= 0.0:
            return 0.0
        return max(0.0, float(rule.upright.tilts(T[:, :3, :3])[0]) - rule.upright.angle)

    def function(self, x: Array, out: Array) -> None:
        """OMPL's question."""
        out[0] = self.excess(x)

    def jacobian(self, x: Array, out: Array) -> None:
        """OMPL's other question."""
        for i, step in enumerate(STEP * np.eye(len(x))):
            out[0, i] = (self.excess(x + step) - self.excess(x - step)) / (2.0 * STEP)


class Free(ob.StateValidityChecker):
    """Whether a state is free of collision and upright."""

    def __init__(
        self, si: ob.SpaceInformation, tilt: Tilt, checker: PathChecker, size: int
    ) -> None:
        """Check states of so many joints in the checker's world."""
        super().__init__(si)
        self._tilt, self._checker, self._size = tilt, checker, size

    def isValid(self, state: ob.State) -> bool:
        """OMPL's question."""
        x = np.array([state[i] for i in range(self._size)])
        return self._checker.states_free(self._tilt.configuration(x)[None])


def by_projected_space(
    checker: PathChecker,
    rule: UprightRule,
    ends: Array,
    joints: MovingJoints,
    limit: float,
) -> tuple[float, bool]:
    """CPU seconds, and whether OMPL found a path from the first end to another."""
    scales = Metric.of_joints(joints, checker.sweep.weights).weights[joints.indices]
    real = ob.RealVectorStateSpace(len(scales))
    bounds = ob.RealVectorBounds(len(scales))
    for i, scale in enumerate(scales):
        bounds.setLow(i, float(joints.lower[i] * scale))
        bounds.setHigh(i, float(joints.upper[i] * scale))
    real.setBounds(bounds)
    tilt = Tilt(rule, ends[0], joints, scales)
    space = ob.ProjectedStateSpace(real, tilt)
    si = ob.ConstrainedSpaceInformation(space)
    space.setDelta(DELTA)
    si.setStateValidityChecker(Free(si, tilt, checker, len(scales)))
    si.setup()
    problem, goals = ob.ProblemDefinition(si), ob.GoalStates(si)
    for i, x in enumerate(ends[:, joints.indices] * scales):
        state = si.allocState()
        state.copy(x.tolist())
        (problem.addStartState if i == 0 else goals.addState)(state)
    problem.setGoal(goals)
    planner = og.RRTConnect(si)
    planner.setRange(RANGE)
    planner.setProblemDefinition(problem)
    planner.setup()
    begin = time.process_time()
    over = ob.PlannerTerminationCondition(
        lambda: time.process_time() > begin + limit or problem.hasExactSolution()
    )
    planner.solve(over)
    return time.process_time() - begin, problem.hasExactSolution()


def main() -> None:
    """Print a line for each search of a scene's transfer."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    scenes = ["wineglass_upright", "plate_flat"]
    parser.add_argument("--scenes", nargs="+", default=scenes)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--limit", type=float, default=30.0, metavar="S")
    options = parser.parse_args()
    print("| scene | seed | mmplan CPU s | found | ProjectedStateSpace CPU s | found |")
    print("|---|---|---|---|---|---|")
    search, row = PathFinder._search, ""

    def both(
        finder: PathFinder, checker: PathChecker, q_start: Array, q_goals: Array
    ) -> Search:
        begin = time.process_time()
        found = search(finder, checker, q_start, q_goals)
        own = time.process_time() - begin
        if isinstance(checker.world, UprightWorld):
            ends = np.vstack([q_start, q_goals])
            with own_randomness(finder.seed):
                other, there = by_projected_space(
                    checker, checker.world.rule, ends, finder.joints, options.limit
                )
            here = found.waypoints is not None
            print(f"{row} {own:.2f} | {here} | {other:.2f} | {there} |", flush=True)
        return found

    with patch.object(PathFinder, "_search", both):
        for scene in options.scenes:
            problem = mmplan.load_problem(scene)
            for seed in range(options.seeds):
                row = f"| {scene} | {seed} |"
                mmplan.solve(problem, seed=seed)


if __name__ == "__main__":
    main()
