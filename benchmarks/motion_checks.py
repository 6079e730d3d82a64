"""How motions are checked: whether all ways agree, and what each costs.

    python benchmarks/motion_checks.py [SCENE ...] [--edges 800] [--plain] [--threads 2]

For every scene (by default each that is shipped) random edges from configurations that
are free of collision, checked four ways: at single configurations; as one question
about the same steps; as steps a tenth as long; and continuously. The first two must
agree on every edge, and no edge that collides in steps may be free continuously. Times
are CPU microseconds an edge. `--plain` does without numba; the digest is that of all
answers and must be the same. So it must with `--threads`: each then checks a share of
the edges in a world of its own, and times are those on the clock.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mmplan.collision import CollisionWorld

STEP = 0.02  # m, that no point of the robot exceeds between two checks
LENGTHS = (0.05, 1.0)  # m, of edges, weighted by lever arms


def main() -> None:
    """Print a row for each scene, and the digest of all answers."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--edges", type=int, default=800)
    parser.add_argument("--plain", action="store_true")
    parser.add_argument("--threads", type=int)
    options = parser.parse_args()
    if options.plain:
        sys.modules["numba"] = None  # type: ignore[assignment]

    # Only now, since it is here that numba is looked for.
    from mmplan import assets
    from mmplan.collision import compile_motions

    compile_motions()
    digest = hashlib.sha256()
    print(
        "| scene | pairs | edges | collide | states ≠ steps | only fine steps | "
        "only continuous | states, us | steps, us | continuous, us |"
    )
    print("|" + " --- |" * 10)
    for name in options.scenes or assets.scene_names():
        print(row(name, options.edges, options.threads, digest), flush=True)
    print(f"digest {digest.hexdigest()[:16]}")


def row(name: str, count: int, threads: int | None, digest: hashlib._Hash) -> str:
    """Check the edges of a scene in all ways."""
    from mmplan.collision import CollisionWorld
    from mmplan.planning import PathChecker
    from mmplan.scene_file import load_problem

    problem = load_problem(name)
    world = CollisionWorld.of_problem(problem)
    checker = PathChecker(world, STEP)
    rng = np.random.default_rng(0)
    robot = problem.robot
    low, high = (np.tile(problem.q_start, (20 * count, 1)) for _ in range(2))
    arm, base = robot.arm.indices, robot.base.indices
    low[:, arm] = np.maximum(robot.arm.lower, -np.pi)
    high[:, arm] = np.minimum(robot.arm.upper, np.pi)
    bounds = problem.base_bounds
    low[:, base] = np.where(np.isfinite(bounds[:, 0]), bounds[:, 0], -np.pi)
    high[:, base] = np.where(np.isfinite(bounds[:, 1]), bounds[:, 1], np.pi)
    q = rng.uniform(low, high)
    q = q[~world.in_collision(q)][:count]
    dq = rng.normal(size=q.shape)
    dq[:, np.setdiff1d(np.arange(robot.model.nq), [*arm, *base])] = 0.0
    ways = np.linalg.norm(dq * checker.sweep.weights, axis=1, keepdims=True)
    dq *= rng.uniform(*LENGTHS, (len(q), 1)) / ways
    steps = checker.steps(dq).tolist()

    worlds = [
        world,
        *(CollisionWorld.of_problem(problem) for _ in range(1, threads or 1)),
    ]
    shares = np.array_split(np.arange(len(q)), len(worlds))
    clock = time.process_time if threads is None else time.perf_counter

    def asked(
        ask: Callable[[CollisionWorld, int], bool],
    ) -> tuple[np.ndarray, float]:
        def share_of(world: CollisionWorld, share: np.ndarray) -> list[bool]:
            return [ask(world, i) for i in share.tolist()]

        with ThreadPoolExecutor(len(worlds)) as pool:
            list(pool.map(share_of, worlds, [share[:1] for share in shares]))
            begin = clock()
            answers = np.concatenate(list(pool.map(share_of, worlds, shares)))
            return answers, (clock() - begin) / len(q) * 1e6

    def single(world: CollisionWorld, i: int) -> bool:
        fractions = np.arange(1, steps[i] + 1)[:, None] / steps[i]
        return bool(world.in_collision(q[i] + fractions * dq[i]).any())

    states, states_us = asked(single)
    edges, edges_us = asked(lambda w, i: w.steps_collide(q[i], dq[i], steps[i]))
    fine, _ = asked(lambda w, i: w.steps_collide(q[i], dq[i], 10 * steps[i]))
    whole, whole_us = asked(lambda w, i: w.motion_collides(q[i], dq[i]))
    for answers in (states, edges, fine, whole):
        digest.update(answers.tobytes())
    cells = [name, len(world.pairs), len(q), f"{edges.mean():.0%}"]
    cells += [int((states != edges).sum()), int((fine & ~edges).sum())]
    cells += [int((whole & ~fine).sum())]
    cells += [f"{us:.0f}" for us in (states_us, edges_us, whole_us)]
    if (fine & ~whole).any():
        cells.append(f"WRONG: {int((fine & ~whole).sum())} free continuously")
    return "| " + " | ".join(map(str, cells)) + " |"


if __name__ == "__main__":
    main()
