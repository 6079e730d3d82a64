"""The paper's Figure 1 as an experiment: the best grasp alone is the wrong one.

A wineglass with two families, `bowl` (a power grasp) and `stem` (a pinch), goes into
the dishwasher rack. Four ways to choose the grasp, all with the same budget of score
evaluations in all and the same score without a grasp term:

- at start: of the grasps that work at the start, the one of the best quality (epsilon);
- at both ends: the same, but only if it works at the goal as well;
- co-evolution: grasp and both bases together, by the score;
- blockwise: the same with another optimizer and a seventh of the budget, which takes it
  about as long.

The greedy ways draw grasps and bases at random: first grasps with bases at the start
until a third of the budget is spent, then, for the grasp of the best quality, bases at
both ends for the rest; "at both ends" tries all of the grasps at both ends with halves
of the budget. Success means a score above 0 at both ends; scores are means of the sums
of both over the successes.

    python benchmarks/figure1.py [--seeds 100] [--evaluations 6940]

With scene files the same on other problems, with all grasps that the shape of the
object suggests: shares of successes over all problems of a family (the name up to the
first -) and seeds, and scores in percent of the best score found for the problem.

    python benchmarks/figure1.py generated/*.yaml --seeds 5
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from mmplan.grasp_build import default_grasps
from mmplan.grasps import Axis, CylinderSide, GraspFamily
from mmplan.optimizers import OPTIMIZERS, optimize, search_space
from mmplan.pipeline import score_function
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.scoring import End, ScoreFunction
from mmplan.scoring.grasp_quality import Hold, WrenchQuality
from mmplan.shapes import Array

# Bases tried with each grasp that is drawn.
_BASES = 20


def figure1_problem() -> Problem:
    """The shipped wineglass with the two grasps of Figure 1."""
    problem = load_problem("wineglass")
    (glass,) = problem.objects
    grasps: dict[str, GraspFamily] = {
        "bowl": CylinderSide(along=(0.13, 0.205), tilt=0.5),
        "stem": Axis(along=(0.02, 0.09)),
    }
    return replace(problem, objects=(replace(glass, grasps=grasps, mass=0.15),))


def generated_problem(scene: str) -> Problem:
    """The problem of a scene file whose first task's object has its shape's grasps."""
    problem = load_problem(scene)
    moved = problem.object(problem.tasks[0].object)
    item = replace(moved, grasps=default_grasps(moved, problem.robot))
    others = (o for o in problem.objects if o.name != item.name)
    return replace(problem, objects=(item, *others), tasks=problem.tasks[:1])


def quality(score: ScoreFunction, grasps: Array) -> Array:
    """Epsilon of grasps (n, g), (n,)."""
    problem = score.problem
    rated = replace(problem, score=replace(problem.score, quality="epsilon"))
    measure = WrenchQuality(rated, score.task, score.closer)
    T = score.family.tool_poses(grasps)
    return measure(Hold(grasps, T, score.closer.close(T)))


def at_start(score: ScoreFunction, evaluations: int, rng: np.random.Generator) -> float:
    """Choose the grasp by quality at the start, then bases for it; the score or 0."""
    n = max(1, evaluations // 3 // _BASES)
    grasps, works = draw(score, n, (End.START,), rng)
    if not works.any():
        return 0.0
    best = grasps[works][np.argmax(quality(score, grasps[works]))]
    return with_grasp(score, best, evaluations - n * _BASES, rng)


def at_both(score: ScoreFunction, evaluations: int, rng: np.random.Generator) -> float:
    """Choose the grasp by quality among those that work at both ends."""
    n = max(1, evaluations // 2 // (2 * _BASES))
    grasps, works = draw(score, n, tuple(End), rng)
    if not works.any():
        return 0.0
    best = grasps[works][np.argmax(quality(score, grasps[works]))]
    return with_grasp(score, best, evaluations - 2 * n * _BASES, rng)


def together(score: ScoreFunction, evaluations: int, rng: np.random.Generator) -> float:
    """Co-evolve grasps and bases; the score of the best candidate or 0."""
    return by_optimizer("coevolution", score, evaluations, rng)


def blockwise(
    score: ScoreFunction, evaluations: int, rng: np.random.Generator
) -> float:
    """Search grasps and bases in blocks, with a seventh of the evaluations."""
    return by_optimizer("blockwise", score, evaluations // 7, rng)


def by_optimizer(
    name: str, score: ScoreFunction, evaluations: int, rng: np.random.Generator
) -> float:
    """The score of the best candidate that an optimizer finds or 0."""
    settings = score.problem.optimizer
    optimizer = OPTIMIZERS[name](search_space(score), settings, rng)
    found = optimize(score, optimizer, evaluations, 1).candidates
    return found[0].total if found else 0.0


def draw(
    score: ScoreFunction, n: int, ends: tuple[End, ...], rng: np.random.Generator
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Grasps (n, g), and which of them work at all ends for some base, (n,)."""
    space = search_space(score)
    grasps = space.grasps.sample(n, rng)
    works = np.ones(n, np.bool_)
    for end in ends:
        q_base = space.bases[end].q_base(space.bases[end].sample(n * _BASES, rng))
        totals = score(end, q_base, np.repeat(grasps, _BASES, axis=0)).total
        works &= (totals > 0.0).reshape(n, _BASES).any(axis=1)
    return grasps, works


def with_grasp(
    score: ScoreFunction, grasp: Array, evaluations: int, rng: np.random.Generator
) -> float:
    """The best sum of scores that random bases reach with one grasp; 0 for failure."""
    space = search_space(score)
    best = []
    for end in End:
        n = evaluations // 2
        q_base = space.bases[end].q_base(space.bases[end].sample(n, rng))
        best.append(score(end, q_base, np.tile(grasp, (n, 1))).total.max())
    return float(sum(best)) if min(best) > 0.0 else 0.0


WAYS: dict[str, Callable[[ScoreFunction, int, np.random.Generator], float]] = {
    "best quality at the start": at_start,
    "best quality that works at both ends": at_both,
    "co-evolution": together,
    "blockwise, a seventh of the evaluations": blockwise,
}


def totals(problem: Problem, seeds: int, evaluations: int) -> Array:
    """The score or 0 of each way with each seed, (ways, seeds)."""
    found = [
        [
            way(score_function(problem), evaluations, np.random.default_rng(seed))
            for seed in range(seeds)
        ]
        for way in WAYS.values()
    ]
    return np.array(found)


def show(found: Array, *label: object) -> None:
    """Print a row for each way, from scores (ways, runs)."""
    for name, scores in zip(WAYS, found, strict=True):
        won = scores[scores > 0.0]
        score = f"{won.mean():.1f} ± {won.std():.1f}" if len(won) else "none"
        cells = [*label, name, f"{len(won) / len(scores):.0%}", score]
        print("|", *(f"{cell} |" for cell in cells), flush=True)


def by_family(scenes: Sequence[str], seeds: int, evaluations: int) -> None:
    """Print the table of other problems."""
    families: dict[str, list[Array]] = {}
    for scene in scenes:
        problem = generated_problem(scene)
        found = totals(problem, seeds, evaluations)
        print(f"{problem.name}: {(found > 0.0).sum(axis=1)}", file=sys.stderr)
        best = found.max()
        share = 100.0 * found / best if best > 0.0 else found
        families.setdefault(problem.name.partition("-")[0], []).append(share)
    print("| family | problems | the grasp is chosen by | success | score |")
    print("|---|---|---|---|---|")
    for family, shares in families.items():
        show(np.concatenate(shares, axis=1), family, len(shares))
    everything = [share for shares in families.values() for share in shares]
    show(np.concatenate(everything, axis=1), "all", len(everything))


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--evaluations", type=int, default=6940)
    options = parser.parse_args(arguments)
    if options.scenes:
        by_family(options.scenes, options.seeds, options.evaluations)
        return
    print("| the grasp is chosen by | success | score, mean ± deviation |")
    print("|---|---|---|")
    show(totals(figure1_problem(), options.seeds, options.evaluations))


if __name__ == "__main__":
    main()
