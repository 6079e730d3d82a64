"""OMPL's geometric planners, by name."""

from __future__ import annotations

from functools import cache

from ompl import base as ob
from ompl import geometric as og

from mmplan.exceptions import InputError
from mmplan.files.suggestions import unknown
from mmplan.problem import PlannerSettings

# BITstar never frees its space information after a search that finds nothing, which
# the bindings then lament on stderr when the process ends.
_LEAKING = frozenset({"BITstar"})

# The first three sample ellipsoids and the others project states, both of which OMPL
# does in real spaces alone.
_WITHOUT_CIRCLES = frozenset(
    {"AORRTC", "InformedRRTstar", "SORRTstar", "BKPIECE1", "KPIECE1", "LBKPIECE1"}
)


@cache
def available_planners(*, circles: bool = False) -> tuple[str, ...]:
    """The names that `make_planner` knows.

    With `circles` only those that can plan for joints that turn without end.
    """
    return tuple(
        name
        for name, value in sorted(vars(og).items())
        if isinstance(value, type) and issubclass(value, ob.Planner)
        if name not in _LEAKING and not (circles and name in _WITHOUT_CIRCLES)
    )


def require_planner(name: str, *, circles: bool = False) -> None:
    """Refuse a name that no planner has, or none that can do with circles.

    Raises:
        InputError: naming what there is.
    """
    if name not in available_planners():
        raise InputError(unknown("planner", name, available_planners()))
    able = available_planners(circles=circles)
    if name not in able:
        raise InputError(
            f"planner '{name}' cannot plan for joints that turn without end; these "
            f"can: {', '.join(able)}"
        )


def make_planner(settings: PlannerSettings, si: ob.SpaceInformation) -> ob.Planner:
    """The planner that the settings name, its longest edge set where it has one.

    Raises:
        InputError: if there is none of that name.
    """
    require_planner(settings.name)
    planner = getattr(og, settings.name)(si)
    if hasattr(planner, "setRange"):
        planner.setRange(settings.longest_edge)
    return planner
