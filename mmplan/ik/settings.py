"""Settings of solvers, as robot.yaml gives them: names and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from difflib import get_close_matches

from mmplan.exceptions import InputError


@dataclass(frozen=True)
class IkSettings:
    """What can be set about the solvers for any arm.

    For an arm of more than six joints `samples` values of its locked joint are tried,
    each at `lift_samples` values of every joint before that (a torso lift), and at
    most `solutions` solutions of a pose returned. Iteration makes `seeds` starts of at
    most `steps` steps for a pose, out of a table of `table` configurations.
    """

    samples: int = 48
    lift_samples: int = 3
    solutions: int = 32
    seeds: int = 16
    steps: int = 40
    table: int = 4096


def ik_settings(given: Mapping[str, float]) -> IkSettings:
    """The settings of robot.yaml, checked; what is not given keeps its default.

    Raises:
        InputError: A name is not known, or a value is not a whole number above 0.
    """
    names = [field.name for field in fields(IkSettings)]
    for name, value in given.items():
        if name not in names:
            close = get_close_matches(name, names, n=1)
            hint = f"did you mean '{close[0]}'?" if close else f"not in {names}"
            raise InputError(f"ik.{name}: unknown setting; {hint}")
        if value != int(value) or value < 1:
            raise InputError(f"ik.{name}: {value:g} is not a whole number above 0")
    settings = IkSettings(**{name: int(value) for name, value in given.items()})
    if settings.seeds > settings.table:
        raise InputError(
            f"ik.seeds: {settings.seeds} cannot be more than table: {settings.table}"
        )
    return settings
