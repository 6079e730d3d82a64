"""The one door to toppra: the fastest way along a curve within the limits.

H. Pham, Q.-C. Pham, "A new approach to time-optimal path parameterization based on
reachability analysis", IEEE T-RO 2018.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

import numpy as np
import numpy.typing as npt

from mmplan.planning.curve import Curve
from mmplan.planning.joints import MotionLimits
from mmplan.shapes import Array


def fastest_speeds(curve: Curve, grid: Array, limits: MotionLimits) -> Array:
    """The greatest speeds ds/dt (n,) at points `grid` (n,) of a curve, rest to rest.

    The grid goes from 0 to the curve's length. The limits hold at its points, and
    between them as far as it is fine.

    Raises:
        ArithmeticError: if toppra finds no solution; slow enough there always is one.
    """
    toppra = _toppra()
    moving = curve.moving
    velocity, acceleration = limits.velocity[moving], limits.acceleration[moving]
    constraints = [
        toppra.constraint.JointVelocityConstraint(_both_ways(velocity)),
        toppra.constraint.JointAccelerationConstraint(
            _both_ways(acceleration),
            toppra.constraint.DiscretizationType.Interpolation,
        ),
    ]
    path = _MovingPart(curve, moving)
    method = toppra.algorithm.TOPPRA(constraints, path, grid, solver_wrapper="seidel")
    _, speeds, _ = method.compute_parameterization(0.0, 0.0)
    if speeds is None or not np.all(speeds[1:-1] > 0.0):
        raise ArithmeticError("toppra found no time parametrization of a path")
    return np.array([0.0, *speeds[1:-1], 0.0])


class _MovingPart:
    """The joints of a curve that move, as toppra wants a path."""

    def __init__(self, curve: Curve, moving: npt.NDArray[np.int64]) -> None:
        self._curve = curve
        self._moving = moving
        self.dof = len(moving)
        self.path_interval = np.array([0.0, curve.length])

    def __call__(self, s: Array, order: int = 0) -> Array:
        return self._curve(s, order)[:, self._moving]


def _both_ways(limits: Array) -> Array:
    return np.stack([-limits, limits], axis=1)


def _toppra() -> ModuleType:
    with _matplotlib_on_demand():
        import toppra
    module: ModuleType = toppra
    return module


@contextmanager
def _matplotlib_on_demand() -> Iterator[None]:
    """Let modules that are imported meanwhile have matplotlib only when they use it.

    toppra imports matplotlib's pyplot for two methods that draw, which costs more than
    the rest of toppra. The modules put in its place import the real one as soon as
    anything is asked of them; `sys.modules` is left as it was, so that a later `import
    matplotlib` anywhere is the real one.
    """
    names = ("matplotlib", "matplotlib.pyplot")
    if any(name in sys.modules for name in names):
        yield
        return
    package, pyplot = (_stand_in(name) for name in names)
    package.pyplot = pyplot  # type: ignore[attr-defined]
    sys.modules.update({package.__name__: package, pyplot.__name__: pyplot})
    try:
        yield
    finally:
        for module in (package, pyplot):
            if sys.modules.get(module.__name__) is module:
                del sys.modules[module.__name__]


def _stand_in(name: str) -> ModuleType:
    """An empty module that answers from the real one, imported at the first question.

    The import system's own questions, all for names like `__path__`, do not count.
    """
    module = ModuleType(name)

    def answer(attribute: str) -> object:
        if attribute.startswith("__"):
            raise AttributeError(attribute)
        return getattr(importlib.import_module(name), attribute)

    module.__getattr__ = answer  # type: ignore[method-assign]
    return module
