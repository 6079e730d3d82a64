"""The plan: what was chosen for every task, and the timed motion of all joints."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from mmplan.atomic_file import write_whole
from mmplan.plan_file import (
    FORMAT_VERSION,
    PlanFile,
    ReportFile,
    SegmentFile,
    TaskEndFile,
    TaskFile,
    parse_plan,
    plan_text,
    read_plan_file,
)
from mmplan.shapes import Array, read_only
from mmplan.verification_report import (
    Clearance,
    Fault,
    Peak,
    VerificationReport,
)


@dataclass(frozen=True, eq=False)
class Segment:
    """One motion of all joints, from rest to rest.

    Between samples the motion *is* the cubic Hermite curve through positions and
    velocities. Objects that are not in `attached` stand still.
    """

    name: str
    times: Array  # (n,), s, strictly increasing from 0
    positions: Array  # (n, nq), rad or m
    velocities: Array  # (n, nq), rad/s or m/s
    attached: dict[str, Array]  # object -> T_tool_object (4, 4)
    objects: dict[str, Array] = field(default_factory=dict)
    """Object -> T_world_object (4, 4) at the segment's start; `Plan` has them all."""

    @property
    def duration(self) -> float:
        """The segment's length in time, s."""
        return float(self.times[-1])


@dataclass(frozen=True, eq=False)
class TaskEnd:
    """Where the base stands at one end of a task, and the terms of the score there."""

    base: Array  # (base joints,)
    scores: dict[str, float]


@dataclass(frozen=True, eq=False)
class TaskPlan:
    """How one task is done."""

    object: str
    grasp: str  # its name in the scene
    genes: Array  # (genes,)
    T_object_tool: Array  # (4, 4)
    hand_open: Array  # (hand joints,)
    hand_closed: Array  # (hand joints,)
    start: TaskEnd
    goal: TaskEnd
    segments: tuple[Segment, ...]


@dataclass(frozen=True, eq=False)
class Plan:
    """A motion that does all tasks of a problem, one after the other.

    `fingerprint` is that of the problem; `path` is the scene file, None if there is
    none. `joints` says the order of the joints in every row of every segment.
    """

    scene: str
    path: Path | None
    fingerprint: str
    robot: str
    joints: tuple[str, ...]
    tool: str
    seed: int
    tasks: tuple[TaskPlan, ...]
    versions: dict[str, str]
    created: datetime = field(default_factory=lambda: _now())
    verification: VerificationReport | None = None

    @property
    def duration(self) -> float:
        """The length of the whole motion in time, s."""
        return float(sum(s.duration for task in self.tasks for s in task.segments))

    def save(self, path: Path | str) -> None:
        """Write the plan file, whole or not at all.

        Raises:
            InputError: if the file cannot be written, or could not be read again.
        """
        path = Path(path)
        text = plan_text(_to_json(self, path.absolute().parent)) + "\n"
        parse_plan(text, f"{path} (not written)")
        write_whole(path, text)

    @classmethod
    def load(cls, path: Path | str) -> Plan:
        """Read a plan file.

        Raises:
            InputError: naming the file and the key path of every fault.
        """
        path = Path(path)
        return _from_file(read_plan_file(path), path.absolute().parent)


def _now() -> datetime:
    return datetime.now(timezone.utc).replace(microsecond=0)


def _to_json(plan: Plan, folder: Path) -> dict[str, Any]:
    report = plan.verification
    return {
        "mmplan_plan": FORMAT_VERSION,
        "created": plan.created.isoformat(),
        "versions": plan.versions,
        "seed": plan.seed,
        "scene": {
            "name": plan.scene,
            "path": None if plan.path is None else _relative(plan.path, folder),
            "fingerprint": plan.fingerprint,
        },
        "robot": {"name": plan.robot, "joints": list(plan.joints), "tool": plan.tool},
        "duration": plan.duration,
        "tasks": [_task_json(task) for task in plan.tasks],
        "verification": None if report is None else report.to_json(),
    }


def _task_json(task: TaskPlan) -> dict[str, Any]:
    return {
        "object": task.object,
        "grasp": {
            "name": task.grasp,
            "genes": task.genes.tolist(),
            "T_object_tool": task.T_object_tool.tolist(),
            "hand_open": task.hand_open.tolist(),
            "hand_closed": task.hand_closed.tolist(),
        },
        "start": _end_json(task.start),
        "goal": _end_json(task.goal),
        "segments": [_segment_json(segment) for segment in task.segments],
    }


def _end_json(end: TaskEnd) -> dict[str, Any]:
    return {"base": end.base.tolist(), "scores": end.scores}


def _segment_json(segment: Segment) -> dict[str, Any]:
    return {
        "name": segment.name,
        "times": segment.times.tolist(),
        "positions": segment.positions.tolist(),
        "velocities": segment.velocities.tolist(),
        "attached": {name: T.tolist() for name, T in segment.attached.items()},
        "objects": {name: T.tolist() for name, T in segment.objects.items()},
    }


def _relative(path: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(path.absolute(), folder)).as_posix()
    except ValueError:  # another drive
        return path.absolute().as_posix()


def _from_file(file: PlanFile, folder: Path) -> Plan:
    path = file.scene.path
    return Plan(
        scene=file.scene.name,
        path=None if path is None else Path(os.path.normpath(folder / path)),
        fingerprint=file.scene.fingerprint,
        robot=file.robot.name,
        joints=tuple(file.robot.joints),
        tool=file.robot.tool,
        seed=file.seed,
        tasks=tuple(_task(task) for task in file.tasks),
        versions=file.versions,
        created=file.created,
        verification=None if file.verification is None else _report(file.verification),
    )


def _task(task: TaskFile) -> TaskPlan:
    return TaskPlan(
        object=task.object,
        grasp=task.grasp.name,
        genes=read_only(task.grasp.genes),
        T_object_tool=read_only(task.grasp.T_object_tool),
        hand_open=read_only(task.grasp.hand_open),
        hand_closed=read_only(task.grasp.hand_closed),
        start=_end(task.start),
        goal=_end(task.goal),
        segments=tuple(_segment(segment) for segment in task.segments),
    )


def _end(end: TaskEndFile) -> TaskEnd:
    return TaskEnd(read_only(end.base), end.scores)


def _segment(segment: SegmentFile) -> Segment:
    return Segment(
        name=segment.name,
        times=read_only(segment.times),
        positions=read_only(segment.positions),
        velocities=read_only(segment.velocities),
        attached={name: read_only(T) for name, T in segment.attached.items()},
        objects={name: read_only(T) for name, T in segment.objects.items()},
    )


def _report(report: ReportFile) -> VerificationReport:
    clearance = report.clearance
    return VerificationReport(
        faults=tuple(Fault(f.kind, f.message) for f in report.faults),
        clearance=None if clearance is None else Clearance(**clearance.model_dump()),
        proven=report.proven,
        queries=report.queries,
        intervals=report.intervals,
        peaks=tuple(Peak(**peak.model_dump()) for peak in report.peaks),
    )
