"""The solids of everything in a scene but the robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mmplan.collision.meshes import hulls
from mmplan.collision.solids import Solid, geometries, solids_of_obstacle
from mmplan.problem import Object, Problem
from mmplan.shapes import Array, Mesh

# A larger mesh to be carried is in other units than metres, m.
LARGEST_CARRIED = 3.0


@dataclass(frozen=True, eq=False)
class Scenery:
    """Obstacles in the world's frame, objects in their own; built once for a problem.

    `grounds` names the obstacles that the base drives on.
    """

    obstacles: tuple[Solid, ...]
    grounds: frozenset[str]
    objects: Mapping[str, tuple[Solid, ...]]

    @classmethod
    def of_problem(cls, problem: Problem) -> Scenery:
        """The solids of the problem's obstacles and objects."""
        solids = [s for o in problem.obstacles for s in solids_of_obstacle(o)]
        return cls(
            obstacles=tuple(solids),
            grounds=frozenset(o.name for o in problem.obstacles if o.ground),
            objects={o.name: cls.solids_of_object(o) for o in problem.objects},
        )

    @staticmethod
    def solids_of_object(item: Object) -> tuple[Solid, ...]:
        """The solids of an object in its own frame.

        Raises:
            InputError: Its mesh cannot be used.
        """
        if isinstance(item.shape, Mesh):
            solids = hulls(item.shape, LARGEST_CARRIED)
        else:
            solids = geometries(item.shape)
        return tuple(Solid(item.name, solid, np.eye(4)) for solid in solids)

    def is_ground(self, owner: str) -> bool:
        """Whether the base drives on this obstacle (or fixture's link)."""
        return owner.partition("/")[0] in self.grounds

    def centre_of_mass(self, name: str) -> Array:
        """The centre of mass (3,) of an object of even density, in its own frame."""
        return centre_of_mass(self.objects[name])


def centre_of_mass(solids: tuple[Solid, ...]) -> Array:
    """The centre of mass (3,) of an object's solids, of even density."""
    volumes = np.array([s.geometry.computeVolume() for s in solids])
    centres = [s.geometry.computeCOM() for s in solids]
    return np.average([np.ravel(c) for c in centres], axis=0, weights=volumes)
