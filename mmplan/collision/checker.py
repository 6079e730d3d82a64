"""Collision checks of many configurations at once, and of whole motions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.assembly import Assembly
from mmplan.collision.broadphase import Broadphase
from mmplan.collision.clear_cells import clear_cells, clear_cells_made
from mmplan.collision.compiling import compiled_broadphase
from mmplan.collision.pairs import CERTAIN, Stretch, Suspects
from mmplan.collision.planner_space import PlannerSpace
from mmplan.collision.requests import PROVABLE, make_exact
from mmplan.robot import Robot
from mmplan.shapes import Array

if TYPE_CHECKING:
    from mmplan.collision.compiled_broadphase import CompiledBroadphase
    from mmplan.collision.compiled_space import CompiledSpace

# A pair of the robot's own bodies that was apart so often gets a table, see
# `clear_cells`.
_OFTEN = 200
# So many configurations are looked at one by one.
_FEW = 8
# Most motions that collide do so at one of these places.
_PLACES = np.array([[1.0], [0.5], [0.25], [0.75]])
# Pairs that come so near to what is allowed that nothing is settled within a stretch
# on which they move no farther than this count as colliding, m.
_SMALLEST = 1e-5


class Checker:
    """Checks the pairs of one geometry model: bounds first, what is left in coal.

    Pinocchio's functions do not see later changes of a geometry model, so a checker is
    made once the model is final.
    """

    def __init__(self, robot: Robot, assembly: Assembly) -> None:
        """Prepare the checks."""
        self._robot = robot
        self._model = model = robot.model
        self._pairs = assembly.pairs
        self._allowed_depth = assembly.allowed_depth.tolist()
        self._geometry = assembly.geometry
        self._data = model.createData()
        self._geometry_data = self._geometry.createData()
        make_exact(self._geometry_data, assembly.allowed_depth)
        joints = {assembly.bodies[i].joint for i in assembly.pairs.ravel().tolist()}
        self._moving = sorted(joints - {0})
        self._bounded = (
            model,
            self._geometry,
            assembly.bodies,
            assembly.pairs,
            assembly.allowed_depth,
        )
        self._broadphase = Broadphase(*self._bounded)
        self._compiled: CompiledBroadphase | None = None
        # How often each pair of the robot's own bodies was apart; others never count.
        own = (assembly.pairs < robot.geometry.ngeoms).all(axis=1)
        self._apart = np.where(own, 0, np.iinfo(np.int64).min).tolist()

    @property
    def _motions(self) -> Broadphase | CompiledBroadphase:
        """The broadphase for motions: compiled where that pays."""
        if self._compiled is None:
            kind = compiled_broadphase()
            if kind is None:
                return self._broadphase
            self._compiled = kind(*self._bounded)
            self._learn_what_is_known(self._compiled)
        return self._compiled

    def in_space(self, space: PlannerSpace) -> CompiledSpace | None:
        """Compiled answers to questions in a planner's coordinates, where there are."""
        if self._compiled is None:
            return None
        return self._compiled.in_space(space, self.any_touches)

    def _learn_what_is_known(self, motions: CompiledBroadphase) -> None:
        made = clear_cells_made(self._robot)
        for pair, (i, j) in enumerate(self._pairs.tolist() if made else ()):
            if (i, j) in made:
                motions.learn(pair, made[i, j])

    def in_collision(self, q: Array) -> npt.NDArray[np.bool_]:
        """Which of the configurations (n, nq) are in collision, (n,)."""
        hits = np.zeros(len(q), dtype=np.bool_)
        for found in self._broadphase.suspects(q):
            for row, pairs in _by_row(found, hits):
                self._place(q[row])
                hits[row] = any(map(self._collides, pairs))
        return hits

    def in_collision_at(self, T_world_joint: Array) -> npt.NDArray[np.bool_]:
        """The same from the poses (n, njoints, 4, 4) of the joints that are checked."""
        hits = np.zeros(len(T_world_joint), dtype=np.bool_)
        for found in self._broadphase.suspects_at(T_world_joint):
            for row, pairs in _by_row(found, hits):
                self._place_joints(T_world_joint[row])
                hits[row] = any(map(self._collides, pairs))
        return hits

    def any_collision(self, q: Array) -> bool:
        """Whether any of the configurations (n, nq) is in collision."""
        few = len(q) <= _FEW and self._compiled is not None
        broadphase = self._motions if few else self._broadphase
        return self.any_touches(broadphase.likeliest(q), lambda row: q[row])

    def steps_collide(self, q: Array, dq: Array, steps: int) -> bool:
        """Whether any of q + k / steps · dq (nq,), k = 1, ..., steps, collides."""
        finds = self._motions.on_steps(q, dq, steps)
        return self.any_touches(finds, lambda k: q + (k / steps) * dq)

    def any_touches(
        self, finds: Iterable[tuple[int, int]], configuration: Callable[[int], Array]
    ) -> bool:
        """Whether any of some finds collides: number of a configuration, and pair.

        `configuration` gives that of a number, (nq,).
        """
        placed = -1
        for number, pair in finds:
            if pair == CERTAIN:
                return True
            if number != placed:
                self._place(configuration(number))
                placed = number
            if self._touches(pair):
                return True
        return False

    def motion_collides(
        self, q: Array, dq: Array, *, likely_free: bool = False
    ) -> bool:
        """Whether anything collides on the way from q (nq,) to q + dq.

        Or comes so near, within `PROVABLE`, that a proof would not find an end. A few
        places are looked at first, but where the way is `likely_free`.
        """
        motions = self._motions
        if not likely_free and self.any_collision(q + _PLACES * dq):
            return True
        stretches = motions.on_the_way(q, dq)
        return bool(stretches) and not self._stay_apart(q, dq, stretches)

    def _stay_apart(self, q: Array, dq: Array, stretches: list[Stretch]) -> bool:
        """Whether pairs stay apart in stretches of a motion.

        By their distance in the middle a pair stays apart until the joints can have
        carried the bodies so far (Schwarzer, Saha, Latombe, 2005), towards each other
        where that is known; what is not settled by that is looked at in turn.
        """
        todo: list[tuple[int, float, float, float]] = [*stretches[::-1]]
        while todo:
            pair, start, end, speed = todo.pop()
            if pair == CERTAIN:
                return False
            middle = (start + end) / 2.0
            self._place(q + middle * dq)
            found = pin.computeDistance(self._geometry, self._geometry_data, pair)
            gap = found.min_distance + self._allowed_depth[pair] - PROVABLE
            if gap <= 0.0:
                return False
            self._note_apart(pair)
            if gap >= (middle - start) * speed:
                continue
            if (end - start) * speed <= _SMALLEST:
                return False
            before, after = self._motions.free_times(
                pair, q + middle * dq, dq, found.normal, gap, speed
            )
            if before < middle - start:
                todo.append((pair, start, middle - before, speed))
            if after < end - middle:
                todo.append((pair, middle + after, end, speed))
        return True

    def overlaps(self, q: Array) -> Iterator[tuple[int, float]]:
        """Pairs that collide at q (nq,): index and depth (m)."""
        self._place(q)
        for _, pair in self._broadphase.likeliest(np.asarray(q)[None]):
            if self._collides(pair):
                found = pin.computeDistance(self._geometry, self._geometry_data, pair)
                yield pair, max(0.0, -float(found.min_distance))

    def _place(self, q: Array) -> None:
        pin.updateGeometryPlacements(
            self._model, self._data, self._geometry, self._geometry_data, q
        )

    def _place_joints(self, T_world_joint: Array) -> None:
        for joint in self._moving:
            self._data.oMi[joint] = pin.SE3(T_world_joint[joint])
        pin.updateGeometryPlacements(
            self._model, self._data, self._geometry, self._geometry_data
        )

    def _collides(self, pair: int) -> bool:
        return bool(pin.computeCollision(self._geometry, self._geometry_data, pair))

    def _touches(self, pair: int) -> bool:
        """The same, and what is apart is remembered."""
        hit = self._collides(pair)
        if not hit:
            self._note_apart(pair)
        return hit

    def _note_apart(self, pair: int) -> None:
        """Look closer at pairs that need to be looked at often and never touch."""
        self._apart[pair] += 1
        if self._apart[pair] == _OFTEN and self._compiled is not None:
            known = clear_cells(self._robot, *self._pairs[pair].tolist())
            if known is not None:
                self._compiled.learn(pair, known)


def _by_row(
    found: Suspects, hits: npt.NDArray[np.bool_]
) -> Iterator[tuple[int, list[int]]]:
    """Rows that are not hit yet, each with its pairs."""
    left = ~hits[found.row]
    rows, pairs = found.row[left], found.pair[left].tolist()
    start = np.flatnonzero(np.diff(rows, prepend=-1))
    ends = np.append(start, len(rows))[1:].tolist()
    for row, i, j in zip(rows[start].tolist(), start.tolist(), ends, strict=True):
        yield row, pairs[i:j]
