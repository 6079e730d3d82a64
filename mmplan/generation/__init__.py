"""Pick-and-place problems by family: drawn from a seed, kept if they can be solved."""

from mmplan.generation.acceptance import Acceptance, has_candidate, has_plan
from mmplan.generation.difficulty import Difficulty
from mmplan.generation.draft import Draft
from mmplan.generation.family import Family
from mmplan.generation.folder import Written, write_scenes
from mmplan.generation.generator import (
    FAMILIES,
    GeneratedScene,
    generate,
    require_family,
)

__all__ = [
    "FAMILIES",
    "Acceptance",
    "Difficulty",
    "Draft",
    "Family",
    "GeneratedScene",
    "Written",
    "generate",
    "has_candidate",
    "has_plan",
    "require_family",
    "write_scenes",
]
