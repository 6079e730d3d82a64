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
from mmplan.planning.path_limit import PathLimit
from mmplan.shapes import Array

# The solver gives up where its numbers differ too much in size, as with a slow torso
# and a quick wrist; drawn at another scale the same curve is solved.
_SCALES = (1.0, 1e-2, 1e-4, 1e-3)


def fastest_speeds(curve: Curve, grid: Array, limits: MotionLimits) -> Array:
    """The greatest speeds ds/dt (n,) at points `grid` (n,) of a curve, rest to rest.

    The grid goes from 0 to the curve's length. The limits hold at its points, and
    between them as far as it is fine.

    Raises:
        ArithmeticError: if toppra finds no solution; slow enough there always is one.
    """
    for scale in _SCALES:
        speeds = _speeds(curve, grid, limits, scale)
        if speeds is not None and np.all(speeds[1:-1] > 0.0):
            return np.array([0.0, *speeds[1:-1], 0.0])
    raise ArithmeticError("toppra found no time parametrization of a path")


def _speeds(
    curve: Curve, grid: Array, limits: MotionLimits, scale: float
) -> Array | None:
    """The speeds (n,) that toppra finds on the curve drawn at a scale, if any."""
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
    path = _MovingPart(curve, moving, scale)
    constraints += [_path_limit(path, limit) for limit in limits.more]
    method = toppra.algorithm.TOPPRA(
        constraints, path, scale * grid, solver_wrapper="seidel"
    )
    _, speeds, _ = method.compute_parameterization(0.0, 0.0)
    return None if speeds is None else speeds / scale


class _MovingPart:
    """What moves of a curve, drawn `scale` times as long, as toppra wants a path."""

    def __init__(
        self, curve: Curve, moving: npt.NDArray[np.int64], scale: float
    ) -> None:
        self._curve = curve
        self._moving = moving
        self._scale = scale
        self.dof = len(moving)
        self.path_interval = np.array([0.0, scale * curve.length])

    def __call__(self, s: Array, order: int = 0) -> Array:
        return self.whole(s, order)[:, self._moving]

    def whole(self, s: Array, order: int = 0) -> Array:
        """All joints (n, nq), those that do not move among them."""
        return self._curve(s / self._scale, order) / self._scale**order


def _path_limit(path: _MovingPart, limit: PathLimit) -> object:
    """A limit as toppra takes it, at both ends of each step."""
    toppra = _toppra()

    class Limit(toppra.constraint.LinearConstraint):  # type: ignore[name-defined]
        def compute_constraint_params(self, _path: object, grid: Array) -> object:
            rows = limit.rows(*(path.whole(grid, order) for order in range(3)))
            one = np.eye(rows.a.shape[1])
            both, most = np.vstack([one, -one]), np.ones(2 * len(one))
            return interpolated(*rows, both, most, None, None, grid, identical=True)

    interpolated = toppra.constraint.canlinear_colloc_to_interpolate
    made = Limit()
    made.dof = path.dof
    made.identical = True
    made.set_discretization_type(toppra.constraint.DiscretizationType.Interpolation)
    return made


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
