"""Plan files with their scenes, as several commands take them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mmplan.exceptions import InputError

if TYPE_CHECKING:
    from mmplan.plan import Plan
    from mmplan.problem import Problem


def load_plan(path: Path, scene: str | None) -> tuple[Plan, Problem]:
    """A plan and the problem that it solves.

    `scene` says where the scene is, if not where the plan says.

    Raises:
        InputError: Either cannot be read, or the scene is not there.
    """
    from mmplan.plan import Plan
    from mmplan.scene_file import load_problem

    plan = Plan.load(path)
    found = scene if scene is not None else plan.path
    if found is None or (scene is None and not Path(found).is_file()):
        raise InputError(
            f"{path}: its scene '{found or plan.scene}' is not there; give it with "
            "--scene"
        )
    return plan, load_problem(found)
