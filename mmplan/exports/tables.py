"""Plans as tables: CSV for spreadsheets, npz for numpy."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from mmplan.atomic_file import write_whole
from mmplan.exceptions import InputError
from mmplan.exports.motion import motion_of
from mmplan.plan import Plan
from mmplan.problem import Problem

_POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")


def write_csv(problem: Problem, plan: Plan, path: Path) -> None:
    """One row a sample: time, segment, joints, their velocities, objects' poses.

    Raises:
        InputError: The file cannot be written.
    """
    motion = motion_of(problem, plan)
    header = ["time", "segment", *motion.joints]
    header += [f"{name}_velocity" for name in motion.joints]
    header += [f"{name}_{axis}" for name in motion.objects for axis in _POSE]
    columns = [motion.positions, motion.velocities, *motion.objects.values()]
    numbers = np.concatenate(columns, axis=1).tolist()
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(header)
    rows = zip(motion.times.tolist(), motion.segments, numbers, strict=True)
    table.writerows([time, segment, *row] for time, segment, row in rows)
    write_whole(path, text.getvalue())


def write_npz(problem: Problem, plan: Plan, path: Path) -> None:
    """The arrays of the motion: see docs/exports.md for their names.

    Raises:
        InputError: The file cannot be written.
    """
    motion = motion_of(problem, plan)
    arrays = {f"object_{name}": poses for name, poses in motion.objects.items()}
    try:
        with path.open("wb") as file:
            np.savez(
                file,
                joints=np.array(motion.joints),
                times=motion.times,
                positions=motion.positions,
                velocities=motion.velocities,
                base=motion.base,
                segments=np.array([mark.name for mark in motion.marks]),
                segment_starts=np.array([mark.start for mark in motion.marks]),
                segment_ends=np.array([mark.end for mark in motion.marks]),
                **arrays,  # type: ignore[arg-type]  # the stub's allow_pickle
            )
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
