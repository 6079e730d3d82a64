"""Do grasps of good quality hold? Judged by MuJoCo, which shares nothing with mmplan.

For each mesh: antipodal grasps of the Puma's hand, as sampled, and as many that are
spoiled, turned by up to 30 degrees and moved by up to 2 cm. Each goes with a friction
and a mass of the object drawn from a few. The quality G is epsilon with the weight, as
in the score. In the simulation the hand alone, without the arm, stands around the
object in free space as far open as commanded, closes with its greatest force and then
rises by 0.2 m in a second, while gravity pulls along the object's -z. Both fingers move
alike, as those of most parallel grippers do, and the palm does not give way.

A grasp holds if the object is then within 5 cm of where it was in the hand before it
closed; it keeps the object's pose if that is within 1 cm and 10 degrees, as a plan that
takes the object for fixed in the hand relies on. Shares are in percent, of all meshes
by decile of quality (grasps of equal quality are in one decile), then by mesh.

    python benchmarks/lifting.py [--grasps 100] [--objects mug bowl ...]

Needs the extras `meshes` and `render` (for MuJoCo).
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin
from _lift import lift
from _objects import OBJECTS
from scipy.stats import rankdata, spearmanr

from mmplan.collision import Closings, HandCloser, Scenery
from mmplan.collision.fingers import Fingers, ObjectSolids
from mmplan.collision.hand_room import HandRoom
from mmplan.grasp_values import sampled
from mmplan.problem import Object, Problem, ScoreSettings, Task
from mmplan.robot import Robot
from mmplan.robot_build import load_robot
from mmplan.scoring.grasp_quality import Hold, WrenchQuality
from mmplan.shapes import Array, Mesh

FRICTIONS, MASSES = (0.2, 0.4, 0.6), (0.2, 0.5, 1.0)  # kg
TURNED, MOVED = np.radians(30.0), 0.02  # rad, m
HELD = 0.05  # m
KEPT = (0.01, np.radians(10.0))  # m, rad


class Trials(NamedTuple):
    """What became of n grasps."""

    quality: Array  # (n,)
    held: npt.NDArray[np.bool_]  # (n,)
    kept: npt.NDArray[np.bool_]  # (n,)


def trials(item: Object, robot: Robot, n: int, rng: np.random.Generator) -> Trials:
    """Rate grasps of an object and lift it with each that closes on it."""
    T = candidates(item, robot, n, rng)
    solids = Scenery.solids_of_object(item)
    closer = HandCloser(robot, solids)
    closings = closer.close(T)
    T = T[closings.touches & palm_free(robot, ObjectSolids(solids), T)][:n]
    closings = closer.close(T)
    rows = []
    for i, (pose, opened) in enumerate(zip(T, closings.opened, strict=True)):
        facts = {"friction": rng.choice(FRICTIONS), "mass": rng.choice(MASSES)}
        known = replace(item, **facts)
        one = Closings(opened[None], closings.closed[[i]], closings.touches[[i]])
        hold = Hold(np.zeros((1, 0)), pose[None], one)
        (quality,) = measure(known, robot, closer)(hold)
        drift = lift(known, robot, pose, opened)
        kept = drift.distance < KEPT[0] and drift.angle < KEPT[1]
        rows.append((quality, drift.distance < HELD, kept))
    quality, held, kept = np.array(rows, dtype=float).T
    return Trials(quality, held > 0.0, kept > 0.0)


def candidates(item: Object, robot: Robot, n: int, rng: np.random.Generator) -> Array:
    """Tool poses (m, 4, 4): sampled ones and spoiled ones in turn."""
    good = sampled(item, robot, n, 0).T_object_tool
    bad = good.copy()
    for T in bad:
        axis = rng.normal(size=3)
        angle = rng.uniform(0.0, TURNED)
        T[:3, :3] = T[:3, :3] @ pin.exp3(angle * axis / np.linalg.norm(axis))
        T[:3, 3] += rng.uniform(-MOVED, MOVED, 3) / np.sqrt(3.0)
    return np.stack([good, bad], axis=1).reshape(-1, 4, 4)


def palm_free(robot: Robot, thing: ObjectSolids, T: Array) -> npt.NDArray[np.bool_]:
    """Whether the hand's palm is off the object at tool poses (n, 4, 4), (n,)."""
    free = np.ones(len(T), np.bool_)
    opened = np.tile(robot.hand_open, (len(T), 1))
    for geometry, poses in Fingers(robot).placed(T, opened, HandRoom(robot).palm):
        free &= thing.nearest(geometry, poses) > 0.0
    return free


def measure(item: Object, robot: Robot, closer: HandCloser) -> WrenchQuality:
    """The quality G of grasps of an object that is lifted as it stands."""
    task = Task(item.name, np.eye(4))
    settings = ScoreSettings(quality="epsilon")
    facts = (robot, robot.q_neutral, np.zeros((2, 2)), (), (item,), (task,))
    return WrenchQuality(Problem("lifting", *facts, score=settings), task, closer)


def deciles(found: Trials) -> npt.NDArray[np.int64]:
    """The decile of each grasp by quality, 0 the worst; equal ones in one, (n,)."""
    rank: Array = rankdata(found.quality, "average")
    return np.minimum(9, (10.0 * (rank - 0.5) / len(rank)).astype(np.int64))


def percent(which: npt.NDArray[np.bool_]) -> str:
    """The share that is true."""
    return f"{which.mean():.0%}" if len(which) else ""


def rank(quality: Array, good: npt.NDArray[np.bool_]) -> str:
    """The rank correlation of quality and a success; none where either is constant."""
    if np.ptp(quality) == 0.0 or good.all() or not good.any():
        return ""
    return f"{spearmanr(quality, good).statistic:.2f}"


def show_deciles(found: Trials) -> None:
    """Print a row for each decile, the best first."""
    print("| decile | quality | grasps | hold | keep the pose |")
    print("|---|---|---|---|---|")
    decile = deciles(found)
    for number in sorted(set(decile.tolist()), reverse=True):
        rows = decile == number
        span = f"{found.quality[rows].min():.2f} to {found.quality[rows].max():.2f}"
        cells = [span, rows.sum(), percent(found.held[rows]), percent(found.kept[rows])]
        print(f"| {number + 1} |", *(f"{cell} |" for cell in cells))


def show_object(name: str, found: Trials) -> None:
    """Print one row: its top decile and its lower half by quality."""
    order = np.argsort(-found.quality, kind="stable")
    top, bottom = order[: max(1, len(order) // 10)], order[len(order) // 2 :]
    shares = [percent(good[r]) for good in found[1:] for r in (top, bottom)]
    ranks = [rank(found.quality, good) for good in found[1:]]
    held, kept = (f"{a} / {b}" for a, b in (shares[:2], shares[2:]))
    cells = [name, len(order), held, ranks[0], kept, ranks[1]]
    print("|", *(f"{cell} |" for cell in cells), flush=True)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a row for each object, then the deciles of all together."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grasps", type=int, default=100)
    parser.add_argument("--objects", nargs="*", default=list(OBJECTS))
    options = parser.parse_args(arguments)
    robot = load_robot("puma_mobile")
    print(
        "| object | grasps | hold: top decile / lower half | rank correlation", end=""
    )
    print(" | keep the pose: top decile / lower half | rank correlation |")
    print("|---|---|---|---|---|---|")
    found = []
    for number, name in enumerate(options.objects):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{name}.stl"
            OBJECTS[name](1).export(path)
            item = Object(name, Mesh(path), np.eye(4), {}, friction=max(FRICTIONS))
            rng = np.random.default_rng(number)
            found.append(trials(item, robot, options.grasps, rng))
        show_object(name, found[-1])
    together = Trials(*map(np.concatenate, zip(*found, strict=True)))
    show_object("all", together)
    print()
    show_deciles(together)


if __name__ == "__main__":
    main()
