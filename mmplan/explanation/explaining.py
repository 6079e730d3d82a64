"""Why a problem has no solution, or how hard it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from mmplan.collision import CollisionWorld
from mmplan.explanation.causes import Cause, cause_on_the_way, causes_of
from mmplan.explanation.evidence import Evidence
from mmplan.explanation.funnel import Stage, funnel
from mmplan.explanation.near_limit import tightest_joints
from mmplan.explanation.near_miss import NearMiss
from mmplan.explanation.nearest import nearest_miss
from mmplan.explanation.relaxations import Relaxation, Trials, relaxations
from mmplan.explanation.search import setting_score
from mmplan.explanation.settings import Setting
from mmplan.pipeline import plan_candidates, task_generators
from mmplan.problem import Problem
from mmplan.scoring import End

Pairs = tuple[tuple[str, str, float], ...]


@dataclass(frozen=True)
class Explanation:
    """What there is to say of one task.

    `stages` count random pairs of base and grasp. A search of `evaluations` found
    `feasible` pairs at start and goal, `grasps_by_end` that work at the start only, at
    the goal only and at both, and some `candidates`; `first_free` is the first of
    which the straight motions are free, from 1, None if there is none. `pairs` collide
    most often at start and goal. `causes` is empty where nothing is in the way.
    """

    task: int  # place in the scene, from 0
    object: str
    causes: tuple[Cause, ...]
    stages: tuple[Stage, ...]
    evaluations: int
    feasible: tuple[int, int]
    grasps_by_end: tuple[int, int, int]
    candidates: int
    first_free: int | None
    pairs: tuple[Pairs, Pairs]
    near_miss: NearMiss | None
    relaxations: tuple[Relaxation, ...]
    planned: bool | None  # whether there is a verified plan; None: not asked for

    @property
    def solvable(self) -> bool:
        """Whether nothing was found to be in the way."""
        return not self.causes


def explain(
    problem: Problem, *, seed: int = 0, paths: bool = False, relax: bool = True
) -> tuple[Explanation, ...]:
    """Explain every task of a problem, each as the tasks before it would leave things.

    Paths are planned only with `paths`, and only where nothing else is in the way;
    changes that might help are tried only with `relax`. The same problem and seed give
    the same explanation.
    """
    return tuple(
        _explanation(
            Setting(one, CollisionWorld.of_problem(one)),
            number,
            seed,
            rng,
            paths,
            relax,
        )
        for number, (one, rng) in enumerate(
            zip(single_tasks(problem), task_generators(problem, seed), strict=True)
        )
    )


def single_tasks(problem: Problem) -> Iterator[Problem]:
    """The problems of the single tasks, each as the tasks before it leave things."""
    for task in problem.tasks:
        yield replace(problem, tasks=(task,))
        moved = tuple(
            replace(o, T_world_object=task.T_world_goal) if o.name == task.object else o
            for o in problem.objects
        )
        problem = replace(problem, objects=moved)


def _explanation(
    setting: Setting,
    number: int,
    seed: int,
    rng: np.random.Generator,
    paths: bool,
    relax: bool,
) -> Explanation:
    evidence = Evidence.gather(setting_score(setting), rng)
    causes = causes_of(evidence)
    planned = None
    if paths and not causes and evidence.found is not None:
        few = replace(evidence.found, candidates=evidence.triples)
        plan, attempts = plan_candidates(evidence.score, few, seed, rng)
        planned = plan is not None
        causes = () if planned else (cause_on_the_way(evidence, attempts),)
    tried: tuple[Relaxation, ...] = ()
    if relax and causes:
        lines = bool(evidence.blocked)
        trials = Trials(setting, seed, lines, paths=planned is False)
        suspects = _suspects(setting, evidence, causes[0])
        joints = _tight_joints(evidence, causes[0])
        tried = relaxations(trials, causes[0], suspects, joints)
        removed = [name for r in tried if r.solvable for name in r.removed]
        causes = (causes[0].blaming(removed), *causes[1:])
    start, goal = (evidence.collisions(end).pairs() for end in End)
    return Explanation(
        task=number,
        object=setting.task.object,
        causes=causes,
        stages=funnel(*(evidence.surveys[end] for end in End)),
        evaluations=evidence.evaluations,
        feasible=(evidence.feasible(End.START), evidence.feasible(End.GOAL)),
        grasps_by_end=evidence.grasps_by_end,
        candidates=len(evidence.triples),
        first_free=len(evidence.blocked) if None in evidence.blocked else None,
        pairs=(start, goal),
        near_miss=nearest_miss(evidence, causes[0], rng) if causes else None,
        relaxations=tried,
        planned=planned,
    )


def _suspects(setting: Setting, evidence: Evidence, cause: Cause) -> list[str]:
    """What might be taken away: culprits first, then all that is hit at either end."""
    if cause.kind in ("hand", "grasp quality", "carry"):
        return []
    scenery = setting.world.scenery
    known = {s.owner for s in scenery.obstacles if not scenery.is_ground(s.owner)}
    known |= set(setting.world.standing) - {setting.task.object}
    names = [name for name, _ in cause.culprits]
    for end in [cause.end] if cause.end is not None else list(End):
        names += [name for name, _ in evidence.collisions(end).culprits()]
    return [name for name in dict.fromkeys(names) if name in known]


def _tight_joints(evidence: Evidence, cause: Cause) -> list[str]:
    """The joints whose limits are in the way, if that is the cause."""
    if cause.kind != "joint limits" or cause.end is None:
        return []
    return tightest_joints(evidence.score, evidence.surveys[cause.end])
