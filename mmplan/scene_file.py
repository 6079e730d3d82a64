"""scene.yaml -> `Problem`, with every fault of the scene and the files it names."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mmplan.scene_reader import read_scene

if TYPE_CHECKING:
    from mmplan.problem import Problem


def load_problem(name: str | Path) -> Problem:
    """Read a scene file into a problem.

    Args:
        name: The path of a scene file, or the bare name of a scene that is shipped.

    Raises:
        InputError: With every fault of the scene and the files that it names.
    """
    scene = read_scene(name)

    # Only a scene that is well formed is worth the time that these take to import.
    from mmplan.problem_checks import check_geometry
    from mmplan.scene_build import build_problem

    problem = build_problem(scene)
    check_geometry(problem, scene.document)
    return problem
