"""The verification of a plan: everything that it promises, from the problem alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from mmplan.carry import Region
from mmplan.collision import CollisionWorld, Scenery
from mmplan.exceptions import VerificationError
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.replay import Stage, replay
from mmplan.shapes import Array
from mmplan.verification.base import base_faults
from mmplan.verification.bodies import Bodies
from mmplan.verification.carry_rules import carrying_peaks
from mmplan.verification.carrying import carrying_faults, grasp_faults
from mmplan.verification.ledger import Finding, Ledger
from mmplan.verification.limits import curve_of, motion_faults
from mmplan.verification.proof import SegmentProof
from mmplan.verification.structure import structure_faults
from mmplan.verification.torques import torque_peaks
from mmplan.verification.touching import TouchRule
from mmplan.verification_report import Clearance, Fault, VerificationReport


def verify(plan: Plan, problem: Problem) -> VerificationReport:
    """Prove that a plan holds what it promises.

    Raises:
        VerificationError: if it does not, or if it could not be proven.
    """
    report = examine(plan, problem)
    if not report.ok:
        raise VerificationError(tuple(fault.message for fault in report.faults))
    return report


def examine(plan: Plan, problem: Problem) -> VerificationReport:
    """Try to prove that a plan holds what it promises; faults are in the report.

    Nothing that the planner computed is trusted. The world is built anew from the
    problem and the plan is replayed in it: joint limits, velocities and accelerations
    are those of the curve delivered, objects go where the tool takes them, and what
    must stay apart is proven to stay apart at all times (`mmplan.verification.proof`),
    with the exceptions of `mmplan.verification.touching`.

    A plan that cannot be replayed, because it is one for another scene or has no
    numbers where numbers belong, is not examined any further.
    """
    faults = list(structure_faults(plan, problem))
    if faults:
        return VerificationReport(tuple(faults), None, 0.0, 0, 0)
    stages = list(replay(problem, plan.tasks))
    travel = _travel(stages)
    worlds = _Worlds(problem, travel)
    ledger = Ledger()
    for number, stage in enumerate(stages):
        bodies = worlds.bodies_of(stage)
        rule = TouchRule.of_stage(stage, bodies)
        SegmentProof(number, curve_of(stage), bodies, rule, ledger).run()
        if _begins_to_carry(stages, number):
            faults.extend(grasp_faults(stage, bodies))
    peaks, rule_faults = carrying_peaks(stages, problem, travel)
    hardest, torque_faults = torque_peaks(stages, problem, worlds.scenery)
    faults = [
        *_proof_faults(ledger, stages),
        *motion_faults(stages, problem),
        *base_faults(stages, problem),
        *carrying_faults(stages, problem),
        *rule_faults,
        *torque_faults,
        *faults,
    ]
    return VerificationReport(
        faults=tuple(faults),
        clearance=_clearance(ledger, stages),
        proven=_proven(ledger),
        queries=ledger.queries,
        intervals=ledger.intervals,
        peaks=(*peaks, *hardest),
    )


# Regions that are forbidden, and the poses of all objects, standing and carried.
_State: TypeAlias = tuple[tuple[Region, ...], tuple[tuple[str, bytes], ...]]


class _Worlds:
    """The bodies of each state of the world that a plan goes through, made once."""

    def __init__(self, problem: Problem, travel: Array) -> None:
        self._travel = travel
        self._tasks = problem.tasks
        self._start = CollisionWorld.of_problem(problem)
        self._made: dict[_State, Bodies] = {}

    @property
    def scenery(self) -> Scenery:
        """The solids of everything but the robot."""
        return self._start.scenery

    def bodies_of(self, stage: Stage) -> Bodies:
        """The bodies of the world during a segment, with no touch permitted."""
        poses = (*stage.standing.items(), *stage.attached.items())
        forbidden = self._tasks[stage.task_index].carry.forbidden
        key = (forbidden, tuple((name, T.tobytes()) for name, T in poses))
        if key not in self._made:
            world = self._start.forbidding(forbidden)
            for name, T_world_object in stage.standing.items():
                world = world.place(name, T_world_object)
            for name, T_tool_object in stage.attached.items():
                world = world.attach(name, T_tool_object).forbid_touch(name)
            self._made[key] = Bodies(world, self._travel)
        return self._made[key]


def _travel(stages: Sequence[Stage]) -> Array:
    """The largest |q| of every joint in the whole motion, (nq,)."""
    extremes = [curve_of(stage).position_extremes() for stage in stages]
    travel: Array = np.max([e.magnitude.max(axis=0) for e in extremes], axis=0)
    return travel


def _begins_to_carry(stages: Sequence[Stage], number: int) -> bool:
    """Whether a segment is the first that carries the object of its task."""
    carrying = bool(stages[number].attached)
    return carrying and (number == 0 or not stages[number - 1].attached)


def _proof_faults(ledger: Ledger, stages: Sequence[Stage]) -> list[Fault]:
    """What the proof could not show, the deepest overlap first."""
    overlaps = sorted(ledger.overlaps.values(), key=lambda f: f.distance)
    undecided = sorted(ledger.undecided.values(), key=lambda f: f.distance)
    return [
        *(_overlap_fault(f, stages[f.stage].place) for f in overlaps),
        *(_undecided_fault(f, stages[f.stage].place) for f in undecided),
    ]


def _overlap_fault(finding: Finding, place: str) -> Fault:
    depth, allowed = -finding.distance * 1e3, finding.allowed * 1e3
    message = (
        f"{place}: {finding.first} and {finding.second} overlap by {depth:.3g} mm or "
        f"more, first seen at t = {finding.time:.3f} s"
    )
    if finding.allowed > 0.0:
        return Fault("touch", f"{message}; {allowed:g} mm is let pass")
    return Fault("region" if finding.region else "collision", message)


def _undecided_fault(finding: Finding, place: str) -> Fault:
    return Fault(
        "unproven",
        f"{place}: {finding.first} and {finding.second} could not be proven free at "
        f"t = {finding.time:.3f} s; their clearance is {finding.distance * 1e3:.3g} mm",
    )


def _clearance(ledger: Ledger, stages: Sequence[Stage]) -> Clearance | None:
    nearest = ledger.nearest
    if nearest is None:
        return None
    stage = stages[nearest.stage]
    return Clearance(
        distance=nearest.distance,
        task=stage.task_index,
        segment=stage.segment.name,
        time=nearest.time,
        first=nearest.first,
        second=nearest.second,
    )


def _proven(ledger: Ledger) -> float:
    if ledger.overlaps or ledger.undecided or np.isinf(ledger.proven):
        return 0.0
    return float(ledger.proven)
