"""The proof against dense sampling, on random motions among clutter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mmplan.collision import CollisionWorld
from mmplan.collision.separation import transform
from mmplan.hermite import HermiteCurve
from mmplan.problem import Obstacle, Problem
from mmplan.shapes import Array, Box, Capsule, Sphere
from mmplan.verification.bodies import Bodies
from mmplan.verification.ledger import SHARPNESS, Ledger
from mmplan.verification.proof import SegmentProof
from mmplan.verification.touching import TouchRule
from tests.honest import bottle_problem, shift

SAMPLES = 1_000


@pytest.fixture(scope="module")
def clutter() -> CollisionWorld:
    """A Puma among pillars, balls and thin sheets around it."""
    rng = np.random.default_rng(5)
    obstacles = [Obstacle("floor", Box((8, 8, 0.1)), shift(0, 0, -0.05), ground=True)]
    for k in range(12):
        angle = 2 * np.pi * k / 12
        x, y = rng.uniform(0.8, 1.3) * np.array([np.cos(angle), np.sin(angle)])
        shape = (Capsule(0.04, 0.8), Sphere(0.12), Box((0.4, 0.002, 0.5)))[k % 3]
        T = shift(x, y, rng.uniform(0.6, 1.4))
        obstacles.append(Obstacle(f"clutter_{k}", shape, T))
    problem = replace(bottle_problem(), obstacles=tuple(obstacles))
    return CollisionWorld.of_problem(problem)


def prove(world: CollisionWorld, curve: HermiteCurve) -> Ledger:
    """The proof of a motion in which nothing may touch anything."""
    travel = curve.position_extremes().magnitude.max(axis=0)
    ledger = Ledger()
    rule = TouchRule(np.zeros(len(world.pairs)), ())
    SegmentProof(0, curve, Bodies(world, travel), rule, ledger).run()
    return ledger


def random_motion(world: CollisionWorld, seed: int, size: float) -> HermiteCurve:
    """A motion through three random samples about a random configuration."""
    rng, model = np.random.default_rng(seed), world.model
    low, high = model.lowerPositionLimit.copy(), model.upperPositionLimit.copy()
    low[:2], high[:2] = -0.3, 0.3
    q = rng.uniform(low, high) + size * rng.uniform(-1, 1, (3, model.nq)) * (high - low)
    v = size * rng.uniform(-1, 1, (3, model.nq))
    return HermiteCurve(np.array([0.0, 0.7, 1.5]), np.clip(q, low, high), v)


def dense(curve: HermiteCurve) -> Array:
    return curve.positions(np.linspace(0.0, curve.times[-1], 2 * SAMPLES))


@settings(max_examples=150)
@given(st.integers(0, 100_000), st.sampled_from([0.02, 0.1, 0.3]))
def test_what_is_proven_free_is_free_at_every_sample(
    clutter: CollisionWorld, seed: int, size: float
) -> None:
    curve = random_motion(clutter, seed, size)
    ledger = prove(clutter, curve)
    faulty = bool(ledger.overlaps or ledger.undecided)
    collides = clutter.any_collision(dense(curve))
    assert faulty or not collides
    for finding in ledger.overlaps.values():
        assert finding.distance <= 0.0
    if ledger.overlaps:
        earliest = min(ledger.overlaps.values(), key=lambda f: f.time)
        contacts = clutter.contacts(curve.positions(np.array([earliest.time]))[0])
        assert (earliest.first, earliest.second) in {c[:2] for c in contacts}


@settings(max_examples=30)
@given(st.integers(0, 100_000))
def test_the_proven_clearance_is_kept_and_the_found_one_is_real(
    clutter: CollisionWorld, seed: int
) -> None:
    curve = random_motion(clutter, seed, 0.05)
    ledger = prove(clutter, curve)
    if ledger.overlaps or ledger.undecided:
        return
    assert ledger.nearest is not None
    assert SHARPNESS * ledger.nearest.distance <= ledger.proven + 1e-12
    assert ledger.proven <= ledger.nearest.distance
    bodies = Bodies(clutter, np.zeros(clutter.model.nq))
    sampled = min(smallest_distance(bodies, q) for q in dense(curve)[::40])
    assert sampled >= ledger.proven - 1e-5
    now = curve.positions(np.array([ledger.nearest.time]))[0]
    assert smallest_distance(bodies, now) <= ledger.nearest.distance + 1e-5


def smallest_distance(bodies: Bodies, q: Array) -> float:
    T, separation = bodies.joint_poses(q[None])[0], bodies.separation
    poses = [
        transform(T[joint] @ placement)
        for joint, placement in zip(bodies.joints, bodies.placements, strict=True)
    ]
    pairs = bodies.world.pairs.tolist()
    return min(separation.distance(i, poses[i], j, poses[j]) for i, j in pairs)


def with_obstacle(obstacle: Obstacle) -> Problem:
    return bottle_problem(obstacle)


def driving(speed: float) -> HermiteCurve:
    """The base drives 1 m along y, away from the counter."""
    q = np.tile(bottle_problem().q_start, (2, 1))
    q[1, 1] += 1.0
    v = np.zeros_like(q)
    v[:, 1] = speed
    return HermiteCurve(np.array([0.0, 1.0 / speed]), q, v)


@pytest.mark.parametrize("thickness", [1e-6, 0.002])
def test_a_thin_sheet_between_two_samples_is_found(thickness: float) -> None:
    sheet = Obstacle("sheet", Box((0.5, thickness, 1.0)), shift(-0.65, 0.6123, 0.5))
    world = CollisionWorld.of_problem(with_obstacle(sheet))
    ledger = prove(world, driving(0.5))
    assert {f.first for f in ledger.overlaps.values()} >= {"base"}
    assert {f.second for f in ledger.overlaps.values()} == {"sheet"}


@pytest.mark.parametrize(("gap", "free"), [(0.001, True), (1e-4, True), (-1e-5, False)])
def test_driving_past_closely_is_free_and_grazing_is_not(
    gap: float, free: bool
) -> None:
    """A wall along the way, beside the base of radius 0.28 m."""
    wall = Obstacle(
        "wall", Box((0.02, 3.0, 0.2)), shift(-0.65 - 0.28 - 0.01 - gap, 0.5, 0.2)
    )
    world = CollisionWorld.of_problem(with_obstacle(wall))
    ledger = prove(world, driving(0.5))
    assert bool(ledger.overlaps or ledger.undecided) is not free
    if free:
        assert ledger.nearest is not None
        assert ledger.nearest.distance == pytest.approx(gap, abs=2e-6)
        assert SHARPNESS * gap - 2e-6 <= ledger.proven <= gap


def test_overshoot_between_samples_is_seen() -> None:
    """Both samples are free; only the curve between them reaches the wall."""
    wall = Obstacle("wall", Box((1.0, 0.02, 1.0)), shift(-0.65, 0.5, 0.5))
    world = CollisionWorld.of_problem(with_obstacle(wall))
    q = np.tile(bottle_problem().q_start, (2, 1))
    v = np.zeros_like(q)
    v[:, 1] = 2.0, -2.0
    curve = HermiteCurve(np.array([0.0, 1.0]), q, v)
    assert not world.any_collision(q)
    assert prove(world, curve).overlaps
    v[:, 1] = 0.5, -0.5
    assert not prove(world, HermiteCurve(curve.times, q, v)).overlaps


def test_the_proof_is_the_same_each_time(clutter: CollisionWorld) -> None:
    curve = random_motion(clutter, 11, 0.1)
    assert prove(clutter, curve) == prove(clutter, curve)
