"""The score of a base placement and a grasp (paper, section IV.A): one term a file."""

from mmplan.scoring.breakdown import Breakdown, LinkClutter
from mmplan.scoring.feasibility import Arms, Overlap
from mmplan.scoring.outcome import End, Outcome
from mmplan.scoring.score import TERMS, ScoreFunction, Scores
from mmplan.scoring.term import Grasped, ScoreTerm

__all__ = [
    "TERMS",
    "Arms",
    "Breakdown",
    "End",
    "Grasped",
    "LinkClutter",
    "Outcome",
    "Overlap",
    "ScoreFunction",
    "ScoreTerm",
    "Scores",
]
