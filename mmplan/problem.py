"""What there is to solve: robot, obstacles, objects and tasks, as frozen values."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from mmplan.carry import Carry
    from mmplan.grasps import GraspFamily
    from mmplan.robot import Robot
    from mmplan.scoring.term import ScoreTerm
    from mmplan.shapes import Array, Fixture, Shape
    from mmplan.zones import Zone


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A thing that stays where it is.

    `ground` marks what the base drives on: it is no obstacle for the base's links.
    """

    name: str
    shape: Shape | Fixture
    T_world_obstacle: Array  # (4, 4)
    ground: bool = False


@dataclass(frozen=True, eq=False)
class Object:
    """A thing that can be moved: its shape, where it stands, how it can be grasped.

    `grasps` maps the names that the scene gives to grasp families. `mass` (kg) is None
    where it is not known; `friction` is that between the fingers and the object.
    """

    name: str
    shape: Shape
    T_world_object: Array  # (4, 4), before the first task
    grasps: dict[str, GraspFamily] = field(default_factory=dict)
    mass: float | None = None
    friction: float = 0.5


def _no_rules() -> Carry:
    """Nothing to keep to; imports numpy, which faulty scenes do without."""
    from mmplan.carry import Carry

    return Carry()


@dataclass(frozen=True, eq=False)
class Task:
    """Move one object to a pose.

    The four lengths (m) are those of the straight tool motions: `approach` and
    `retreat` along the tool's z, `lift` and `lower` along the world's z. None leaves
    the length to the planner, which starts at its default, shortens where the scene is
    too narrow, and leaves the motion out if nothing else helps; a number is kept to the
    letter, 0 leaves the motion out. `carry` says what holds from the grasp to the
    release.
    """

    object: str
    T_world_goal: Array  # (4, 4)
    approach: float | None = None
    lift: float | None = None
    lower: float | None = None
    retreat: float | None = None
    carry: Carry = field(default_factory=_no_rules)


@dataclass(frozen=True, eq=False)
class WeightedTerm:
    """A term of one's own in the score: `term` is called as any `ScoreTerm` is.

    Its values are at least 0; one that is 1 with a weight of 1 counts 50 points.
    """

    name: str
    term: ScoreTerm
    weight: float = 1.0


@dataclass(frozen=True)
class ScoreSettings:
    """Weights of the score's terms, and what grasp quality is.

    `quality` names the measure G, and a score is 0 where it is below `min_quality`.
    The paper's grasps all close by force, so that it leaves grasp quality out; so do
    the default weights, and the default measure is what the grasp family vouches for.
    `joint_margin` rewards joints of the arm that stay away from their limits, which the
    paper does not; without a weight it is no term at all. `more` are terms of one's
    own, which scene files do not have.
    """

    grasp: float = 0.0
    manipulability: float = 1.0
    clutter: float = 1.0
    min_quality: float = 0.0
    quality: str = "family"
    joint_margin: float = 0.0
    more: tuple[WeightedTerm, ...] = ()


@dataclass(frozen=True)
class OptimizerSettings:
    """Which optimizer, its budget in score evaluations, and its populations.

    The defaults are the paper's. `partners` is the paper's k.
    """

    name: str = "coevolution"
    evaluations: int = 6940
    bases: int = 84
    grasps: int = 64
    partners: int = 7
    mutation: float = 0.2


# Longest edges of a planner's trees, m: a few long ones lead through the open, short
# ones out of a shelf. Their number is odd, as planners extend two trees in turn.
RANGES = (1.5, 0.4, 0.1)


@dataclass(frozen=True)
class PlannerSettings:
    """Which planner and how far it may go before it gives up.

    Planning is bounded by `iterations` (of the planner, for one path) and `candidates`
    (how many distinct goals of the optimizer are tried, `goals` of them in one search:
    the one that it reaches first comes first), so that one seed gives one plan;
    `time_limit` (CPU s, for one path) is the safety net. `resolution` (m) is the
    longest way that any point of the robot moves between two collision checks; a
    `continuous` motion check finds what touches between these as well. `range` (m) is
    the longest edge of the planner's trees, by default one of `RANGES` in turn.
    Paths keep `clearance` (m) from all that their ends are not nearer to already.
    `shortcuts` is the number of attempts at shortening a path, and `shorten` (CPU s)
    the safety net for that. `base_weight` is how much more a way of the base counts in
    a path's length than the same way of the arm.
    With `torque` motions keep within the limits of the arm's torques.
    """

    name: str = "RRTConnect"
    iterations: int = 5_000
    candidates: int = 10
    goals: int = 1
    time_limit: float = 10.0
    resolution: float = 0.01
    clearance: float = 0.002
    shortcuts: int = 100
    shorten: float = 10.0
    base_weight: float = 1.0
    torque: bool = False
    range: float | None = None
    motion_check: Literal["sampled", "continuous"] = "sampled"

    @property
    def longest_edge(self) -> float:
        """The longest edge that the planner's trees ever have, m."""
        return max(RANGES) if self.range is None else self.range


@dataclass(frozen=True, eq=False)
class Problem:
    """A robot, a scene and what is to be moved where."""

    name: str
    robot: Robot
    q_start: Array  # (nq,)
    base_bounds: Array  # (base joints, 2): where the base may go, m and rad
    obstacles: tuple[Obstacle, ...]
    objects: tuple[Object, ...]
    tasks: tuple[Task, ...]
    score: ScoreSettings = ScoreSettings()
    optimizer: OptimizerSettings = OptimizerSettings()
    planner: PlannerSettings = PlannerSettings()
    forbidden: tuple[Zone, ...] = ()  # where no part of the base's circle may be
    path: Path | None = None  # the scene file
    fingerprint: str = ""  # SHA-256 over the scene and all files that it uses

    @property
    def base_stands(self) -> bool:
        """Whether the base cannot move at all."""
        return bool((self.base_bounds[:, 0] == self.base_bounds[:, 1]).all())

    def object(self, name: str) -> Object:
        """The object of that name."""
        return next(o for o in self.objects if o.name == name)
