"""A small library of things to move: shapes, grasps, and how they stand."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np

from mmplan.generation.draft import Entry, metres


class Rest(Enum):
    """How a thing can stand."""

    UPRIGHT = "upright"
    INVERTED = "upside down"
    LYING = "lying"
    ON_EDGE = "on edge"


@dataclass(frozen=True)
class Stance:
    """A thing at rest: how it is turned and what room it takes.

    Its origin is `height` above the support. All of it is within `radius` of the
    vertical through its origin, and `top` is its highest point above the support (m).
    """

    roll: float  # about x, rad
    height: float
    radius: float
    top: float


@dataclass(frozen=True)
class Thing:
    """An object without a place. `item` has its shape and grasps."""

    name: str
    item: Entry
    stances: Mapping[Rest, Stance]

    @property
    def is_flat(self) -> bool:
        """Whether the hand must reach below it, as over the edge of its support."""
        return Rest.ON_EDGE in self.stances


def wineglass(scale: float) -> Thing:
    """Foot, stem and a hollow bowl; held by the stem or by the bowl."""
    outline = [
        (0.0, 0.0), (0.034, 0.0), (0.034, 0.002), (0.006, 0.008), (0.0045, 0.02),
        (0.0045, 0.095), (0.022, 0.105), (0.035, 0.125), (0.033, 0.215),
        (0.0305, 0.215), (0.0325, 0.125), (0.0, 0.125),
    ]  # fmt: skip
    grasps = {"stem": _axis(0.02, 0.09, scale), "bowl": _axis(0.12, 0.2, scale)}
    return _turned("wineglass", outline, grasps, scale, inverts=True)


def tumbler(scale: float) -> Thing:
    """A glass that widens upward."""
    outline = [
        (0.0, 0.0), (0.03, 0.0), (0.036, 0.12), (0.0335, 0.12), (0.0275, 0.008),
        (0.0, 0.008),
    ]  # fmt: skip
    grasps = {"side": _axis(0.03, 0.105, scale)}
    return _turned("tumbler", outline, grasps, scale, inverts=True)


def mug(scale: float) -> Thing:
    """A mug without its handle."""
    outline = [
        (0.0, 0.0), (0.037, 0.0), (0.037, 0.1), (0.033, 0.1), (0.033, 0.006),
        (0.0, 0.006),
    ]  # fmt: skip
    grasps = {"side": _axis(0.03, 0.085, scale)}
    return _turned("mug", outline, grasps, scale, inverts=True)


def bottle(scale: float) -> Thing:
    """A bottle, held by its body or by its neck."""
    outline = [
        (0.0, 0.0), (0.034, 0.0), (0.036, 0.004), (0.036, 0.17), (0.015, 0.215),
        (0.013, 0.28), (0.0, 0.28),
    ]  # fmt: skip
    grasps = {"body": _axis(0.03, 0.15, scale), "neck": _axis(0.225, 0.265, scale)}
    return _turned("bottle", outline, grasps, scale, inverts=False)


def plate(scale: float) -> Thing:
    """A disc with a conical lip, held by the lip."""
    outline = [
        (0.0, 0.0), (0.06, 0.0), (0.13, 0.036), (0.13, 0.04), (0.061944, 0.005),
        (0.0, 0.005),
    ]  # fmt: skip
    lip = {
        "family": "rim",
        "radius": metres(0.12 * scale),
        "height": metres(0.0325 * scale),
    }
    thing = _turned("plate", outline, {"lip": lip}, scale, inverts=False)
    radius = thing.stances[Rest.UPRIGHT].radius
    edge = Stance(math.pi / 2, radius, radius, 2 * radius)
    return Thing(thing.name, thing.item, {**thing.stances, Rest.ON_EDGE: edge})


def can(scale: float) -> Thing:
    """A can, upright or on its side."""
    return _cylinder("can", radius=0.033 * scale, length=0.116 * scale)


def tube(scale: float) -> Thing:
    """A long thin cylinder, upright or on its side."""
    return _cylinder("tube", radius=0.022 * scale, length=0.2 * scale)


THINGS: dict[str, Callable[[float], Thing]] = {
    "wineglass": wineglass,
    "tumbler": tumbler,
    "mug": mug,
    "bottle": bottle,
    "plate": plate,
    "can": can,
    "tube": tube,
}


def draw_thing(rng: np.random.Generator, *names: str) -> Thing:
    """One of the things of those names, a little larger or smaller than usual."""
    name = names[rng.integers(len(names))]
    return THINGS[name](round(float(rng.uniform(0.92, 1.08)), 2))


def _axis(low: float, high: float, scale: float) -> Entry:
    return {"family": "axis", "along": [metres(low * scale), metres(high * scale)]}


def _turned(
    name: str,
    outline: list[tuple[float, float]],
    grasps: Entry,
    scale: float,
    *,
    inverts: bool,
) -> Thing:
    """A thing of revolution whose outline begins at its bottom, z = 0."""
    points = [[metres(r * scale), metres(z * scale)] for r, z in outline]
    radius = max(r for r, _ in points)
    top = max(z for _, z in points)
    stances = {Rest.UPRIGHT: Stance(0.0, 0.0, radius, top)}
    if inverts:
        stances[Rest.INVERTED] = Stance(math.pi, top, radius, top)
    return Thing(name, {"revolve": points, "grasps": grasps}, stances)


def _cylinder(name: str, *, radius: float, length: float) -> Thing:
    radius, length = round(radius, 4), round(length, 4)
    half = length / 2
    margin = min(0.02, half / 2)  # between the target and the ends
    shape = {"radius": radius, "length": length}
    grasp = _axis(margin - half, half - margin, 1.0)
    stances = {
        Rest.UPRIGHT: Stance(0.0, half, radius, length),
        Rest.LYING: Stance(math.pi / 2, radius, math.hypot(half, radius), 2 * radius),
    }
    return Thing(name, {"cylinder": shape, "grasps": {"side": grasp}}, stances)
