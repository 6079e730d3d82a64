"""Whole motions: both broadphases, sampled and continuous, tell the same."""

from __future__ import annotations

from functools import cache

import coal
import numpy as np
import pinocchio as pin
import pytest

from mmplan.collision import CollisionWorld, compile_motions
from mmplan.collision.checker import Checker
from mmplan.collision.clear_cells import clear_cells
from mmplan.collision.compiled_broadphase import CompiledBroadphase
from mmplan.collision.pairs import CERTAIN
from mmplan.collision.requests import PROVABLE
from mmplan.problem import Obstacle
from mmplan.robot_build import load_robot
from mmplan.shapes import Array, Box
from tests.collision.worlds import among, carrying, draw, q_tucked
from tests.honest import shift

WORLDS = [(n, w) for n in ("wineglass", "plate") for w in ("standing", "attached")]
EDGES, STEPS = 60, 12

everywhere = pytest.mark.parametrize(("name", "where"), WORLDS)


@cache
def checkers(name: str, where: str) -> tuple[Checker, Checker]:
    """A checker with the compiled broadphase, and one with that in numpy."""
    plain = checker_of(carrying(name, where))
    plain._compiled = plain._broadphase  # type: ignore[assignment]
    return compiled_checker(carrying(name, where)), plain


def checker_of(world: CollisionWorld) -> Checker:
    return Checker(world.robot, world._assembly)


def compiled_checker(world: CollisionWorld) -> Checker:
    compile_motions()
    checker = checker_of(world)
    assert isinstance(checker._motions, CompiledBroadphase)
    return checker


def edges(seed: int) -> tuple[Array, Array]:
    """Where short motions begin (n, nq), and the ways from there."""
    q = draw(EDGES, seed)
    way = np.random.default_rng(seed + 1).normal(size=q.shape)
    return q, way * 0.6 / np.linalg.norm(way, axis=1, keepdims=True)


@everywhere
def test_broadphases_agree_on_configurations(name: str, where: str) -> None:
    compiled, plain = checkers(name, where)
    q = draw(1500, 0)
    hits = plain.in_collision(q)
    assert 0.1 < hits.mean() < 0.9
    assert np.array_equal(hits, [compiled.any_collision(row[None]) for row in q])


@everywhere
def test_steps_are_single_configurations(name: str, where: str) -> None:
    both, found = checkers(name, where), set()
    for q, dq in zip(*edges(3), strict=True):
        steps = q + np.arange(1, STEPS + 1)[:, None] / STEPS * dq
        expected = bool(both[0].in_collision(steps).any())
        found.add(expected)
        assert [c.steps_collide(q, dq, STEPS) for c in both] == [expected] * 2
    assert found == {True, False}


@everywhere
def test_continuous_is_stricter_than_many_steps(name: str, where: str) -> None:
    both, free = checkers(name, where), 0
    for q, dq in zip(*edges(5), strict=True):
        touching = both[0].steps_collide(q, dq, 700)
        answers = [c.motion_collides(q, dq) for c in both]
        likely = [c.motion_collides(q, dq, likely_free=True) for c in both]
        assert answers == likely == answers[:1] * 2
        assert answers[0] or not touching
        free += not answers[0]
    assert 0 < free < EDGES


@everywhere
def test_no_pair_comes_nearer_faster_than_told(name: str, where: str) -> None:
    """Distances change in a stretch by no more than its speed allows."""
    checked, tightest = 0, np.inf
    for checker in checkers(name, where):
        for q, dq in zip(*edges(11), strict=True):
            for pair, start, end, speed in checker._motions.on_the_way(q, dq)[:3]:
                if pair == CERTAIN:
                    continue
                checked += 1
                t = np.linspace(start, end, 6)
                gaps = [distance(checker, q + share * dq, pair) for share in t]
                spare = speed * np.diff(t) - np.abs(np.diff(gaps))
                assert spare.min() >= -1e-6
                tightest = min(tightest, (spare / (speed * np.diff(t) + 1e-9)).min())
    assert checked > 20
    assert tightest < 0.5  # the bound is of use


@everywhere
def test_no_pair_touches_within_the_time_told(name: str, where: str) -> None:
    """Nor does it cross the plane that is between it at first."""
    checker, _ = checkers(name, where)
    motions = checker._motions
    assert isinstance(motions, CompiledBroadphase)
    checked, longer = 0, 0
    for q, dq in zip(*edges(17), strict=True):
        for pair, (mover, _) in motions._movers.items():
            speed = float(motions._tables.own[mover] @ np.abs(dq))
            if speed < 0.1 or not 1e-4 < distance(checker, q, pair) < 0.1:
                continue
            found = pin.computeDistance(checker._geometry, checker._geometry_data, pair)
            gap, normal = found.min_distance - PROVABLE, found.normal
            before, after = motions.free_times(pair, q, dq, normal, gap, speed)
            assert min(before, after) >= gap / speed
            checked += 1
            longer += max(before, after) > 2.0 * gap / speed
            for share in np.linspace(-min(before, 1.0), min(after, 1.0), 9):
                assert along(checker, q + share * dq, pair, normal) >= 0.0
    assert checked > 100
    assert longer > checked / 4


def along(checker: Checker, q: Array, pair: int, normal: Array) -> float:
    """How far the bodies of a pair are apart along a direction, at q (nq,)."""
    checker._place(q)
    first, second = checker._pairs[pair].tolist()
    shapes, poses = checker._geometry.geometryObjects, checker._geometry_data.oMg
    nearest = [
        normal @ poses[i].act(support(shapes[i].geometry, poses[i].rotation.T @ way))
        for i, way in ((first, normal), (second, -normal))
    ]
    return float(nearest[1] - nearest[0])


def support(shape: coal.ShapeBase, direction: Array) -> Array:
    """The point of a body that is farthest in a direction, in the body's frame."""
    if isinstance(shape, coal.ConvexBase):
        points = shape.points()
        farthest: Array = points[np.argmax(points @ direction)]
        return farthest
    if isinstance(shape, coal.Box):
        return np.sign(direction) * shape.halfSide
    if isinstance(shape, coal.Sphere):
        return shape.radius * direction
    up = np.sign(direction[2]) * np.array([0.0, 0.0, shape.halfLength])
    if isinstance(shape, coal.Capsule):
        return up + shape.radius * direction
    assert isinstance(shape, coal.Cylinder)
    beside = np.array([direction[0], direction[1], 0.0])
    return up + shape.radius * beside / max(np.linalg.norm(beside), 1e-12)


def distance(checker: Checker, q: Array, pair: int) -> float:
    """How far the bodies of a pair are apart at q (nq,), 0 where they overlap."""
    checker._place(q)
    found = pin.computeDistance(checker._geometry, checker._geometry_data, pair)
    return max(0.0, float(found.min_distance))


def test_continuous_is_no_stricter_than_it_must_be() -> None:
    """Motions that come within 1 mm of a touch, and not nearer, are free."""
    world = carrying("wineglass", "standing")
    near, compiled = world.keeping(0.001), checkers("wineglass", "standing")[0]
    strict = checker_of(near)
    q, dq = edges(7)
    for start, way in zip(q, dq, strict=True):
        if compiled.motion_collides(start, way):
            assert strict.steps_collide(start, way, 700)


@pytest.mark.parametrize("thickness", [1e-3, 1e-5])
def test_nothing_is_too_thin(thickness: float) -> None:
    """A sheet between two steps of the base is jumped by steps alone."""
    pose = shift(0.0, 0.0, 1.0)
    sheet = Obstacle("sheet", Box((thickness, 9.0, 3.0)), pose)
    world = among(sheet)
    q = q_tucked(-2.0)
    dq = q_tucked(2.0) - q
    assert not world.in_collision(np.array([q, q + dq])).any()
    assert not world.steps_collide(q, dq, 1)
    assert world.motion_collides(q, dq)
    assert not world.motion_collides(q, 0.2 * dq)


def test_what_is_known_of_two_links_changes_no_answer() -> None:
    robot = load_robot("panda_mobile")
    scenery = carrying("wineglass", "standing").scenery
    world = CollisionWorld(robot, scenery, standing={})
    rng = np.random.default_rng(1)
    group = robot.arm
    q = np.tile(robot.q_neutral, (800, 1))
    q[:, group.indices] = rng.uniform(group.lower, group.upper, (800, len(group)))
    before, learnt = compiled_checker(world), compiled_checker(world)
    assert before._motions is not learnt._motions  # made before any table is
    tables = 0
    for pair, (i, j) in enumerate(world.pairs.tolist()):
        if max(i, j) < robot.geometry.ngeoms:
            known = clear_cells(robot, i, j)
            if known is not None:
                assert known.clear.any()
                learnt._motions.learn(pair, known)
                tables += 1
    assert tables > 0
    suspects = [len(list(c._motions.likeliest(q))) for c in (before, learnt)]
    assert suspects[1] < suspects[0]
    hits = before.in_collision(q)
    assert np.array_equal(hits, [learnt.any_collision(row[None]) for row in q])
    dq = rng.normal(size=q.shape)[:100] * 0.1
    dq[:, group.indices[-1] + 1 :] = 0.0
    for start, way in zip(q, dq, strict=False):
        answers = {c.motion_collides(start, way) for c in (before, learnt)}
        assert len(answers) == 1
