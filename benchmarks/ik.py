"""Inverse kinematics of every robot that is shipped, and of arms of the wheel.

Random configurations within limits give poses that can be reached. Shown are the share
of poses solved within limits; the mean number of solutions, and of those within limits;
the largest difference between a pose asked for and one reached (m and rad, judged by
Pinocchio); and the time of a pose (µs of CPU, in batches).

    python benchmarks/ik.py [--poses N] [--batch N] [--markdown] [robots ...]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from _wheel_arms import ARMS, Arm, load_arm

from mmplan.assets import ROBOT_FILE, example_robots, robot_names, robots_folder
from mmplan.ik import InverseKinematics, Solutions
from mmplan.ik.solvers import SOLVERS
from mmplan.robot_build import build_robot
from mmplan.robot_file import load_robot_description
from mmplan.shapes import Array

HEADER = ("robot", "joints", "solved", "branches", "within", "error", "µs", "how")
ROUNDS = 3


class Case(NamedTuple):
    """A robot's arm and its solver."""

    arm: Arm
    solver: InverseKinematics


class Measured(NamedTuple):
    """A row of the table."""

    robot: str
    joints: int
    solved: float
    branches: float
    within: float
    error: float
    microseconds: float
    how: str


def measure(name: str, case: Case, poses: int, batch: int) -> Measured:
    """The figures of one robot."""
    T = case.arm.tool_poses(case.arm.draw(poses, seed=0))
    batches = [T[i : i + batch] for i in range(0, poses, batch)]
    case.solver.solve(T[:2])
    seconds, solutions = min(
        (_timed(case.solver, batches) for _ in range(ROUNDS)), key=lambda run: run[0]
    )
    errors = [_error(case.arm, s, b) for s, b in zip(solutions, batches, strict=True)]
    return Measured(
        robot=name,
        joints=len(case.arm.joints),
        solved=_mean(solutions, lambda s: s.within.any(axis=1)),
        branches=_mean(solutions, lambda s: s.exists.sum(axis=1)),
        within=_mean(solutions, lambda s: s.within.sum(axis=1)),
        error=max(errors),
        microseconds=1e6 * seconds / poses,
        how=case.solver.explanation,
    )


def _timed(
    solver: InverseKinematics, batches: Sequence[Array]
) -> tuple[float, list[Solutions]]:
    start = time.process_time()
    solutions = [solver.solve(T) for T in batches]
    return time.process_time() - start, solutions


def _mean(
    solutions: Sequence[Solutions], of_pose: Callable[[Solutions], npt.ArrayLike]
) -> float:
    return float(np.concatenate([of_pose(s) for s in solutions]).mean())


def _error(arm: Arm, solutions: Solutions, T: Array) -> float:
    """The largest entry of the difference of poses over all solutions."""
    row, branch = np.nonzero(solutions.exists)
    reached = arm.tool_poses(solutions.q[row, branch])
    return float(np.abs(reached - T[row]).max(initial=0.0))


def cases(names: Sequence[str]) -> Iterator[tuple[str, Case]]:
    """The robots shipped, then the arms of the wheel."""
    for name in robot_names():
        if not names or name in names:
            yield name, _shipped(name)
    for name in ARMS if example_robots() else ():
        if not names or name in names:
            arm = load_arm(name)
            yield (
                f"{name} (URDF)",
                Case(arm, SOLVERS["auto"](arm.model, arm.joints, arm.frame, {})),
            )


def _shipped(name: str) -> Case:
    path = robots_folder() / name / ROBOT_FILE
    robot = build_robot(load_robot_description(path))
    arm = Arm(robot.model, robot.arm.names, robot.tool_frame)
    return Case(arm, robot.ik)


def _cells(row: Measured) -> tuple[str, ...]:
    return (
        row.robot,
        str(row.joints),
        f"{100 * row.solved:.2f} %",
        f"{row.branches:.1f}",
        f"{row.within:.1f}",
        f"{row.error:.0e}",
        f"{row.microseconds:.1f}",
        row.how,
    )


def main() -> None:
    """Print the table, each row as soon as it is known."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("robots", nargs="*", help="names; all where none is given")
    parser.add_argument("--poses", type=int, default=2000)
    parser.add_argument("--batch", type=int, default=600)
    parser.add_argument("--markdown", action="store_true")
    options = parser.parse_args()
    line = _markdown if options.markdown else _plain
    print(line(HEADER))
    if options.markdown:
        print("|" + " --- |" * len(HEADER))
    for name, case in cases(options.robots):
        row = measure(name, case, options.poses, options.batch)
        print(line(_cells(row)), flush=True)


def _plain(cells: Sequence[str]) -> str:
    widths = (22, 6, 9, 8, 6, 7, 8, 0)
    return "  ".join(
        cell.ljust(width) if column in (0, 7) else cell.rjust(width)
        for column, (cell, width) in enumerate(zip(cells, widths, strict=True))
    )


def _markdown(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    main()
