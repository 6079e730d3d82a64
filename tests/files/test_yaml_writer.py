"""YAML that mmplan writes is read back as it was, and looks written by hand."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mmplan.files.yaml_reader import read_document
from mmplan.files.yaml_writer import Plain, yaml_text

NUMBERS = st.integers(-1000, 1000) | st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=12)
KEYS = st.from_regex(r"[a-z]{1,8}", fullmatch=True)
VALUES = st.recursive(
    NUMBERS | st.booleans() | TEXTS,
    lambda inner: (
        st.lists(inner, max_size=6) | st.dictionaries(KEYS, inner, max_size=6)
    ),
    max_leaves=30,
)


def as_read(value: object) -> object:
    """The value as the reader gives it, lists as tuples."""
    if isinstance(value, dict):
        return {key: as_read(item) for key, item in value.items()}
    if isinstance(value, list):
        return tuple(as_read(item) for item in value)
    return value


@settings(max_examples=40)
@given(st.dictionaries(KEYS, VALUES, min_size=1, max_size=4))
def test_what_is_written_is_read_back(
    tmp_path_factory: pytest.TempPathFactory, data: dict[str, Plain]
) -> None:
    path = tmp_path_factory.getbasetemp() / "written.yaml"
    path.write_text(yaml_text(data, "a comment"))
    document = read_document(path)
    assert document.faults == ()
    assert document.data == as_read(data)


def test_what_fits_stands_in_one_line() -> None:
    data = {
        "name": "x",
        "walls": {"left": {"box": [1.0, 2.0, 3.0], "at": {"xyz": [0.0, 0.0, 1.0]}}},
        "outline": {"revolve": [[0.001 * i, 0.25] for i in range(20)]},
    }
    lines = yaml_text(data, "one\n\ntwo").splitlines()
    assert lines[:6] == [
        "# one",
        "#",
        "# two",
        "name: x",
        "walls:",
        "  left: {box: [1.0, 2.0, 3.0], at: {xyz: [0.0, 0.0, 1.0]}}",
    ]
    assert "  - [0.001, 0.25]" in lines
