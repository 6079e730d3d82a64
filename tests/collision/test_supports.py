"""What an object touches where it stands, and how far it is from the rest."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.collision import TOUCH_TOLERANCE, Scenery, clearances, overlaps, supports
from mmplan.problem import Object, Obstacle
from mmplan.shapes import Array, Box, Cylinder, Revolve, Sphere
from tests.collision.worlds import SCENES, problem_of, scene, shipped
from tests.honest import shift

TABLE = Obstacle("table", Box((1.0, 1.0, 0.5)), shift(0, 0, 0.25))
WALL = Obstacle("wall", Box((0.1, 1.0, 2.0)), shift(0.55, 0, 1.0))
CUP = Object("cup", Cylinder(0.03, 0.1), np.eye(4))
JAR = Object("jar", Sphere(0.05), np.eye(4))


def scenery(*things: Obstacle | Object) -> Scenery:
    return Scenery.of_problem(problem_of(*things))


def on_table(gap: float, x: float = 0.0) -> Array:
    return shift(x, 0.0, 0.55 + gap)


@pytest.mark.parametrize("gap", [-0.02, -0.002, -0.0005, 0.0, 0.0005, 0.003, 0.04])
def test_clearances_are_signed_distances(gap: float) -> None:
    found = clearances(scenery(TABLE, CUP), "cup", on_table(gap), within=0.05)
    assert found == {"table": pytest.approx(gap, abs=1e-6)}


def test_clearances_go_as_far_as_asked_and_no_farther() -> None:
    place = scenery(TABLE, WALL, CUP)
    T = on_table(0.01, x=0.4)  # 70 mm from the wall
    assert set(clearances(place, "cup", T, within=0.005)) == set()
    assert set(clearances(place, "cup", T, within=0.02)) == {"table"}
    found = clearances(place, "cup", T, within=0.08)
    assert found == {
        "table": pytest.approx(0.01, abs=1e-6),
        "wall": pytest.approx(0.07, abs=1e-6),
    }


def test_only_overlaps_are_found_within_a_negative_distance() -> None:
    place = scenery(TABLE, CUP)
    assert clearances(place, "cup", on_table(-0.0005), within=-0.001) == {}
    assert set(clearances(place, "cup", on_table(-0.002), within=-0.001)) == {"table"}


def test_other_objects_count_where_they_stand() -> None:
    place = scenery(TABLE, CUP, JAR)
    standing = {"cup": on_table(0.0), "jar": on_table(0.0, x=0.085)}
    found = clearances(place, "cup", standing["cup"], 0.01, standing)
    assert found["jar"] == pytest.approx(0.005, abs=1e-6)
    assert "cup" not in found
    assert "jar" not in clearances(place, "cup", standing["cup"], 0.01)


@pytest.mark.parametrize(
    ("gap", "touches"),
    [
        (0.0, True),
        (0.0009, True),
        (0.0011, False),
        (-0.0009, True),
        (-0.0011, False),  # not a support but an overlap
        (-0.03, False),
    ],
)
def test_a_support_is_touched_within_the_tolerance_either_way(
    gap: float, touches: bool
) -> None:
    place = scenery(TABLE, WALL, CUP)
    found = supports(place, "cup", on_table(gap), TOUCH_TOLERANCE)
    assert found == ({"table": TOUCH_TOLERANCE} if touches else {})


def test_an_object_may_touch_several_things() -> None:
    place = scenery(TABLE, WALL, CUP, JAR)
    corner = on_table(0.0, x=0.47)
    standing = {"cup": corner, "jar": on_table(0.0, x=0.39)}
    found = supports(place, "cup", corner, TOUCH_TOLERANCE, standing)
    assert set(found) == {"table", "wall", "jar"}


@pytest.mark.parametrize("height", [0.0001, 0.0005, 0.005, 0.05, 0.0999])
def test_a_thin_sheet_through_an_object_is_no_support(height: float) -> None:
    """Half a millimetre thin; its middle is between the cup's bottom and its top."""
    sheet = Obstacle("sheet", Box((1, 1, 0.0005)), shift(0, 0, 0.5 + height))
    place, T = scenery(TABLE, sheet, CUP), on_table(0.0)
    assert set(supports(place, "cup", T, TOUCH_TOLERANCE)) == {"table"}
    ((owner, overlap),) = overlaps(place, "cup", T, TOUCH_TOLERANCE).items()
    assert owner == "sheet"
    assert overlap.allowed == pytest.approx(0.00025)
    expected = 0.00025 + min(height, 0.1 - height)
    assert overlap.depth == pytest.approx(expected, abs=2e-6)


def test_a_thin_sheet_supports_down_to_half_its_thickness() -> None:
    for height, rests in ((-0.0001, True), (-0.0003, True), (0.0001, False)):
        sheet = Obstacle("sheet", Box((1, 1, 0.0005)), shift(0, 0, 0.5 + height))
        found = supports(scenery(sheet, CUP), "cup", on_table(0.0), TOUCH_TOLERANCE)
        assert set(found) == ({"sheet"} if rests else set())


@pytest.mark.parametrize("name", SCENES)
def test_shipped_objects_rest_on_what_they_stand_on(name: str) -> None:
    problem, place = scene(name), shipped(name).scenery
    (task,) = problem.tasks
    start = problem.object(task.object).T_world_object
    expected = {
        "wineglass": ({"counter"}, {"dishwasher/lower_rack"}),
        "plate": ({"dishwasher/lower_rack"}, {"wall_cabinet/carcass"}),
    }[name]
    found = [
        set(supports(place, task.object, T, TOUCH_TOLERANCE))
        for T in (start, task.T_world_goal)
    ]
    assert tuple(found) == expected


def test_the_centre_of_mass_is_weighted_by_volume() -> None:
    profile = np.array([[0, 0], [0.2, 0], [0.2, 0.1], [0.1, 0.1], [0.1, 0.3], [0, 0.3]])
    lamp = Object("lamp", Revolve(profile), np.eye(4))
    below, above = 0.04 * 0.1, 0.01 * 0.2
    expected = (below * 0.05 + above * 0.2) / (below + above)
    centre = scenery(lamp).centre_of_mass("lamp")
    np.testing.assert_allclose(centre, [0, 0, expected], atol=1e-4)


def test_the_links_of_a_ground_fixture_are_ground() -> None:
    place = scenery(Obstacle("floor", Box((1, 1, 1)), np.eye(4), ground=True), WALL)
    assert place.is_ground("floor")
    assert place.is_ground("floor/tile")
    assert not place.is_ground("wall")
    assert not place.is_ground("floors")
