"""One run of a benchmark: what is to be done, and what came of it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from mmplan.optimizers import OptimizerFactory
    from mmplan.problem import OptimizerSettings


# The stages of a run.
IK, COLLISION, DISTANCE = "inverse kinematics", "collision", "distance"
SCORING = "scoring"  # what else the score computes: hand closing, manipulability
OPTIMIZER = "optimizer"
PLANNING = "planning"  # and the proof of what was planned
STAGES = (IK, COLLISION, DISTANCE, SCORING, OPTIMIZER, PLANNING)


def digest(key: tuple[str | int, ...]) -> str:
    """A key of a store as a number in hexadecimal digits."""
    return hashlib.sha256(json.dumps(key).encode()).hexdigest()


class Key(NamedTuple):
    """What tells one run from every other in the same store."""

    problem: str
    optimizer: str
    evaluations: int  # the budget
    planner: str  # "" where no motion is planned
    seed: int
    settings: str  # JSON: the optimizer's other settings

    @property
    def digest(self) -> str:
        """The key as a number in hexadecimal digits."""
        return digest(self)

    def __str__(self) -> str:
        """The key for people."""
        planner = f" and {self.planner}" if self.planner else ""
        return (
            f"{self.problem} by {self.optimizer}{planner}, {self.evaluations} "
            f"evaluations, seed {self.seed}"
        )


@dataclass(frozen=True)
class Job:
    """One run that is to be done, in this process or anywhere else.

    `fingerprint` and `software` are what the run must find where it is done.
    """

    scene: str  # path of the scene file
    problem: str  # the scene's name
    fingerprint: str
    software: str
    factory: OptimizerFactory
    settings: OptimizerSettings
    seed: int
    planner: str = ""

    @property
    def key(self) -> Key:
        """What tells this run from every other."""
        settings = asdict(self.settings)
        name, evaluations = settings.pop("name"), settings.pop("evaluations")
        text = json.dumps(settings, sort_keys=True)
        return Key(self.problem, name, evaluations, self.planner, self.seed, text)

    @property
    def label(self) -> str:
        """The contender's name among planners: `CoEvolution+RRTConnect`."""
        optimizer = getattr(self.factory, "__name__", self.settings.name)
        return f"{optimizer}+{self.planner}" if self.planner else optimizer


@dataclass(frozen=True)
class Record:
    """What came of one run.

    `ends` has, where the run succeeded, under `start` and `goal` the chosen `base` and
    the `score` by term; their sum is `score`, 0 where the run failed. `history` lists
    (evaluations spent, best score so far) wherever the best rose, and the end;
    `seconds` are the wall clock's when these scores were known. `times` maps stages to
    `cpu` and `wall` seconds.
    """

    problem: str
    optimizer: str
    evaluations: int
    planner: str
    seed: int
    settings: str
    label: str
    success: bool
    score: float
    ends: dict[str, Any]
    grasp: str | None  # name of the grasp family
    genes: list[float] | None
    used: int  # evaluations
    cycles: float | None
    history: list[list[float]]
    outcomes: dict[str, dict[str, int]]  # by end: evaluations by outcome
    failure: str | None  # why the search could not even begin
    plan: dict[str, Any] | None
    seconds: list[float]
    times: dict[str, dict[str, float]]
    host: str
    finished: str  # time of day, ISO 8601

    @property
    def key(self) -> Key:
        """What tells this run from every other."""
        return Key(*(getattr(self, name) for name in Key._fields))

    @property
    def solved(self) -> bool:
        """Whether all that was asked for was found: the plan, where one was."""
        return self.success if self.plan is None else bool(self.plan["verified"])

    @property
    def result(self) -> dict[str, Any]:
        """All that another run of the same job must give again."""
        return {k: v for k, v in vars(self).items() if k not in MEASURED}


# What differs from one run of the same job to the next.
MEASURED = frozenset({"seconds", "times", "host", "finished"})
