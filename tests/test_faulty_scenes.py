"""Every faulty scene of the corpus is refused with exactly the faults it announces.

A file of `faulty/` begins with one comment a fault: `# expect: line:column: message`,
with the name of the file in front where that is another one.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.exceptions import InputError
from mmplan.scene_file import load_problem
from mmplan.scene_reader import read_scene

CORPUS = Path(__file__).parent / "faulty"
SCENES = sorted(CORPUS.glob("*.yaml"))  # that need no geometry to be refused
GEOMETRY = sorted((CORPUS / "geometry").glob("*.yaml"))
EXPECTATION = re.compile(r"# expect: (?:(\S+\.yaml):)?(\d+):(\d+): (.*)")


def faults_of(path: Path) -> InputError:
    with pytest.raises(InputError) as caught:
        read_scene(path)
    return caught.value


def expectations(path: Path) -> list[tuple[str, int, int, str]]:
    found = []
    for line in path.read_text().splitlines():
        if match := EXPECTATION.fullmatch(line):
            file, row, column, message = match.groups()
            found.append((file or path.name, int(row), int(column), message))
    return found


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_faulty_scene_names_exactly_its_faults(path: Path) -> None:
    expected = expectations(path)
    assert expected, "every file of the corpus says what it expects"
    assert_expected(expected, faults_of(path))


@pytest.mark.parametrize("path", GEOMETRY, ids=lambda path: path.stem)
def test_a_fault_of_geometry_has_its_place_too(path: Path) -> None:
    read_scene(path)
    with pytest.raises(InputError) as caught:
        load_problem(path)
    assert_expected(expectations(path), caught.value)


def assert_expected(
    expected: list[tuple[str, int, int, str]], error: InputError
) -> None:
    found = error.diagnostics
    for diagnostic, (file, line, column, message) in zip(found, expected, strict=True):
        assert Path(diagnostic.file or "").name == file
        assert (diagnostic.line, diagnostic.column) == (line, column)
        assert diagnostic.message.startswith(message)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_fault_shows_the_line_with_a_caret_below_the_place(path: Path) -> None:
    for diagnostic in faults_of(path).diagnostics:
        lines = Path(diagnostic.file or "").read_text().splitlines()
        if diagnostic.line is None or diagnostic.line > len(lines):
            continue  # the end of the file has no line to show
        line = lines[diagnostic.line - 1].replace("\t", " ")
        assert diagnostic.source == line[:120]
        caret = str(diagnostic).splitlines()[-1]
        assert caret == " " * (4 + (diagnostic.column or 0) - 1) + "^"


def test_the_corpus_is_large() -> None:
    assert len(SCENES) >= 80


@pytest.mark.parametrize(
    ("name", "place", "message"),
    [
        ("binary.yaml", (1, 11), "not UTF-8 text: found the byte 0x80"),
        ("empty.yaml", (None, None), "the file is empty"),
        ("comment.yaml", (None, None), "the file is empty"),
        ("list.yaml", (1, 1), "expected 'key: value' lines at the top level"),
        ("latin1.yaml", (2, 10), "not UTF-8 text: found the byte 0xe9"),
        ("control.yaml", (2, 13), "not a text file: found the control character"),
        ("", (None, None), "is a folder, not a file"),
        ("absent.yaml", (None, None), "no such file"),
        ("empty.yaml/absent.yaml", (None, None), "no such file"),
    ],
)
def test_a_file_that_is_no_scene(
    name: str, place: tuple[int | None, int | None], message: str
) -> None:
    (diagnostic,) = faults_of(CORPUS / "files" / name).diagnostics
    assert (diagnostic.line, diagnostic.column) == place
    assert diagnostic.message.startswith(message)


def test_a_huge_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.yaml"
    path.write_text("a: 1\n" * 300_000)
    (diagnostic,) = faults_of(path).diagnostics
    assert diagnostic.message == "is too large: at most 1,000,000 bytes are read"


def test_a_misspelled_scene_is_guessed(tmp_path: Path) -> None:
    (diagnostic,) = faults_of(tmp_path / "wineglas.yaml").diagnostics
    assert diagnostic.message.startswith("no such file; did you mean 'wineglass'?")


@pytest.mark.parametrize("key", ["mesh: {}.obj", "urdf: {}"])
def test_a_name_that_no_file_can_have(tmp_path: Path, key: str) -> None:
    text = (CORPUS / "missing_mesh.yaml").read_text()
    path = tmp_path / "long.yaml"
    path.write_text(text.replace("mesh: meshes/counter.obj", key.format("a" * 5000)))
    (diagnostic,) = faults_of(path).diagnostics
    assert "no such file" in diagnostic.message
    assert "cannot be read" in str(faults_of(tmp_path / ("a" * 5000)))


@given(
    where=st.floats(0, 1),
    length=st.integers(0, 12),
    what=st.sampled_from(
        ["", "[", "{", "&a ", "*a", "-1", "x", ": ", "\n", "1e9", "true"]
    ),
)
def test_a_damaged_scene_loads_or_is_refused(
    tmp_path_factory: pytest.TempPathFactory, where: float, length: int, what: str
) -> None:
    text = (CORPUS / "many_faults.yaml").read_text().partition("mmplan:")
    scene = text[1] + text[2]
    start = int(where * len(scene))
    path = tmp_path_factory.getbasetemp() / "damaged.yaml"
    path.write_text(scene[:start] + what + scene[start + length :])
    for diagnostic in faults_of(path).diagnostics:
        assert diagnostic.file
