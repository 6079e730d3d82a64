"""Files of path problems."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.exceptions import InputError
from mmplan.shapes import Box, Cylinder, Sphere
from tests.benchmarking.paths.made import (
    HOME,
    MOTIONBENCHMAKER,
    problem,
    problem_file,
    thing,
)


def test_all_problems_of_motionbenchmaker_are_read() -> None:
    found = load_path_problems(MOTIONBENCHMAKER)
    assert found.name == "panda_motionbenchmaker"
    assert len(found.families) == 7
    for family in found.families:
        numbers = [p.number for p in found.problems if p.family == family]
        assert numbers == list(range(1, 11))


def test_packed_and_plain_files_are_the_same(tmp_path: Path) -> None:
    plain = problem_file(tmp_path)
    packed = tmp_path / "p.json.gz"
    packed.write_bytes(gzip.compress(plain.read_bytes()))
    first, second = load_path_problems(plain), load_path_problems(packed)
    assert (first.name, first.fingerprint) == (second.name, second.fingerprint)
    np.testing.assert_array_equal(first.problems[0].q_goal, second.problems[0].q_goal)
    plain.unlink()
    assert load_path_problems(plain).path == packed


def test_shapes_and_their_sizes(tmp_path: Path) -> None:
    things = [
        thing(),
        thing(type="cylinder", dims=[0.4, 0.1]),
        thing(type="sphere", dims=[0.2]),
    ]
    (read,) = load_path_problems(
        problem_file(tmp_path, problem(objects=things))
    ).problems
    shapes = [o.shape for o in read.obstacles]
    assert shapes == [Box((0.06, 0.06, 1.0)), Cylinder(0.1, 0.4), Sphere(0.2)]
    assert len({o.name for o in read.obstacles}) == 3
    np.testing.assert_array_equal(read.obstacles[0].T_world_obstacle, thing()["pose"])


TURNED_OVER = np.diag([1.0, 1.0, -1.0, 1.0]).tolist()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"objects": [thing(type="torus")]}, "'torus'"),
        ({"objects": [thing(dims=[1.0, 2.0])]}, "a box has [x, y, z]; got 2 numbers"),
        ({"objects": [thing(dims=[1.0, 2.0, -1.0])]}, "must be greater than 0, got -1"),
        ({"objects": [thing(pose=TURNED_OVER)]}, "not a pose"),
        ({"objects": [thing(pose=[[1.0]])]}, "expected 4"),
        ({"objects": [thing(colour="red")]}, "unknown key 'colour'"),
        ({"goal": [0.0]}, "1 joints; the start has 7"),
        ({"start": ["up", *HOME[1:]]}, "expected a number, got 'up'"),
        ({"family": 3}, "expected text, got 3"),
    ],
)
def test_faults_are_told_with_their_places(
    tmp_path: Path, changes: dict[str, Any], message: str
) -> None:
    path = tmp_path / "p.json"
    lines = json.dumps(problem(), indent=1), json.dumps(problem(index=2) | changes)
    path.write_text('{"pillar": [\n' + ",\n".join(lines) + "]}")
    line = lines[0].count("\n") + 3
    with pytest.raises(InputError) as error:
        load_path_problems(path)
    first = error.value.diagnostics[0]
    assert message in first.message
    assert first.message.startswith("pillar[1].")
    assert (first.file, first.line) == (str(path), line)
    assert first.column is not None


def test_a_missing_key_is_named(tmp_path: Path) -> None:
    faulty = problem()
    del faulty["goal"]
    with pytest.raises(
        InputError, match=r"p.json:1:\d+: pillar\[0\]: missing key 'goal"
    ):
        load_path_problems(problem_file(tmp_path, faulty))


def test_places_are_left_out_where_a_file_is_huge(tmp_path: Path) -> None:
    path = problem_file(tmp_path, problem(goal=[0.0]))
    path.write_text(path.read_text() + " " * 1_000_000)
    with pytest.raises(InputError, match=r"p.json: pillar\[0\].goal: 1 joints"):
        load_path_problems(path)


def test_two_problems_of_one_index_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="two problems have the index 1"):
        load_path_problems(problem_file(tmp_path, problem(), problem()))


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("p.json", b'{"a": [}', r"p.json:1:8: not JSON: Expecting value"),
        ("p.json", b"\xff\xfe\xfd", "p.json: not JSON"),
        ("p.json", b"[]", "p.json: expected families of problems"),
        ("p.json.gz", b"{}", "p.json.gz: is not packed by gzip, or damaged"),
        ("p.json.gz", gzip.compress(b"{}" * 99)[:-9], "p.json.gz: is not packed"),
        ("p.yaml", b"{}", "p.yaml: problems are read from .json and .json.gz files"),
    ],
)
def test_what_is_no_file_of_problems_is_refused(
    tmp_path: Path, name: str, content: bytes, message: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=message):
        load_path_problems(tmp_path / name)


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none.json: no such file"):
        load_path_problems(tmp_path / "none.json")
