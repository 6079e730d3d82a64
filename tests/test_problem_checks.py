"""Starts and goals that cannot be are refused at their place in the scene."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mmplan.exceptions import InputError
from mmplan.files.document import Document
from mmplan.problem import Object, Obstacle, Problem, Task
from mmplan.problem_checks import check_geometry
from mmplan.shapes import Array, Box, Cylinder, Mesh
from tests.collision.worlds import problem_of, q_tucked
from tests.honest import shift

NO_FILE = Document(Path("scene.yaml"), b"", (), {}, {}, {})
TABLE = Obstacle("table", Box((1.0, 1.0, 0.5)), shift(2.0, 0, 0.25))


def cup(gap: float = 0.0, y: float = 0.0, name: str = "cup") -> Object:
    return Object(name, Cylinder(0.03, 0.1), on_table(gap, y))


def on_table(gap: float = 0.0, y: float = 0.0) -> Array:
    return shift(2.0, y, 0.55 + gap)


def messages(problem: Problem) -> list[str]:
    with pytest.raises(InputError) as error:
        check_geometry(problem, NO_FILE)
    return [diagnostic.message for diagnostic in error.value.diagnostics]


@pytest.mark.parametrize("gap", [-0.0009, 0.0, 0.02])
def test_what_stands_or_floats_is_fine(gap: float) -> None:
    problem = replace(
        problem_of(TABLE, cup(gap)), tasks=(Task("cup", on_table(gap, 0.3)),)
    )
    check_geometry(problem, NO_FILE)


def test_an_object_in_its_support() -> None:
    (fault,) = messages(problem_of(TABLE, cup(-0.0112)))
    assert fault == (
        "objects.cup.at: cup is 11.2 mm deep in table; what it stands on it may "
        "overlap by at most 1 mm"
    )


def test_objects_in_each_other_are_named_both() -> None:
    first, second = messages(problem_of(TABLE, cup(), cup(0.0, 0.05, "mug")))
    assert first.startswith("objects.cup.at: cup is 10.0 mm deep in mug")
    assert second.startswith("objects.mug.at: mug is 10.0 mm deep in cup")


def test_a_thin_sheet_through_an_object_is_a_fault() -> None:
    """It is thinner than the tolerance, but the way out of it is not."""
    sheet = Obstacle("sheet", Box((1, 1, 0.0005)), shift(2.0, 0, 0.505))
    (fault,) = messages(problem_of(TABLE, sheet, cup()))
    assert fault.startswith("objects.cup.at: cup is 5.2 mm deep in sheet")


def test_a_thin_support_may_be_overlapped_by_half_its_thickness() -> None:
    sheet = Obstacle("sheet", Box((1, 1, 0.0005)), shift(2.0, 0, 0.5))
    check_geometry(problem_of(sheet, cup(0.0001)), NO_FILE)
    (fault,) = messages(problem_of(sheet, cup(-0.0001)))
    assert fault.startswith("objects.cup.at: cup is 0.3 mm deep in sheet; ")
    assert fault.endswith(" by at most 0.25 mm")


def test_a_goal_in_a_wall() -> None:
    wall = Obstacle("wall", Box((1.0, 0.1, 2.0)), shift(2.0, 0.4, 1.0))
    tasks = (Task("cup", on_table(0.0, 0.2)), Task("cup", on_table(0.0, 0.33)))
    problem = replace(problem_of(TABLE, wall, cup()), tasks=tasks)
    (fault,) = messages(problem)
    assert fault.startswith("tasks[1].to: cup is 10.0 mm deep in wall")


def test_goals_are_checked_with_objects_where_tasks_leave_them() -> None:
    """The mug may go where the cup stood once the cup has left, and not before."""
    objects = (cup(), cup(0.0, 0.2, "mug"))
    leave, follow = Task("cup", on_table(0.0, -0.2)), Task("mug", on_table())
    problem = replace(problem_of(TABLE, *objects), tasks=(leave, follow))
    check_geometry(problem, NO_FILE)
    (fault,) = messages(replace(problem, tasks=(follow, leave)))
    assert fault.startswith("tasks[0].to: mug is ")
    assert " deep in cup" in fault


def test_a_robot_that_starts_in_something() -> None:
    post = Obstacle("post", Box((0.1, 0.1, 1.0)), shift(0.3, 0, 0.5))
    (fault,) = messages(replace(problem_of(post), q_start=q_tucked()))
    assert fault.startswith(
        "robot.start: the robot starts in collision: base is 30.0 mm"
    )
    assert fault.endswith("deep in post")


def test_a_robot_that_starts_on_the_ground_is_fine() -> None:
    floor = Obstacle("floor", Box((8, 8, 0.1)), shift(0, 0, -0.05), ground=True)
    check_geometry(problem_of(floor), NO_FILE)


def test_at_most_the_three_deepest_contacts_are_told() -> None:
    posts = [
        Obstacle(f"post{i}", Box((0.1, 0.1, 0.2)), shift(*place, 0.1))
        for i, place in enumerate([(0.25, 0), (-0.25, 0), (0, 0.25), (0, -0.25)])
    ]
    assert len(messages(problem_of(*posts))) == 3


def test_shapes_that_cannot_be_made_are_all_told_and_nothing_else(
    tmp_path: Path,
) -> None:
    broken, missing = tmp_path / "broken.stl", tmp_path / "missing.obj"
    broken.write_text("nothing")
    problem = problem_of(
        Obstacle("shelf", Mesh(broken), np.eye(4)),
        TABLE,
        Object("toy", Mesh(missing), np.eye(4)),
        cup(-0.02),
    )
    shelf, toy = messages(problem)
    assert shelf.startswith(f"obstacles.shelf: {broken}: this mesh cannot be read: ")
    assert toy.startswith(f"objects.toy: {missing}: cannot be read: ")
