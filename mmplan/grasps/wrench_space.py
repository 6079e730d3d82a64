"""The wrenches that a grasp resists: their convex hull and what it says of quality."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.shapes import Array

# Below this distance of the hull from the origin a grasp does not close by force.
_NO_CLOSURE = 1e-6
# Exact and quick where no facets must be merged; else input joggled by about 1e-10,
# always alike, which is twice as quick as merging.
_EXACT, _JOGGLED = "Q0", "QJ"


@dataclass(frozen=True, eq=False)
class WrenchSpace:
    """The convex hull of contact wrenches whose normal forces add up to 1.

    `epsilon` is the least wrench, in any direction, that breaks the grasp: the radius
    of the largest ball about the origin in the hull (Ferrari and Canny 1992); 0 where
    the grasp does not close by force. `volume` is that of the hull, 0 likewise.
    """

    facets: (
        Array  # (f, 7), outward normals and offsets; normal @ w + offset <= 0 inside
    )
    epsilon: float
    volume: float

    @classmethod
    def of_wrenches(cls, wrenches: Array) -> WrenchSpace:
        """The space that wrenches (w, 6) span, at least 7 of them."""
        from scipy.spatial import ConvexHull, QhullError

        try:
            hull = ConvexHull(wrenches, qhull_options=_EXACT)
        except QhullError:
            hull = ConvexHull(wrenches, qhull_options=_JOGGLED)
        epsilon = float(-hull.equations[:, -1].max())
        if epsilon < _NO_CLOSURE:
            return cls(np.empty((0, 7)), 0.0, 0.0)
        return cls(hull.equations, epsilon, float(hull.volume))

    @property
    def closes(self) -> bool:
        """Whether the grasp closes by force: resists wrenches in every direction."""
        return self.epsilon > 0.0

    def margin(self, wrenches: Array) -> float:
        """How many times the worst of some wrenches (w, 6) the hull contains."""
        if not self.closes:
            return 0.0
        strain = self.facets[:, :6] @ wrenches.T / -self.facets[:, 6:]
        worst = float(strain.max())
        return np.inf if worst <= 0.0 else 1.0 / worst
