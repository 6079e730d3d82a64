"""Where the closed fingers touch."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.collision import HandCloser, Scenery
from mmplan.collision.closing import CONTACT_DISTANCE
from mmplan.grasps.contacts import Contacts
from mmplan.problem import Object
from mmplan.shapes import Array, Box, Cylinder, Revolve, Shape, Sphere
from tests.honest import puma, shift

# m, how far the corners of a pad are from the middle that touches in a point.
SOFT = 2 / 3 * 0.005


def contacts(shape: Shape, *T_object_tool: Array) -> Contacts:
    closer = HandCloser(
        puma(), Scenery.solids_of_object(Object("thing", shape, np.eye(4)))
    )
    poses = np.array(T_object_tool)
    return closer.contacts(poses, closer.close(poses))


def test_flat_pads_touch_a_box_in_the_middle_of_what_they_share() -> None:
    """The tool is 15 mm before the tips of fingers that are 85 mm long."""
    found = contacts(Box((0.1, 0.04, 0.1)), np.eye(4), shift(0, 0, -0.03))
    assert found.complete.all()
    np.testing.assert_allclose(found.normals, [[[0, -1, 0], [0, 1, 0]]] * 2, atol=1e-6)
    y = 0.02 + CONTACT_DISTANCE / 2
    # From the end of the box nearest to the palm to the tips, then less of it.
    z = [(-0.05 + 0.015) / 2, (-0.05 - 0.015) / 2]
    expected = [[[0, y, h], [0, -y, h]] for h in z]
    np.testing.assert_allclose(found.points, expected, atol=2 * CONTACT_DISTANCE)
    # As wide as the fingers; as long as what they share.
    for grasp, long in enumerate([0.05 + 0.015, 0.05 - 0.015]):
        for corners in found.corners[grasp]:
            sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
            np.testing.assert_allclose(np.sort(sides), [0.018] * 2 + [long] * 2, 1e-2)


def test_a_ball_is_touched_in_points() -> None:
    found = contacts(Sphere(0.02), np.eye(4))
    np.testing.assert_allclose(
        found.points[0], [[0, 0.02, 0], [0, -0.02, 0]], atol=2 * CONTACT_DISTANCE
    )
    away = np.linalg.norm(found.corners - found.points[:, :, None], axis=-1)
    np.testing.assert_allclose(away, SOFT)


def test_a_rod_is_touched_along_a_line() -> None:
    """The fingers are level and the rod upright: as long as they are wide."""
    level = np.array([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1.0]])
    found = contacts(Cylinder(0.02, 0.3), level)
    for corners in found.corners[0]:
        spans = np.sort(np.ptp(corners, axis=0))
        np.testing.assert_allclose(spans, [0, np.sqrt(2) * SOFT, 0.018], atol=2e-4)


def test_pieces_of_one_surface_count_together() -> None:
    """A ring of wedges and the cylinder that it looks like from outside."""
    ring = Revolve(np.array([[0.03, -0.1], [0.04, -0.1], [0.04, 0.1], [0.03, 0.1]]))
    a, b = contacts(ring, np.eye(4)), contacts(Cylinder(0.04, 0.2), np.eye(4))
    np.testing.assert_allclose(a.points, b.points, atol=1e-3)
    np.testing.assert_allclose(a.normals, b.normals, atol=0.05)


@pytest.mark.parametrize("aside", [shift(0.2, 0, 0), shift(0, 0.06, 0)])
def test_nothing_is_touched_where_the_hand_does_not_close(aside: Array) -> None:
    found = contacts(Sphere(0.02), aside, np.eye(4))
    assert found.complete.tolist() == [False, True]
    assert np.isnan(found.points[0]).all()
