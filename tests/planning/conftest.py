"""A world simple enough to be judged by hand, and the shipped robot in a kitchen."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin
import pytest

from mmplan.collision import CollisionWorld
from mmplan.planning import MotionLimits, MovingJoints
from mmplan.scene_file import load_problem

STICK = 0.5  # m


class Touch(NamedTuple):
    first: str
    second: str


def stick_model():
    """A stick in the plane: q = (x, y, angle) of its tail."""
    model = pin.Model()
    model.name = "stick"
    joint = 0
    for kind, name in (
        (pin.JointModelPX(), "x"),
        (pin.JointModelPY(), "y"),
        (pin.JointModelRZ(), "angle"),
    ):
        joint = model.addJoint(joint, kind, pin.SE3.Identity(), name)
    model.lowerPositionLimit = np.array([-2.0, -2.0, -3.0])
    model.upperPositionLimit = np.array([2.0, 2.0, 3.0])
    geometry = pin.GeometryModel()
    middle = pin.SE3(np.eye(3), np.array([STICK / 2, 0.0, 0.0]))
    body = coal.Box(STICK, 1e-9, 1e-9)
    geometry.addGeometryObject(pin.GeometryObject("stick", joint, middle, body))
    return model, geometry


@dataclass(frozen=True, eq=False)
class StickWorld:
    """The stick among axis-aligned boxes: name -> (low x, low y, high x, high y)."""

    boxes: dict
    model: pin.Model
    geometry: pin.GeometryModel

    @classmethod
    def among(cls, **boxes):
        return cls(boxes, *stick_model())

    def shrunk(self, by):
        """The same with every box thinner by that much on every side."""
        boxes = {
            name: tuple(np.add(box, [by, by, -by, -by]))
            for name, box in self.boxes.items()
        }
        return StickWorld(boxes, self.model, self.geometry)

    def _hits(self, q, box):
        """Whether the stick meets a box: the slab test."""
        tail = q[:, :2]
        along = STICK * np.stack([np.cos(q[:, 2]), np.sin(q[:, 2])], axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            one = (np.array(box[:2]) - tail) / along
            other = (np.array(box[2:]) - tail) / along
        enter = np.nanmax(np.fmin(one, other), axis=1)
        leave = np.nanmin(np.fmax(one, other), axis=1)
        return (enter <= leave) & (leave >= 0.0) & (enter <= 1.0)

    def in_collision(self, q):
        hits = [self._hits(np.asarray(q), box) for box in self.boxes.values()]
        return np.any(hits, axis=0) if hits else np.zeros(len(q), dtype=bool)

    def any_collision(self, q):
        return bool(self.in_collision(q).any())

    def contacts(self, q):
        boxes = self.boxes.items()
        return [Touch("stick", n) for n, b in boxes if self._hits(q[None], b)[0]]


@pytest.fixture
def stick_among():
    """Makes a `StickWorld` of named boxes."""
    return StickWorld.among


@pytest.fixture
def stick_joints():
    model, _ = stick_model()
    return MovingJoints(
        ("x", "y", "angle"),
        np.arange(3),
        model.lowerPositionLimit,
        model.upperPositionLimit,
        np.zeros(3, dtype=bool),
        np.ones(3),
    )


@pytest.fixture
def turning_joints(stick_joints):
    """The same stick, its angle without limits."""
    endless = np.array([0.0, 0.0, np.inf])
    return replace(
        stick_joints,
        lower=stick_joints.lower - endless,
        upper=stick_joints.upper + endless,
        wraps=np.array([False, False, True]),
    )


@pytest.fixture(scope="session")
def kitchen():
    """The problem of the shipped scene `wineglass`."""
    return load_problem("wineglass")


@pytest.fixture(scope="session")
def kitchen_world(kitchen):
    return CollisionWorld.of_problem(kitchen)


@pytest.fixture(scope="session")
def stick_world_class():
    """`StickWorld` for tests that draw examples."""
    return StickWorld


@pytest.fixture(scope="session")
def stick_limits():
    return MotionLimits(np.array([0.8, 0.6, 1.5]), np.array([1.0, 2.0, 4.0]))
