"""What the grasps of an object are worth: how many close, how well, and where."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mmplan.atomic_file import write_whole
from mmplan.collision import HandCloser, Scenery, hand_size
from mmplan.exceptions import InputError
from mmplan.files.grasp_files import isaac_text, regions_text
from mmplan.files.suggestions import unknown
from mmplan.grasp_build import default_grasps
from mmplan.grasp_exchange import listed, regions_of
from mmplan.grasps import GraspFamily
from mmplan.optimizers import search_space
from mmplan.pipeline import score_function
from mmplan.problem import Object, Problem, Task
from mmplan.scoring import End, Outcome
from mmplan.scoring.grasp_quality import Hold, WrenchQuality
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Samples:
    """Grasps drawn from one family, with the hand closed on each."""

    T_object_tool: Array  # (n, 4, 4)
    opened: Array  # (n, hand joints)
    closes: npt.NDArray[np.bool_]  # (n,)
    quality: Array  # (n,), epsilon as in the score


@dataclass(frozen=True)
class FamilySurvey:
    """What one family is worth; shares are from 0 to 1.

    `feasible` is the share of grasps that work at an end for one of the bases drawn;
    empty where no task moves the object. Qualities are those of grasps that close.
    """

    name: str
    family: str
    genes: int
    closes: float
    quality_median: float
    quality_best: float
    feasible: dict[str, float] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


def object_of(problem: Problem, name: str) -> Object:
    """The object of that name, with the grasps of its shape if it has no others.

    Raises:
        InputError: There is no such object, or the hand is too small for it.
    """
    names = [item.name for item in problem.objects]
    if name not in names:
        raise InputError(unknown("object", name, names))
    item = problem.object(name)
    if item.grasps:
        return item
    return replace(item, grasps=default_grasps(item, problem.robot))


def samples(
    problem: Problem, item: Object, family: GraspFamily, n: int, seed: int
) -> Samples:
    """Draw grasps from a family and close the hand on each."""
    task = _task(problem, item) or Task(item.name, item.T_world_object)
    settings = replace(problem.score, quality="epsilon")
    here = replace(problem, objects=(item,), score=settings)
    closer = HandCloser(problem.robot, Scenery.solids_of_object(item))
    genes = family.genes.sample(n, np.random.default_rng(seed))
    T = family.tool_poses(genes)
    closings = closer.close(T)
    quality = WrenchQuality(here, task, closer)(Hold(genes, T, closings))
    return Samples(T, closings.opened, closings.touches, quality)


def survey(
    problem: Problem, item: Object, n: int, bases: int, seed: int
) -> tuple[FamilySurvey, ...]:
    """Draw `n` grasps of each family of an object and try each with some bases."""
    found = []
    for name, family in item.grasps.items():
        drawn = samples(problem, item, family, n, seed)
        closing = drawn.quality[drawn.closes]
        found.append(
            FamilySurvey(
                name=name,
                family=type(family).__name__,
                genes=len(family.genes),
                closes=float(drawn.closes.mean()),
                quality_median=float(np.median(closing)) if len(closing) else 0.0,
                quality_best=float(closing.max()) if len(closing) else 0.0,
                feasible=_feasible(problem, item, name, n, bases, seed),
            )
        )
    return tuple(found)


def save_samples(path: Path, problem: Problem, item: Object, n: int, seed: int) -> None:
    """Write the grasps drawn from all families that close as an isaac_grasp file.

    Best first; the hand frame is the robot's tool frame, and confidences are qualities.

    Raises:
        InputError: The file cannot be written there.
    """
    robot = problem.robot
    drawn = [samples(problem, item, f, n, seed) for f in item.grasps.values()]
    closes = np.concatenate([d.closes for d in drawn])
    quality = np.concatenate([d.quality for d in drawn])[closes]
    best = np.argsort(-quality, kind="stable")
    T = np.concatenate([d.T_object_tool for d in drawn])[closes][best]
    opened = np.concatenate([d.opened for d in drawn])[closes][best]
    frame = robot.model.frames[robot.tool_frame].name
    hands = [dict(zip(robot.hand.names, q.tolist(), strict=True)) for q in opened]
    write_whole(path, isaac_text(listed(T, quality[best], np.eye(4), frame), hands))


def save_regions(path: Path, item: Object) -> None:
    """Write the families of an object as task space regions of the tool frame.

    Raises:
        InputError: One of them is none, or the file cannot be written there.
    """
    write_whole(path, regions_text(regions_of(item.grasps, np.eye(4))))


def opening_of(problem: Problem) -> float:
    """How far the hand of the problem's robot opens, m."""
    return hand_size(problem.robot).opening


def _task(problem: Problem, item: Object) -> Task | None:
    return next((t for t in problem.tasks if t.object == item.name), None)


def _feasible(
    problem: Problem, item: Object, name: str, n: int, bases: int, seed: int
) -> dict[str, float]:
    """At either end, the share of a family's grasps that some base serves."""
    task = _task(problem, item)
    if task is None:
        return {}
    alone = replace(item, grasps={name: item.grasps[name]})
    others = (o for o in problem.objects if o.name != item.name)
    score = score_function(replace(problem, objects=(alone, *others), tasks=(task,)))
    space, rng = search_space(score), np.random.default_rng(seed)
    grasps = space.grasps.sample(n, rng)
    shares = {}
    for end in End:
        q_base = space.bases[end].q_base(space.bases[end].sample(n * bases, rng))
        outcome = score(end, q_base, np.repeat(grasps, bases, axis=0)).outcome
        works = (outcome == Outcome.SCORED).reshape(n, bases).any(axis=1)
        shares[end.name.lower()] = float(works.mean())
    return shares
