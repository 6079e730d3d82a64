"""The collision world: a robot among obstacles and objects, and what may touch what."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.carry import Region
from mmplan.collision.assembly import Assembly, Body, Clearance, TouchRules, assemble
from mmplan.collision.checker import Checker
from mmplan.collision.planner_space import PlannerSpace
from mmplan.collision.scenery import Scenery
from mmplan.problem import Problem
from mmplan.robot import Robot
from mmplan.shapes import Array, read_only

if TYPE_CHECKING:
    from mmplan.collision.compiled_space import CompiledSpace

# How deep an object may press into what it stands on, m.
TOUCH_TOLERANCE = 0.001
# An object touches its support only this near the pose at which it rests, m.
CONTACT_ZONE = 0.01


class Contact(NamedTuple):
    """Two things that overlap, by name, and how deep (m)."""

    first: str
    second: str
    depth: float


@dataclass(frozen=True, eq=False)
class CollisionWorld:
    """Robot, obstacles, and every object either standing or carried by the tool.

    Worlds are values: `place`, `attach` and `permit_touch` return another world.
    Every pair of bodies that do not move rigidly together must stay apart, except the
    robot's own disabled pairs, base and ground, obstacles among themselves, the finger
    links and an object that they may touch, and, down to a stated depth, an object
    and what it stands on. What is carried must keep out of the `regions` as well.
    """

    robot: Robot
    scenery: Scenery
    standing: Mapping[str, Array]  # object -> T_world_object
    attached: Mapping[str, Array] = field(default_factory=dict)  # -> T_tool_object
    touch: TouchRules = field(default_factory=TouchRules)
    pair_filter: Callable[[Body, Body], bool] | None = None
    clearance: Clearance = field(default_factory=Clearance)
    regions: tuple[Region, ...] = ()

    @classmethod
    def of_problem(cls, problem: Problem) -> CollisionWorld:
        """The world before the first task."""
        return cls(
            robot=problem.robot,
            scenery=Scenery.of_problem(problem),
            standing={o.name: o.T_world_object for o in problem.objects},
        )

    def place(self, name: str, T_world_object: Array) -> CollisionWorld:
        """The world with an object standing at a pose, its touch rules forgotten."""
        attached = {k: v for k, v in self.attached.items() if k != name}
        standing = {**self.standing, name: read_only(T_world_object)}
        return replace(self.forbid_touch(name), attached=attached, standing=standing)

    def attach(self, name: str, T_tool_object: Array) -> CollisionWorld:
        """The world with an object carried by the tool and touched by the fingers."""
        attached = {**self.attached, name: read_only(T_tool_object)}
        standing = {k: v for k, v in self.standing.items() if k != name}
        world = replace(self.forbid_touch(name), attached=attached, standing=standing)
        return world.permit_touch(name, fingers=True)

    def forbidding(self, regions: tuple[Region, ...]) -> CollisionWorld:
        """The world in which what is carried must keep out of some regions."""
        return replace(self, regions=regions) if regions else self

    def without(self, name: str) -> CollisionWorld:
        """The world with an object taken out of it."""
        standing = {k: v for k, v in self.standing.items() if k != name}
        attached = {k: v for k, v in self.attached.items() if k != name}
        return replace(self.forbid_touch(name), attached=attached, standing=standing)

    def permit_touch(
        self,
        name: str,
        *,
        fingers: bool = False,
        supports: Mapping[str, float] = MappingProxyType({}),
    ) -> CollisionWorld:
        """The world in which an object may touch the fingers and its supports.

        `supports` maps names of obstacles to the depth (m) that is let pass.
        """
        touched = self.touch.fingers | ({name} if fingers else frozenset())
        pressed = {(name, owner): depth for owner, depth in supports.items()}
        rules = TouchRules(touched, {**self.touch.supports, **pressed})
        return replace(self, touch=rules)

    def forbid_touch(self, name: str) -> CollisionWorld:
        """The world in which an object may touch nothing."""
        supports = {k: v for k, v in self.touch.supports.items() if k[0] != name}
        return replace(self, touch=TouchRules(self.touch.fingers - {name}, supports))

    def base_alone(self) -> CollisionWorld:
        """The world in which arm, hand and what they carry are left out."""
        return self._checking(_spare_the_arm)

    def fingers_alone(self) -> CollisionWorld:
        """The world in which only pairs with a finger link are checked."""
        return self._checking(_with_a_finger)

    def hand_in_scene(self) -> CollisionWorld:
        """The world in which only the hand is checked, against what does not move.

        The hand is the fingers and all that does not move against the tool.
        """
        return self._checking(self._is_hand_in_scene)

    def except_hand_in_scene(self) -> CollisionWorld:
        """The world in which all is checked but for what `hand_in_scene` checks."""
        return self._checking(lambda *pair: not self._is_hand_in_scene(*pair))

    def _is_hand_in_scene(self, first: Body, second: Body) -> bool:
        with_tool = (
            body.kind == "finger" or body.joint == self.robot.tool_joint
            for body in (first, second)
        )
        return any(with_tool) and 0 in (first.joint, second.joint)

    def _checking(self, rule: Callable[[Body, Body], bool]) -> CollisionWorld:
        """The world in which only pairs that obey a rule are checked, of those now."""
        now = self.pair_filter
        if now is None:
            return replace(self, pair_filter=rule)
        return replace(self, pair_filter=lambda *pair: now(*pair) and rule(*pair))

    def keeping(self, clearance: float, *ends: Array) -> CollisionWorld:
        """The world in which a distance (m) below `clearance` counts as collision.

        Except for the robot's links among themselves, for permitted touches, and for
        what is nearer than that already at one of the configurations `ends` (nq,).
        """
        world = replace(self, clearance=Clearance(clearance))
        close = {frozenset(c[:2]) for q in ends for c in world.contacts(q)}
        if not close:
            return world
        return replace(self, clearance=Clearance(clearance, frozenset(close)))

    @property
    def model(self) -> pin.Model:
        """The robot's kinematic model."""
        return self.robot.model

    @property
    def geometry(self) -> pin.GeometryModel:
        """Every body of this world and the pairs that must stay apart."""
        return self._assembly.geometry

    @property
    def bodies(self) -> tuple[Body, ...]:
        """What each geometry of `geometry` belongs to, in its order."""
        return self._assembly.bodies

    @property
    def pairs(self) -> npt.NDArray[np.int64]:
        """The pairs that must stay apart, (p, 2) indices into `bodies`."""
        return self._assembly.pairs

    @property
    def allowed_depth(self) -> Array:
        """How deep (m) the two bodies of each pair may overlap, (p,).

        Negative where they must keep a distance.
        """
        return self._assembly.allowed_depth

    def owner_of(self, index: int) -> str:
        """The name of the link, obstacle or object that a geometry belongs to."""
        return self.bodies[index].owner

    def in_collision(self, q: Array) -> npt.NDArray[np.bool_]:
        """Which of the configurations (n, nq) are in collision, (n,)."""
        return self._checker.in_collision(q)

    def in_collision_at(self, T_world_joint: Array) -> npt.NDArray[np.bool_]:
        """The same from the poses (n, njoints, 4, 4) of all joints that are checked."""
        return self._checker.in_collision_at(T_world_joint)

    def any_collision(self, q: Array) -> bool:
        """Whether any of the configurations (n, nq) is in collision."""
        return self._checker.any_collision(q)

    def steps_collide(self, q: Array, dq: Array, steps: int) -> bool:
        """Whether any of q + k / steps · dq (nq,), k = 1, ..., steps, collides."""
        return self._checker.steps_collide(q, dq, steps)

    def motion_collides(
        self, q: Array, dq: Array, *, likely_free: bool = False
    ) -> bool:
        """Whether anything collides anywhere on the way from q (nq,) to q + dq.

        If the way is `likely_free`, that is told sooner, and that it is not, later.
        """
        return self._checker.motion_collides(q, dq, likely_free=likely_free)

    def in_space(self, space: PlannerSpace) -> CompiledSpace | None:
        """Quick answers to questions in a planner's coordinates, where there are."""
        return self._checker.in_space(space)

    def contacts(self, q: Array) -> tuple[Contact, ...]:
        """What overlaps more than it may at one configuration (nq,), deepest first."""
        depths: dict[tuple[str, str], float] = {}
        for pair, depth in self._checker.overlaps(q):
            first, second = (self.owner_of(i) for i in self.pairs[pair])
            key = (first, second)
            depths[key] = max(depth, depths.get(key, 0.0))
        contacts = [Contact(*key, depth) for key, depth in depths.items()]
        return tuple(sorted(contacts, key=lambda c: (-c.depth, c.first, c.second)))

    def object_pose(self, name: str, q: Array) -> Array:
        """The pose T_world_object (4, 4) of an object when the robot is at q (nq,)."""
        if name in self.standing:
            return self.standing[name]
        return self.robot.tool_pose(q) @ self.attached[name]

    @cached_property
    def _assembly(self) -> Assembly:
        return assemble(
            self.robot,
            self.scenery,
            self.standing,
            self.attached,
            self.touch,
            self.pair_filter,
            self.clearance,
            self.regions,
        )

    @cached_property
    def _checker(self) -> Checker:
        return Checker(self.robot, self._assembly)


def _spare_the_arm(first: Body, second: Body) -> bool:
    return not {first.kind, second.kind} & {"arm", "finger", "attached"}


def _with_a_finger(first: Body, second: Body) -> bool:
    return "finger" in (first.kind, second.kind)
