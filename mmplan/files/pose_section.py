"""Poses in files: xyz with rpy or quat."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import AfterValidator, model_validator
from typing_extensions import Self

from mmplan.files.section import Metres, Radians, Section, fault

NORM_TOLERANCE = 1e-3  # of a quaternion that is only rounded


def _nearly_unit(
    quat: tuple[float, float, float, float],
) -> tuple[float, float, float, float]:
    norm = math.hypot(*quat)
    if abs(norm - 1.0) > NORM_TOLERANCE:
        raise fault(f"a unit quaternion [x, y, z, w] has norm 1, this one {norm:.4g}")
    x, y, z, w = (value / norm for value in quat)
    return (x, y, z, w)


Quaternion = Annotated[tuple[float, float, float, float], AfterValidator(_nearly_unit)]


class PoseSection(Section):
    """A pose: where a frame stands and how it is turned; nothing given is identity."""

    xyz: tuple[Metres, Metres, Metres] = (0.0, 0.0, 0.0)
    """Position x, y, z, m; z is up."""
    rpy: tuple[Radians, Radians, Radians] | None = None
    """Turn about the fixed axes x, then y, then z, rad."""
    quat: Quaternion | None = None
    """Turn as a unit quaternion [x, y, z, w], instead of rpy."""

    @model_validator(mode="after")
    def _one_rotation(self) -> Self:
        if self.rpy is not None and self.quat is not None:
            raise fault("rpy and quat are both given; keep one")
        return self
