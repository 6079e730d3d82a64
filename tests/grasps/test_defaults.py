"""What shapes suggest to a hand."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.collision import HandCloser, Scenery, hand_size, hand_widths
from mmplan.exceptions import InputError
from mmplan.grasp_build import default_grasps, too_wide
from mmplan.grasps import Axis, CylinderSide
from mmplan.grasps.defaults import around_body, default_families, ends_of, narrowest
from mmplan.problem import Object
from mmplan.shapes import Box, Capsule, Cone, Cylinder, Revolve, Shape, Sphere
from tests.collision.worlds import scene
from tests.honest import puma, shift

WINEGLASS = scene("wineglass").objects[0].shape
PLATE = scene("plate").objects[0].shape
BOTTLE = Revolve(
    np.array(
        [[0, 0], [0.04, 0], [0.04, 0.18], [0.013, 0.23], [0.013, 0.3], [0, 0.3]],
    )
)
# A bowl that is wider than the hand opens, with a wall of 4 mm.
BOWL = Revolve(
    np.array(
        [[0, 0], [0.05, 0], [0.09, 0.06], [0.086, 0.06], [0.047, 0.004], [0, 0.004]]
    )
)
SHAPES: dict[str, tuple[Shape, set[str]]] = {
    "box": (Box((0.2, 0.1, 0.05)), {"faces"}),
    "ball": (Sphere(0.04), {"ball"}),
    "can": (Cylinder(0.035, 0.12), {"body", "top", "bottom"}),
    "capsule": (Capsule(0.02, 0.1), {"body", "top", "bottom"}),
    "cone": (Cone(0.03, 0.2), {"body", "bottom", "top"}),
    "disc": (Cylinder(0.1, 0.02), {"lip"}),
    "wineglass": (WINEGLASS, {"stem", "body", "top", "wall"}),
    "plate": (PLATE, {"lip"}),
    "bottle": (BOTTLE, {"body", "stem", "top", "bottom"}),
    "bowl": (BOWL, {"wall"}),
}
each_shape = pytest.mark.parametrize("name", SHAPES)


@each_shape
def test_a_shape_has_the_families_that_one_would_expect(name: str) -> None:
    shape, expected = SHAPES[name]
    assert set(default_families(shape, hand_size(puma()))) == expected


@each_shape
def test_the_hand_closes_in_every_default_family(name: str) -> None:
    item = Object(name, SHAPES[name][0], np.eye(4))
    closer = HandCloser(puma(), Scenery.solids_of_object(item))
    for family in default_grasps(item, puma()).values():
        genes = family.genes.sample(24, np.random.default_rng(0))
        touches = closer.close(family.tool_poses(genes)).touches
        assert touches.mean() > 0.25, family


def test_stems_and_bodies_are_found_where_they_are() -> None:
    families = default_families(WINEGLASS, hand_size(puma()))
    stem, body = families["stem"], families["body"]
    assert isinstance(stem, Axis)
    assert isinstance(body, CylinderSide)
    assert 0.008 < stem.along[0] < stem.along[1] < 0.095
    assert 0.125 < body.along[0] < body.along[1] < 0.215
    assert around_body(WINEGLASS, hand_size(puma())) == body.along
    assert around_body(Box((1, 1, 1)), hand_size(puma())) is None
    assert ends_of(WINEGLASS) == (0.0, 0.215)


def test_the_size_of_a_hand_is_that_of_its_bodies() -> None:
    """The pads are 0.1 m apart, 70 mm before the palm, 18 mm wide (see the URDF)."""
    size = hand_size(puma())
    assert size == pytest.approx((0.1, 0.07, 0.018))


@pytest.mark.parametrize(
    ("shape", "width"),
    [
        (Box((0.2, 0.12, 0.15)), 0.12),
        (Sphere(0.06), 0.12),
        (Cylinder(0.08, 0.3), 0.16),
    ],
)
def test_what_is_too_wide_is_refused_with_its_width(shape: Shape, width: float) -> None:
    assert narrowest(shape) == pytest.approx(width)
    with pytest.raises(InputError) as caught:
        default_grasps(Object("crate", shape, np.eye(4)), puma())
    assert str(caught.value) == (
        f"'crate' is {width:.3g} m wide where it is narrowest, and the hand of "
        "puma_mobile opens by 0.1 m"
    )


def test_a_family_that_nowhere_fits_is_too_wide() -> None:
    side = CylinderSide(along=(-0.02, 0.02))
    wide, narrow = Cylinder(0.06, 0.2), Cylinder(0.04, 0.2)
    message = too_wide(side, Object("drum", wide, np.eye(4)), puma())
    assert message == (
        "the object is at least 0.12 m wide between the fingers, and the hand of "
        "puma_mobile opens by 0.1 m"
    )
    assert too_wide(side, Object("can", narrow, np.eye(4)), puma()) is None
    # What misses the object altogether is another matter.
    beside = CylinderSide(along=(0.5, 0.6))
    assert too_wide(beside, Object("can", narrow, np.eye(4)), puma()) is None


@pytest.mark.parametrize("width", [0.02, 0.09, 0.13, 0.4])
def test_widths_are_measured_beyond_the_opening(width: float) -> None:
    solids = Scenery.solids_of_object(Object("bar", Box((0.1, width, 0.1)), np.eye(4)))
    aside = shift(0.0, 0.3 * width, 0.0)
    found = hand_widths(puma(), solids, np.array([np.eye(4), aside, shift(0.5, 0, 0)]))
    np.testing.assert_allclose(found[:2], width, atol=5e-4)
    assert np.isnan(found[2])
