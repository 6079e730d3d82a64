"""The JSON schema says what the reader says."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from mmplan import assets
from mmplan.files.yaml_reader import read_document
from mmplan.schema import robot_schema, scene_schema

FAULTY = Path(__file__).parent / "faulty"
FAULTY_ROBOTS = Path(__file__).parent / "faulty_robots"


@pytest.fixture(scope="module")
def validator() -> Draft202012Validator:
    schema = scene_schema()
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


@pytest.fixture(scope="module")
def robots() -> Draft202012Validator:
    schema = robot_schema()
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def as_json(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: as_json(v) for k, v in value.items()}
    return [as_json(v) for v in value] if isinstance(value, tuple) else value


def faults(validator: Draft202012Validator, path: Path) -> list[str]:
    return [e.message for e in validator.iter_errors(as_json(read_document(path).data))]


@pytest.mark.parametrize("name", assets.scene_names())
def test_shipped_scenes_conform(validator: Draft202012Validator, name: str) -> None:
    assert faults(validator, assets.scenes_folder() / f"{name}.yaml") == []


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("unknown_key", "masss"),
        ("misspelled_key", "obstacels"),
        ("missing_key", "length"),
        ("missing_robot", "robot"),
        ("too_few_numbers", "too short"),
        ("too_many_numbers", "[1.5, 0.0, 0.45, 1.0]"),
        ("text_for_number", "3cm"),
        ("zero_size", "0"),
        ("millimetres", "95000"),
        ("degrees", "90"),
        ("no_shape", "not valid under any"),
        ("two_shapes", "valid under each of"),
        ("bad_name", "kitchen counter"),
        ("unknown_optimizer", "coevolutoin"),
        ("no_evaluations", "0"),
        ("unknown_family", "not valid under any"),
        ("empty_tasks", "should be non-empty"),
        ("missing_value", "None"),
        ("version", "1 was expected"),
    ],
)
def test_faults_that_an_editor_shows(
    validator: Draft202012Validator, name: str, word: str
) -> None:
    messages = faults(validator, FAULTY / f"{name}.yaml")
    assert any(word in message for message in messages), messages


@pytest.mark.parametrize("name", assets.robot_names())
def test_shipped_robots_conform(robots: Draft202012Validator, name: str) -> None:
    path = assets.robots_folder() / name / assets.ROBOT_FILE
    assert faults(robots, path) == []


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("sound", ""),
        ("base_type", "plannar"),
        ("type_unknown", "spherical"),
        ("collision_kind", "hulls"),
        ("two_shapes", "valid under each of"),
    ],
)
def test_faults_of_robots_that_an_editor_shows(
    robots: Draft202012Validator, name: str, word: str
) -> None:
    messages = faults(robots, FAULTY_ROBOTS / f"{name}.yaml")
    assert any(word in message for message in messages) == bool(word), messages


@pytest.mark.parametrize("kind", ["validator", "robots"])
def test_every_key_is_described(kind: str, request: pytest.FixtureRequest) -> None:
    keys = list(_properties(request.getfixturevalue(kind).schema))
    assert len(keys) > 40
    for key, schema in keys:
        assert schema.get("description") or "$ref" in schema, key


def test_the_robots_are_listed(validator: Draft202012Validator) -> None:
    model = validator.schema["$defs"]["RobotSection"]["properties"]["model"]
    assert model["anyOf"][0] == {"enum": list(assets.robot_names())}


def _properties(node: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    if isinstance(node, dict):
        yield from node.get("properties", {}).items()
        for value in node.values():
            yield from _properties(value)
