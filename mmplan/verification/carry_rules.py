"""Whether objects are carried as their tasks want: upright, and slowly.

Both are proven on the cubic Hermite curves that are delivered, by bisection of time. In
the middle of a stretch of time of half-length h the tilt of the object is θ, and until
either end of the stretch it turns by no more than h Σ_j max |q̇_j| over the revolute
joints that move the tool. The tool frame's origin has the speed |v|, which changes by
no more than h max |a|, and with L_j the lever of joint j

    |a| ≤ Σ_j L_j (max |q̈_j| + max |q̇_j| (2 Σ_k max |q̇_k| + max |q̇_j|))

over the revolute joints k between the world and j (the last term for a revolute j
alone): each of them turns joint j's share of the velocity, L_j |q̇_j|, and has a share
of its own that j turns. Stretches are split
until their bounds are within the limit, and near the largest value found as well. (That
no point of the object is in a forbidden region, is proven with all other collisions.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.carry import Upright
from mmplan.hermite import HermiteCurve
from mmplan.kinematics import ForwardKinematics, FrameJacobians, motion_axis
from mmplan.problem import Problem
from mmplan.replay import Stage
from mmplan.robot import Robot
from mmplan.shapes import Array
from mmplan.verification.bodies import point_levers
from mmplan.verification.limits import curve_of
from mmplan.verification_report import Fault, Peak

# The angle may be passed by this (rad), and a region be left by this (m); the limit of
# speed may be passed by this (m/s).
TILT_TOLERANCE = 1e-5
REGION_TOLERANCE = 1e-5
SPEED_TOLERANCE = 1e-5
# No value is greater than the largest one found by more than this, rad or m/s.
SHARPNESS = 2e-3


class Bounds(NamedTuple):
    """A quantity over n stretches of time; -inf where it does not count."""

    value: Array  # (n,), in the middle of each
    most: Array  # (n,), at most, anywhere in each


# Answers for stretches of time from `start` (n,) to `end` (n,).
BoundsOf = Callable[[Array, Array], Bounds]


@dataclass(frozen=True, eq=False)
class Rule:
    """A quantity that must not be above a limit."""

    kind: str  # of the fault
    bounds: BoundsOf
    limit: float
    tolerance: float


def carrying_peaks(
    stages: Sequence[Stage], problem: Problem, travel: Array
) -> tuple[tuple[Peak, ...], list[Fault]]:
    """The largest tilt and speed of each task that limits them, and what is wrong.

    `travel` (nq,) is the largest |q| of each joint in the whole motion.
    """
    peaks: dict[tuple[int, str], Peak] = {}
    faults: list[Fault] = []
    for stage in stages:
        for rule in _rules(stage, problem, travel):
            peak = _peak(rule, stage)
            if peak.largest > rule.limit + rule.tolerance / 2.0:
                faults.append(_fault(rule, stage, peak))
            key = (stage.task_index, rule.kind)
            peaks[key] = _larger(peaks.get(key, peak), peak)
    return tuple(peaks.values()), faults


def _rules(stage: Stage, problem: Problem, travel: Array) -> list[Rule]:
    """What a segment has to keep to; nothing where it carries nothing."""
    carry = problem.tasks[stage.task_index].carry
    T_tool_object = stage.attached.get(stage.task.object)
    if T_tool_object is None:
        return []
    motion, rules = ToolMotion(problem.robot, curve_of(stage), travel), []
    if carry.upright is not None:
        bounds = motion.tilt(carry.upright, T_tool_object)
        rules.append(Rule("tilt", bounds, carry.upright.angle, TILT_TOLERANCE))
    if carry.max_speed is not None:
        speed = motion.speed()
        rules.append(Rule("tool_speed", speed, carry.max_speed, SPEED_TOLERANCE))
    return rules


class ToolMotion:
    """The motion of the tool, and of what it holds, along one curve."""

    def __init__(self, robot: Robot, curve: HermiteCurve, travel: Array) -> None:
        """Prepare for a curve on which no |q| exceeds `travel` (nq,)."""
        model = robot.model
        self._robot = robot
        self._curve = curve
        self._travel = travel
        self._kinematics = ForwardKinematics(model)
        chain = list(model.supports[robot.tool_joint])[1:]  # from the world to the tool
        self._chain = np.array([model.joints[j].idx_q for j in chain], np.int64)
        angular = [motion_axis(model, j)[3:].any() for j in chain]
        self._revolute: npt.NDArray[np.bool_] = np.array(angular, np.bool_)

    def tilt(self, upright: Upright, T_tool_object: Array) -> BoundsOf:
        """How far an object's axis tilts where it must not."""
        joint = self._robot.tool_joint
        T_joint_object = self._robot.T_joint_tool @ T_tool_object
        levers = self._levers(T_joint_object[:3, 3])

        def bounds(start: Array, end: Array) -> Bounds:
            ways = self._fastest(start, end) * ((end - start) / 2.0)[:, None]
            q = self._curve.positions((start + end) / 2.0)
            T_world_object = self._kinematics(q)[:, joint] @ T_joint_object
            depth = upright.depths(T_world_object[:, :3, 3])
            tilt = upright.tilts(T_world_object[:, :3, :3])
            exempt = depth - ways @ levers >= -REGION_TOLERANCE
            return Bounds(
                np.where(depth < -REGION_TOLERANCE / 2.0, tilt, -np.inf),
                np.where(exempt, -np.inf, tilt + ways @ self._revolute),
            )

        return bounds

    def speed(self) -> BoundsOf:
        """The speed of the tool frame's origin."""
        robot, curve = self._robot, self._curve
        jacobians = FrameJacobians(robot.model, robot.tool_frame, self._chain)
        levers = self._levers(robot.T_joint_tool[:3, 3])
        hardest = curve.acceleration_extremes().magnitude[:, self._chain]

        def bounds(start: Array, end: Array) -> Bounds:
            middle = (start + end) / 2.0
            J = jacobians(self._kinematics(curve.positions(middle)))[:, :3]
            q_dot = curve.velocities(middle)[:, self._chain]
            speed = np.linalg.norm(np.einsum("nij,nj->ni", J, q_dot), axis=1)
            fastest = self._fastest(start, end)
            turning = fastest * self._revolute
            before = np.cumsum(turning, axis=1) - turning
            hard = hardest[curve.piece_of(middle)] + fastest * (2.0 * before + turning)
            return Bounds(speed, speed + (end - start) / 2.0 * (hard @ levers))

        return bounds

    def _fastest(self, start: Array, end: Array) -> Array:
        """The greatest speeds (n, k) of the joints that move the tool."""
        return self._curve.velocity_extremes(start, end).magnitude[:, self._chain]

    def _levers(self, point: Array) -> Array:
        """How far those joints move a point (3,) of the tool's joint, (k,)."""
        model, joint = self._robot.model, self._robot.tool_joint
        levers = point_levers(model, joint, point[None, None], self._travel)
        reached: Array = levers[0, self._chain]
        return reached


def _peak(rule: Rule, stage: Stage) -> Peak:
    """The largest value in a segment; the search ends where that is too large."""
    times = stage.segment.times
    start, end = times[:-1], times[1:]
    largest, when, proven = 0.0, 0.0, 0.0
    while len(start) and largest <= rule.limit + rule.tolerance / 2.0:
        value, most = rule.bounds(start, end)
        worst = int(value.argmax())
        if value[worst] > largest:
            largest = float(value[worst])
            when = float(start[worst] + end[worst]) / 2.0
        allowed = min(rule.limit + rule.tolerance, largest + SHARPNESS)
        split = most > allowed
        proven = max(proven, float(most[~split].max(initial=0.0)))
        start, middle, end = start[split], (start + end)[split] / 2.0, end[split]
        start, end = np.append(start, middle), np.append(middle, end)
    kept = largest <= rule.limit + rule.tolerance / 2.0
    return Peak(
        rule=rule.kind,
        limit=rule.limit,
        largest=largest,
        proven=proven if kept else None,
        task=stage.task_index,
        segment=stage.segment.name,
        time=when,
    )


def _larger(one: Peak, other: Peak) -> Peak:
    """The larger of two peaks of the same rule, and what is proven of both."""
    both = (one.proven, other.proven)
    proven = None if None in both else max(p for p in both if p is not None)
    return replace(max(one, other, key=lambda p: p.largest), proven=proven)


def _fault(rule: Rule, stage: Stage, peak: Peak) -> Fault:
    when = f"at t = {peak.time:.3f} s; at most {rule.limit:g} is allowed"
    if rule.kind == "tilt":
        what = f"{stage.task.object} tilts by {peak.largest:.4g} rad"
    else:
        what = f"the tool moves at {peak.largest:.4g} m/s while it carries"
    return Fault(rule.kind, f"{stage.place}: {what} {when}")
