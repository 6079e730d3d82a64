"""The wrenches that a grasp resists: their convex hull and what it says of quality."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.shapes import Array

# Below this distance of the hull from the origin a grasp does not close by force.
_NO_CLOSURE = 1e-6
# Input joggled by about 1e-10, always alike: wrenches of two pads lie in planes that
# many share, and this is twice as quick as merging facets.
_JOGGLED = "QJ"


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
        from scipy.spatial import ConvexHull

        nothing = cls(np.empty((0, 7)), 0.0, 0.0)
        if (wrenches @ wrenches.mean(axis=0)).min() > 0.0:
            return nothing  # all go one way, which is cheaper to see than by a hull
        hull = ConvexHull(wrenches, qhull_options=_JOGGLED)
        epsilon = float(-hull.equations[:, -1].max())
        if epsilon < _NO_CLOSURE:
            return nothing
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
