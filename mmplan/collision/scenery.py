"""The solids of everything in a scene but the robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
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

    @cached_property
    def obstacle_bounds(self) -> Bounds:
        """The axis-aligned boxes (n, 3) about the obstacles, in the world."""
        return world_bounds(self.obstacles, np.eye(4))

    def is_ground(self, owner: str) -> bool:
        """Whether the base drives on this obstacle (or fixture's link)."""
        return owner.partition("/")[0] in self.grounds

    def centre_of_mass(self, name: str) -> Array:
        """The centre of mass (3,) of an object of even density, in its own frame."""
        return centre_of_mass(self.objects[name])


def world_bounds(solids: Sequence[Solid], T_world_owner: Array) -> Bounds:
    """The axis-aligned boxes (n, 3) about an owner's solids, in the world."""
    local = [local_bounds(s.geometry) for s in solids]
    stacked = Bounds(
        np.array([b.centre for b in local]).reshape(-1, 3),
        np.array([b.half for b in local]).reshape(-1, 3),
    )
    placements = np.array([s.placement for s in solids]).reshape(-1, 4, 4)
    return moved_bounds(stacked, T_world_owner @ placements)


def centre_of_mass(solids: tuple[Solid, ...]) -> Array:
    """The centre of mass (3,) of an object's solids, of even density."""
    volumes = np.array([s.geometry.computeVolume() for s in solids])
    centres = [s.geometry.computeCOM() for s in solids]
    return np.average([np.ravel(c) for c in centres], axis=0, weights=volumes)
