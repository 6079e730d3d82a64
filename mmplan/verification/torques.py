"""Whether the arm's torques keep their limits, by Pinocchio's inverse dynamics.

Looked at are both sides of every sample, where the acceleration jumps, and places
between; nothing is proven of what lies between these. The model is the robot's with
the object in the hand as one more body, of even density.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from mmplan.collision import Scenery, inertia_of
from mmplan.problem import Problem
from mmplan.replay import Stage
from mmplan.shapes import Array
from mmplan.verification.limits import curve_of
from mmplan.verification_report import Fault, Peak

# So many places of a piece are looked at, both ends among them.
PLACES = 9
# A limit may be passed by this share of it.
TOLERANCE = 1e-6


def torque_peaks(
    stages: Sequence[Stage], problem: Problem, scenery: Scenery
) -> tuple[tuple[Peak, ...], list[Fault]]:
    """The greatest share of a limit in each task, and where it is passed.

    Nothing where the problem's planner does not care for torques.
    """
    peaks: dict[int, Peak] = {}
    faults: list[Fault] = []
    for stage in stages if problem.planner.torque else ():
        times, torques = arm_torques(stage, problem, scenery)
        limits = problem.robot.model.upperEffortLimit[problem.robot.arm.indices]
        shares = np.abs(torques) / limits
        worst, joint = np.unravel_index(int(shares.argmax()), shares.shape)
        peak = Peak(
            rule="torque",
            limit=1.0,
            largest=float(shares[worst, joint]),
            proven=None,
            task=stage.task_index,
            segment=stage.segment.name,
            time=float(times[worst]),
        )
        if peak.largest > 1.0 + TOLERANCE:
            name = problem.robot.arm.names[joint]
            faults.append(
                Fault(
                    "torque",
                    f"{stage.place}: {name} needs {abs(torques[worst, joint]):.4g} at "
                    f"t = {peak.time:.3f} s, past its limit of {limits[joint]:g}",
                )
            )
        known = peaks.get(stage.task_index, peak)
        peaks[stage.task_index] = max(known, peak, key=lambda p: p.largest)
    return tuple(peaks.values()), faults


def arm_torques(
    stage: Stage, problem: Problem, scenery: Scenery
) -> tuple[Array, Array]:
    """Times (n,) in a segment and the arm's torques or forces (n, k) there, N m, N."""
    model = _loaded(stage, problem, scenery)
    data, curve = model.createData(), curve_of(stage)
    step = np.diff(curve.times)[:, None]
    inner = np.linspace(1e-9, 1.0 - 1e-9, PLACES)
    times = (curve.times[:-1, None] + step * inner).ravel()
    motion = (
        curve.positions(times),
        curve.velocities(times),
        curve.accelerations(times),
    )
    torques = [pin.rnea(model, data, *row) for row in zip(*motion, strict=True)]
    return times, np.array(torques)[:, problem.robot.arm.indices]


def _loaded(stage: Stage, problem: Problem, scenery: Scenery) -> pin.Model:
    """The robot's model with what it carries in a segment."""
    robot, model = problem.robot, problem.robot.model.copy()
    for name, T_tool_object in stage.attached.items():
        mass = problem.object(name).mass
        if mass is not None:
            inertia = inertia_of(scenery.objects[name], mass)
            placement = pin.SE3(robot.T_joint_tool @ T_tool_object)
            model.appendBodyToJoint(robot.tool_joint, inertia, placement)
    return model
