"""Mass, centre and inertia of objects of even density."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mmplan.collision.solids import Solid


def inertia_of(solids: tuple[Solid, ...], mass: float) -> pin.Inertia:
    """The inertia of an object of a mass (kg) in its own frame."""
    volume = sum(float(solid.geometry.computeVolume()) for solid in solids)
    total = pin.Inertia.Zero()
    for solid in solids:
        body, density = solid.geometry, mass / volume
        own = pin.Inertia(
            density * float(body.computeVolume()),
            np.ravel(body.computeCOM()),
            density * body.computeMomentofInertiaRelatedToCOM(),
        )
        total += pin.SE3(solid.placement).act(own)
    return total
