"""What YAML means to mmplan."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.exceptions import InputError
from mmplan.files.document import Document
from mmplan.files.yaml_reader import read_document
from mmplan.files.yaml_scalars import parse_scalar


def document(folder: Path, text: str) -> Document:
    path = folder / "some.yaml"
    path.write_text(text, encoding="utf-8")
    return read_document(path)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 0.001),
        ("1E5", 100_000.0),
        ("-.5", -0.5),
        ("5.", 5.0),
        ("012", 12),
        ("-7", -7),
        ("true", True),
        ("false", False),
        ("no", "no"),
        ("yes", "yes"),
        ("on", "on"),
        ("off", "off"),
        ("True", "True"),
        ("1:30", "1:30"),
        ("2026-01-31", "2026-01-31"),
        ("0x1F", "0x1F"),
        ("0o17", "0o17"),
        ("1_000", "1_000"),
        ("1.2.3", "1.2.3"),
        ("'1'", "1"),
        ('"true"', "true"),
        ("99999999999999999999", 1e20),
    ],
)
def test_scalars(tmp_path: Path, text: str, value: object) -> None:
    found = document(tmp_path, f"key: {text}")
    assert found.faults == ()
    assert found.data["key"] == value
    assert type(found.data["key"]) is type(value)


@pytest.mark.parametrize(
    "text", [".nan", "nan", ".inf", "-.Inf", "1e999", "9" * 400, "", "~", "null"]
)
def test_refused_scalars(tmp_path: Path, text: str) -> None:
    (fault,) = document(tmp_path, f"key: {text}").faults
    assert fault.path == ("key",)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_finite_number_is_read_as_written(value: float) -> None:
    assert parse_scalar(repr(value)) == (value, None)


@given(st.text())
def test_no_text_is_read_as_a_number_that_is_not_finite(text: str) -> None:
    value, fault = parse_scalar(text)
    if isinstance(value, float):
        assert math.isfinite(value) or fault


def test_places_of_keys_and_values(tmp_path: Path) -> None:
    found = document(tmp_path, "a:\n  b: [1, {c: 2}]\nd: |\n  text\n")
    assert found.place(("a", "b")) == (2, 6)
    assert found.place(("a", "b"), at_key=True) == (2, 3)
    assert found.place(("a", "b", 1, "c")) == (2, 14)
    assert found.place(("d",)) == (3, 4)
    assert found.place(("a", "absent")) == (1, 1), "the key above"
    assert str(found.diagnostic(("a", "b", 0), "is odd")) == (
        f"{found.path}:2:7: a.b[0]: is odd\n      b: [1, {{c: 2}}]\n          ^"
    )


def test_an_alias_stands_for_its_anchor(tmp_path: Path) -> None:
    found = document(tmp_path, "a: &here [1, 2]\nb: {c: *here}\n")
    assert found.data == {"a": (1, 2), "b": {"c": (1, 2)}}
    assert found.place(("b", "c", 1)) == (1, 14), "where it is written"


def test_a_byte_order_mark_and_dos_line_ends(tmp_path: Path) -> None:
    found = document(tmp_path, "\ufeffa: 1\r\nb: .nan\r\n")
    assert found.place(("b",)) == (2, 4)
    assert found.diagnostic(("b",), "is odd").source == "b: .nan"


def assert_read_or_refused(path: Path) -> None:
    try:
        document = read_document(path)
    except InputError as error:
        diagnostics = error.diagnostics
    else:
        diagnostics = ()
        assert isinstance(document.data, dict)
    assert len(diagnostics) <= 1


@given(st.binary(max_size=200))
def test_any_bytes_are_a_document_or_one_input_error(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.getbasetemp() / "fuzz.yaml"
    path.write_bytes(content)
    assert_read_or_refused(path)


@given(st.text("ab:-[]{}&*!|>'\"%@`#,? \n1.e", max_size=60))
def test_any_text_is_a_document_or_one_input_error(
    tmp_path_factory: pytest.TempPathFactory, text: str
) -> None:
    path = tmp_path_factory.getbasetemp() / "fuzz.yaml"
    path.write_text(text)
    assert_read_or_refused(path)
