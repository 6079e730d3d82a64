"""From a candidate to the timed segments of a task."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import islice
from typing import NamedTuple, TypeAlias

import numpy as np

from mmplan.candidate import Candidate
from mmplan.collision import CollisionWorld
from mmplan.motion.connections import Connection, Connector
from mmplan.motion.delivery import Delivery
from mmplan.motion.parts import Blocked, BlockedError, Part
from mmplan.motion.segments import Timing
from mmplan.motion.short_motions import ShortMotions
from mmplan.motion.ways import steering_of
from mmplan.motion.zoned_world import are_alike
from mmplan.plan import Segment
from mmplan.problem import Problem, Task
from mmplan.processes import Copy, copied
from mmplan.shapes import Array

# The timed segments of a motion, or what stood in its way.
Outcome: TypeAlias = tuple[Segment, ...] | Blocked


class _Halves(NamedTuple):
    """What is known of a candidate before any way is looked for."""

    transit: Connection
    pick: list[Part]
    delivery: Delivery
    copy: Copy[Delivery] | None  # in another process, if there is one


class _Ahead(NamedTuple):
    """The second half from a configuration on, being planned by another process."""

    q_lifted: Array  # (nq,)
    answer: Callable[[], Outcome]

    def begins_at(self, q: Array) -> bool:
        """Whether it begins at a configuration (nq,), to the last bit."""
        return bool(self.q_lifted.tobytes() == q.tobytes())


@dataclass(frozen=True, eq=False)
class TaskMotion:
    """Plans the motion of one task for candidates, one by one or together.

    With two `jobs` another process plans the second half of a candidate's motion, from
    the transfer on, while this one plans the first; once a candidate has failed, the
    one after the next, while this one plans the next. What comes of it is the same.
    """

    problem: Problem
    task: Task
    world: CollisionWorld  # the object at its start
    without_lines: bool = False  # whether straight motions may be left out
    jobs: int = 1

    def plan(self, candidate: Candidate, rng: np.random.Generator) -> Outcome:
        """The segments of the whole motion, or what stood in its way."""
        delivery = self._delivery(candidate)
        with copied(delivery, self.jobs, "plans the transfer") as copy:
            try:
                halves = self._halves(delivery, copy)
            except BlockedError as error:
                return error.blocked
            return self._next({0: halves}, rng)[0]

    def plan_in_turn(
        self, candidates: Iterable[Candidate], rng: np.random.Generator
    ) -> Generator[tuple[int, Outcome]]:
        """The number of each candidate and what `plan` says of it.

        Each has random numbers of its own. Close it when no more are wanted.
        """
        todo = ((x, rng.spawn(1)[0]) for x in candidates)
        for candidate, own in islice(todo, 1):
            yield 0, self.plan(candidate, own)
        alone = replace(self, jobs=1)
        plans = [partial(alone.plan, *each) for each in todo]
        with closing(_in_pairs(plans, self.jobs)) as outcomes:
            yield from enumerate(outcomes, start=1)

    def plan_together(
        self, candidates: Sequence[Candidate], rng: np.random.Generator
    ) -> Iterator[tuple[int, Outcome]]:
        """The number of each candidate and what `plan` says of it, once that is known.

        Transits to all candidates are one search with many goals, where what is in the
        way is the same for them: which is reached first is gone on with first. Which
        that is nobody knows before: all is done by one process.
        """
        if len(candidates) == 1:
            yield 0, self.plan(candidates[0], rng)
            return
        ready: dict[int, _Halves] = {}
        for number, candidate in enumerate(candidates):
            try:
                ready[number] = self._halves(self._delivery(candidate), None)
            except BlockedError as error:  # noqa: PERF203 (each has its own)
                yield number, error.blocked
        while ready:
            found = self._next(ready, rng)
            for number in found:
                del ready[number]
            yield from found.items()

    def blocked_short(self, candidate: Candidate) -> Blocked | None:
        """What stands in the way of the short motions alone, no path being planned."""
        carrying = self._carrying(candidate)
        try:
            self._short.pick(candidate, carrying)
            self._short.place(candidate, carrying)
        except BlockedError as error:
            return error.blocked
        return None

    def _next(
        self, ready: Mapping[int, _Halves], rng: np.random.Generator
    ) -> Mapping[int, Outcome]:
        """What comes of the candidate reached first, or of all that are not reached.

        Either way has random numbers of its own, so that they can be looked for at the
        same time. The second begins ahead where the first is likely to end; if that
        ends elsewhere, on another winding of the arm, the second is looked for anew.
        """
        for_transit, for_transfer = rng.spawn(2)
        sharing = self._sharing({k: halves.transit for k, halves in ready.items()})
        first = next(iter(sharing))
        ahead = self._ahead(ready[first], for_transfer)
        try:
            number, transit, pick = self._connector.connect(
                "transit", self.world, self.problem.q_start, sharing, for_transit
            )
        except BlockedError as error:
            return dict.fromkeys(sharing, error.blocked)
        try:
            fetched = self._timing.segments([transit, *pick])
        except BlockedError as error:
            return {number: error.blocked}
        q_lifted, lifted = pick[-1].path[-1], pick[-1].moves
        if ahead is not None and number == first and ahead.begins_at(q_lifted):
            rest = _fetched(ahead.answer)
        else:
            rest = ready[number].delivery.segments(q_lifted, lifted, for_transfer)
        return {number: rest if isinstance(rest, Blocked) else fetched + rest}

    def _ahead(self, halves: _Halves, rng: np.random.Generator) -> _Ahead | None:
        """The second half from where the first is likely to end, in another process."""
        if halves.copy is None:
            return None
        turn = self._connector.likely_turn(halves.transit, self.problem.q_start)
        lift = halves.pick[-1].turned(turn)
        q_lifted = lift.path[-1]
        answer = halves.copy.ask(Delivery.segments, q_lifted, lift.moves, rng)
        return _Ahead(q_lifted, answer)

    def _sharing(self, ways: dict[int, Connection]) -> dict[int, Connection]:
        """The first way and those that one search can look for together with it."""
        first = next(iter(ways))
        if steering_of(self.problem) is not None:
            return {first: ways[first]}
        world = ways[first].world
        return {k: way for k, way in ways.items() if are_alike(way.world, world)}

    def _halves(self, delivery: Delivery, copy: Copy[Delivery] | None) -> _Halves:
        """The short motions, planned first as they fail soonest.

        Raises:
            BlockedError: One of them is not free, or the arm is too weak.
        """
        blocked_place = delivery.blocked_place
        if copy is not None:
            blocked_place = copy.ask(Delivery.blocked_place)
        pick = self._short.pick(delivery.candidate, delivery.carrying)
        self._timing.require_strength(pick[-1])
        blocked = blocked_place()
        if blocked is not None:
            raise BlockedError(blocked.segment, blocked.message)
        q_start = self.problem.q_start
        transit = self._connector.connection(self.world, q_start, pick)
        return _Halves(transit, pick, delivery, copy)

    def _delivery(self, candidate: Candidate) -> Delivery:
        carrying = self._carrying(candidate)
        return Delivery(candidate, self._short, self._connector, self._timing, carrying)

    def _carrying(self, candidate: Candidate) -> CollisionWorld:
        """The world with the object in the hand."""
        world = self.world.attach(self.task.object, candidate.T_tool_object)
        return world.forbidding(self.task.carry.forbidden)

    @cached_property
    def _short(self) -> ShortMotions:
        return ShortMotions(self.problem, self.task, self.world, self.without_lines)

    @cached_property
    def _connector(self) -> Connector:
        return Connector(self.problem, self.task)

    @cached_property
    def _timing(self) -> Timing:
        return Timing(self.problem, self.task, self.world)


def _in_pairs(plans: Sequence[Callable[[], Outcome]], jobs: int) -> Generator[Outcome]:
    """What comes of plans; with two jobs another process makes every second one."""
    jobs = min(jobs, len(plans))
    with copied(plans, jobs, "plans every second candidate") as copy:
        for k in range(0, len(plans), 2):
            pair = [*plans[k : k + 2]]
            if copy is not None and len(pair) == 2:
                pair[1] = partial(_fetched, copy.ask(_made, k + 1))
            for plan in pair:
                yield plan()


def _made(plans: Sequence[Callable[[], Outcome]], k: int) -> Outcome:
    return plans[k]()


def _fetched(answer: Callable[[], Outcome]) -> Outcome:
    """What has come of it in another process; arrays are read-only again."""
    outcome = answer()
    for segment in () if isinstance(outcome, Blocked) else outcome:
        for array in (segment.times, segment.positions, segment.velocities):
            array.setflags(write=False)
    return outcome
