"""Why a problem has no solution, or how hard it is, and what would change that."""

from mmplan.explanation.causes import Cause
from mmplan.explanation.explaining import Explanation, explain, single_tasks
from mmplan.explanation.funnel import Stage
from mmplan.explanation.near_miss import NearMiss
from mmplan.explanation.relaxations import Relaxation
from mmplan.explanation.report import explanation_json, explanation_lines

__all__ = [
    "Cause",
    "Explanation",
    "NearMiss",
    "Relaxation",
    "Stage",
    "explain",
    "explanation_json",
    "explanation_lines",
    "single_tasks",
]
