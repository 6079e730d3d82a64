"""What a user says of a robot that is imported."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mmplan.robot_setup.evidence import SAMPLES
from mmplan.robot_setup.pieces import TIGHT


@dataclass(frozen=True)
class Wishes:
    """What the user says of a robot that is imported.

    `hand` are names of joints, or the path of a hand's URDF that is fixed to the tip.
    `pedestal` is the radius and height (m) of a cylinder that the URDF's root stands
    on; None: as it seems right.
    """

    base: str
    tip: str
    name: str
    arm: tuple[str, ...] = ()
    hand: tuple[str, ...] | Path = ()
    srdf: Path | None = None
    package_dirs: tuple[Path, ...] = ()
    pedestal: tuple[float, float] | None = None
    tight: float = TIGHT
    samples: int = SAMPLES
