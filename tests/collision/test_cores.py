"""What is said to lie within a body does."""

from __future__ import annotations

import coal
import numpy as np
import pytest

from mmplan.collision import meshes
from mmplan.collision.cores import BALLS, core_of
from mmplan.shapes import Array

HULL = np.random.default_rng(3).normal(size=(60, 3)) * (0.3, 0.1, 0.05) + (
    1.0,
    0.0,
    0.2,
)
BODIES = {
    "box": coal.Box(0.4, 0.2, 0.1),
    "sphere": coal.Sphere(0.3),
    "cylinder": coal.Cylinder(0.1, 0.6),
    "flat cylinder": coal.Cylinder(0.4, 0.1),
    "capsule": coal.Capsule(0.1, 0.6),
    "hull": meshes.hull(HULL),
    "tetrahedron": meshes.hull(np.vstack([np.zeros(3), np.eye(3)])),
    "sliver": meshes.hull(np.vstack([np.zeros(3), np.diag([1.0, 1e-3, 1e-3])])),
}
every = pytest.mark.parametrize("name", BODIES)


def depth(body: coal.CollisionGeometry, point: Array) -> float:
    """How deep a point is within a body, below 0 outside."""
    dot = coal.Sphere(1e-9)
    at = coal.Transform3s(np.eye(3), point)
    request, result = coal.DistanceRequest(True), coal.DistanceResult()
    return -coal.distance(body, coal.Transform3s(), dot, at, request, result)


@every
def test_boxes_are_within(name: str) -> None:
    centre, half = core_of(BODIES[name]).box
    assert np.all(half > 0.0)
    signs = np.stack(np.meshgrid(*[(-1, 1)] * 3), axis=-1).reshape(-1, 3)
    deep = [depth(BODIES[name], centre + s * half) for s in signs]
    assert min(deep) >= -1e-6


@every
def test_balls_are_within(name: str) -> None:
    balls = core_of(BODIES[name]).balls
    assert balls.shape == (BALLS, 4)
    there = balls[balls[:, 3] > 0.0]
    assert len(there)
    for *centre, radius in there:
        assert depth(BODIES[name], np.array(centre)) >= radius - 1e-5


def test_balls_fill_the_length() -> None:
    """The balls in a bar lie along it, one in each fifth of it or nearly so."""
    bar = meshes.hull(np.random.default_rng(0).uniform(-1, 1, (400, 3)) * (1, 0.1, 0.1))
    along = np.sort(core_of(bar).balls[:, 0])
    assert np.all(np.abs(along - np.linspace(-0.8, 0.8, BALLS)) < 0.2)


def test_what_is_not_known_is_nowhere() -> None:
    core = core_of(coal.Cone(0.1, 0.2))
    assert np.all(core.box.half == -np.inf)
    assert np.all(core.balls[:, 3] == -np.inf)
