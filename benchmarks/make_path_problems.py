"""Makes benchmarks/data/tiago_whole_body.json: paths of a whole mobile manipulator.

    python benchmarks/make_path_problems.py [--problems 10] [--seed 0]

TIAGo on a base that drives and turns freely stands 2 m from where it is to be, its arm
tucked, and ends reaching over a table or into a shelf, among things drawn at random:
11 joints move. The format is that of MotionBenchMaker's problems.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mmplan.benchmarking.paths.arena import Arena, Contestant, contestant, make_arena
from mmplan.benchmarking.paths.problems import PathProblem, load_path_problems
from mmplan.problem import Obstacle
from mmplan.shapes import Array, Box, Cylinder

OUTPUT = Path(__file__).parent / "data" / "tiago_whole_body.json"
AWAY = 2.0  # m, the start's base from the goal's
BATCH = 20_000  # configurations drawn at a time

# Where the tool is to be: the middle and the halves of a box (m), by family.
REGIONS = {
    "table": (np.array([0.0, 0.0, 0.95]), np.array([0.3, 0.5, 0.12])),
    "shelf": (np.array([0.0, 0.0, 0.95]), np.array([0.12, 0.35, 0.12])),
}


def main() -> None:
    """Draw the problems and write them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", type=int, default=10, help="of each family")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    robot = contestant("tiago")
    families = {
        family: [
            _drawn(robot, family, number + 1, rng) for number in range(options.problems)
        ]
        for family in REGIONS
    }
    OUTPUT.write_text(_text(families))
    print(f"{len(load_path_problems(OUTPUT).problems)} problems in {OUTPUT}")


def _drawn(
    robot: Contestant, family: str, number: int, rng: np.random.Generator
) -> dict[str, Any]:
    """One problem whose ends are free."""
    while True:
        obstacles = _table(rng) if family == "table" else _shelf(rng)
        ends = _ends(robot, family, obstacles, rng)
        if ends is not None:
            break
    start, goal = (np.round(end, 6).tolist() for end in ends)
    things = [_thing(obstacle) for obstacle in obstacles]
    return {
        "index": number,
        "family": family,
        "start": start,
        "goal": goal,
        "objects": things,
    }


def _table(rng: np.random.Generator) -> tuple[Obstacle, ...]:
    """A table with five things on it."""
    legs = [(x, y) for x in (-0.35, 0.35) for y in (-0.65, 0.65)]
    things = [
        _at("top", Box((0.8, 1.4, 0.04)), 0.0, 0.0, 0.73),
        *(
            _at(f"leg{i}", Box((0.06, 0.06, 0.71)), x, y, 0.355)
            for i, (x, y) in enumerate(legs)
        ),
    ]
    for i in range(5):
        x, y = rng.uniform((-0.35, -0.6), (0.35, 0.6))
        radius, height = rng.uniform((0.03, 0.1), (0.06, 0.35))
        cylinder = Cylinder(float(radius), float(height))
        things.append(_at(f"can{i}", cylinder, x, y, 0.75 + height / 2.0))
    return tuple(things)


def _shelf(rng: np.random.Generator) -> tuple[Obstacle, ...]:
    """A shelf that is open to -x, with three things on the board reached for."""
    things = [
        _at("back", Box((0.02, 1.0, 1.8)), 0.2, 0.0, 0.9),
        *(_at(n, Box((0.4, 0.02, 1.8)), 0.0, y, 0.9) for n, y in _SIDES.items()),
        *(
            _at(f"board{i}", Box((0.4, 1.0, 0.02)), 0.0, 0.0, z)
            for i, z in enumerate((0.1, 0.45, 0.8, 1.2, 1.79))
        ),
    ]
    for i, y in enumerate(rng.uniform(-0.4, 0.4, 3)):
        height = float(rng.uniform(0.1, 0.2))
        cylinder = Cylinder(0.035, height)
        things.append(_at(f"can{i}", cylinder, 0.1, float(y), 0.81 + height / 2.0))
    return tuple(things)


_SIDES = {"left": 0.5, "right": -0.5}


def _ends(
    robot: Contestant,
    family: str,
    obstacles: tuple[Obstacle, ...],
    rng: np.random.Generator,
) -> tuple[Array, Array] | None:
    """Start and goal (joints,), None if none were met."""
    tucked = robot.robot.configurations["tucked"]
    limits = robot.robot.arm.lower, robot.robot.arm.upper
    arena = make_arena(robot, _problem(np.zeros(3), tucked, obstacles))
    q = np.tile(arena.q_start, (BATCH, 1))
    angle = rng.uniform(-0.5, 0.5, BATCH) + np.pi
    away = rng.uniform(0.55, 1.0, BATCH)
    q_base = np.stack([away * np.cos(angle), away * np.sin(angle), angle - np.pi], 1)
    q[:, robot.robot.base.indices] = q_base
    q[:, robot.robot.arm.indices] = rng.uniform(*limits, (BATCH, len(limits[0])))
    q = q[_reaching(arena, family, q)]
    q = q[~arena.world.in_collision(q)]
    if not len(q):
        return None
    goal = q[0, arena.joints.indices]
    for _ in range(100):
        direction = rng.uniform(0.5 * np.pi, 1.5 * np.pi)
        place = goal[:2] + AWAY * np.array([np.cos(direction), np.sin(direction)])
        start = np.concatenate([place, [rng.uniform(-np.pi, np.pi)], tucked])
        q_start = q[0].copy()
        q_start[arena.joints.indices] = start
        if not arena.world.any_collision(q_start[None]):
            return start, goal
    return None


def _reaching(arena: Arena, family: str, q: Array) -> npt.NDArray[np.bool_]:
    """Which configurations (n, nq) have the tool in its region, pointing along x."""
    middle, half = REGIONS[family]
    T_world_tool = np.array([arena.world.robot.tool_pose(each) for each in q])
    inside: npt.NDArray[np.bool_] = np.all(
        np.abs(T_world_tool[:, :3, 3] - middle) < half, axis=1
    )
    ahead = T_world_tool[:, 0, 2] > (0.7 if family == "shelf" else -1.0)
    return inside & ahead


def _problem(
    q_base: Array, q_arm: Array, obstacles: tuple[Obstacle, ...]
) -> PathProblem:
    q = np.concatenate([q_base, q_arm])
    return PathProblem("drawn", 0, q, q, obstacles)


def _at(name: str, shape: Box | Cylinder, x: float, y: float, z: float) -> Obstacle:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return Obstacle(name, shape, np.round(T, 6))


def _thing(obstacle: Obstacle) -> dict[str, Any]:
    shape = obstacle.shape
    kind, dims = "box", list(getattr(shape, "size", ()))
    if isinstance(shape, Cylinder):
        kind, dims = "cylinder", [shape.length, shape.radius]
    return {
        "name": obstacle.name,
        "type": kind,
        "dims": [round(d, 6) for d in dims],
        "pose": obstacle.T_world_obstacle.tolist(),
    }


def _text(families: dict[str, list[dict[str, Any]]]) -> str:
    """JSON with one line a problem's end or thing."""
    blocks = []
    for family, problems in families.items():
        entries = [
            "  {"
            + ",\n   ".join(
                f'"{key}": '
                + (_lines(value) if key == "objects" else json.dumps(value))
                for key, value in problem.items()
            )
            + "}"
            for problem in problems
        ]
        blocks.append(f'"{family}": [\n' + ",\n".join(entries) + "\n ]")
    return "{" + ",\n ".join(blocks) + "}\n"


def _lines(things: list[dict[str, Any]]) -> str:
    return "[\n    " + ",\n    ".join(json.dumps(thing) for thing in things) + "]"


if __name__ == "__main__":
    main()
