"""Settings of a scene: score, optimizer, planner; the defaults are the problem's."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator
from typing_extensions import Self

from mmplan.files.section import Positive, Section, fault
from mmplan.problem import OptimizerSettings, PlannerSettings, ScoreSettings

Share = Annotated[float, Field(ge=0.0, le=1.0)]
Weight = Annotated[float, Field(ge=0.0, le=1e6)]
Count = Annotated[int, Field(ge=1, le=10**9)]

QualityName = Literal["family", "epsilon", "volume"]
OptimizerName = Literal[
    "coevolution",
    "random",
    "blockwise",
    "cmaes",
    "differential_evolution",
    "nevergrad",
]
MotionCheck = Literal["sampled", "continuous"]
PlannerName = Literal[
    "AORRTC",
    "BFMT",
    "BKPIECE1",
    "FMT",
    "InformedRRTstar",
    "KPIECE1",
    "LBKPIECE1",
    "PRM",
    "PRMstar",
    "RRT",
    "RRTConnect",
    "RRTstar",
    "SORRTstar",
]


class ScoreSection(Section):
    """Weights of the score's terms, and the quality that a grasp must have."""

    grasp: Weight = ScoreSettings.grasp
    """Weight of the grasp quality."""
    manipulability: Weight = ScoreSettings.manipulability
    """Weight of the arm's manipulability at the tool."""
    clutter: Weight = ScoreSettings.clutter
    """Weight of the distances between the robot's links and the obstacles."""
    min_quality: Share = ScoreSettings.min_quality
    """Grasp quality from 0 to 1 below which a candidate scores 0."""
    quality: QualityName = "family"
    """Measure of grasp quality: family, or of the wrenches: epsilon or volume."""

    joint_margin: Weight = ScoreSettings.joint_margin
    """Weight of the distance between the arm's joints and their limits."""

    @model_validator(mode="after")
    def _some_weight(self) -> Self:
        weights = (self.grasp, self.manipulability, self.clutter, self.joint_margin)
        if sum(weights) == 0.0:
            raise fault(
                "one of grasp, manipulability, clutter, joint_margin must be above 0"
            )
        return self

    def settings(self) -> ScoreSettings:
        """The problem's value."""
        return ScoreSettings(**self.model_dump())


class OptimizerSection(Section):
    """What chooses the grasp and both base placements."""

    name: OptimizerName = "coevolution"
    """coevolution (of the paper), random (its baseline), blockwise, or a library's."""
    evaluations: Count = OptimizerSettings.evaluations
    """Budget: evaluations of the score."""
    bases: Annotated[int, Field(ge=4, le=10**6)] = OptimizerSettings.bases
    """Size of either population of base placements."""
    grasps: Annotated[int, Field(ge=4, le=10**6)] = OptimizerSettings.grasps
    """Size of the population of grasps."""
    partners: Count = OptimizerSettings.partners
    """How many of the others' fittest decide a member's fitness; the paper's k."""
    mutation: Share = OptimizerSettings.mutation
    """Probability that a gene of a child is changed."""

    @model_validator(mode="after")
    def _enough_partners(self) -> Self:
        most = min(self.bases, self.grasps)
        if self.partners > most:
            raise fault(f"partners must be at most {most}, the smallest population")
        return self

    def settings(self) -> OptimizerSettings:
        """The problem's value."""
        return OptimizerSettings(**self.model_dump())


def _fine(resolution: float) -> float:
    if resolution > 1.0:
        raise fault(f"must be at most 1 m, got {resolution:g}")
    return resolution


class PlannerSection(Section):
    """What finds the motion between the configurations chosen."""

    name: PlannerName = "RRTConnect"
    """A geometric planner of OMPL."""
    iterations: Count = PlannerSettings.iterations
    """Iterations of the planner for one path before it gives up."""
    candidates: Count = PlannerSettings.candidates
    """How many distinct results of the optimizer are tried."""
    goals: Count = PlannerSettings.goals
    """How many of these are goals of one search; the first reached comes first."""
    time_limit: Positive = PlannerSettings.time_limit
    """Safety net for one path, CPU s; a plan that depends on it cannot be repeated."""
    resolution: Annotated[Positive, AfterValidator(_fine)] = PlannerSettings.resolution
    """Longest way of any point of the robot between two collision checks, m."""
    clearance: Annotated[float, Field(ge=0, le=1)] = PlannerSettings.clearance
    """Distance that paths keep from all that their ends keep it from, m."""
    shortcuts: Annotated[int, Field(ge=0, le=10**6)] = PlannerSettings.shortcuts
    """Attempts at shortening a path."""
    shorten: Positive = PlannerSettings.shorten
    """Safety net for shortening a path, CPU s; see time_limit."""
    base_weight: Annotated[float, Field(ge=0.01, le=100)] = PlannerSettings.base_weight
    """How much more a way of the base counts than the same way of the arm."""
    torque: bool = PlannerSettings.torque
    """Whether motions keep the effort limits of the arm, with what it carries."""
    range: Positive | None = PlannerSettings.range
    """Longest edge of the planner's trees, weighted by the joints' lever arms, m; by
    default 1.5, 0.4 and 0.1 in turn."""
    motion_check: MotionCheck = PlannerSettings.motion_check
    """sampled: at the resolution alone; continuous: between two checks as well."""

    def settings(self) -> PlannerSettings:
        """The problem's value."""
        return PlannerSettings(**self.model_dump())
