"""`mmplan generate`: files, summary, and what is refused."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from mmplan.cli import main
from mmplan.exceptions import NoPlanError
from mmplan.generation import FAMILIES
from mmplan.problem import Problem
from mmplan.scene_file import load_problem

NAMES = ["bin-d0000-s1-000.yaml", "bin-d0000-s1-001.yaml"]


def arguments(folder: Path, *more: str) -> list[str]:
    easy = ["--family", "bin", "--seed", "1", "--difficulty", "0"]
    return ["generate", *easy, "--count", "2", "-o", str(folder), *more]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("generated") / "new"
    assert main(arguments(folder, "--quiet")) == 0
    return folder


def test_the_scenes_are_there_and_pass_the_check(
    made: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert sorted(p.name for p in made.iterdir()) == NAMES
    assert main(["check", *(str(made / name) for name in NAMES)]) == 0
    assert capsys.readouterr().err == ""


def test_the_summary_counts_the_rejected(
    made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments(tmp_path)) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert "2 of 2 scenes drawn were kept, 0 rejected" in out
    for name in NAMES:
        assert (tmp_path / name).read_bytes() == (made / name).read_bytes()


def test_results_for_programs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments(tmp_path, "--json")) == 0
    result = json.loads(capsys.readouterr().out)
    assert result == {"scenes": [str(tmp_path / n) for n in NAMES], "rejected": 0}


def test_planned_scenes_are_those_that_can_be_solved(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried: list[Problem] = []

    def second_time(problem: Problem) -> None:
        tried.append(problem)
        if len(tried) == 1:
            raise NoPlanError("no")

    monkeypatch.setattr("mmplan.pipeline.solve", second_time)
    assert main(arguments(tmp_path, "--count", "1", "--planned")) == 0
    assert "1 of 2 scenes drawn were kept, 1 rejected" in capsys.readouterr().out
    kept = load_problem(tmp_path / NAMES[0])
    assert kept.fingerprint == tried[1].fingerprint != tried[0].fingerprint


def test_scenes_that_are_there_stay(
    made: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = made / NAMES[0]
    before = path.read_bytes()
    path.write_text("mine")
    assert main(arguments(made)) == 2
    assert f"already there: {', '.join(NAMES)}" in capsys.readouterr().err
    assert path.read_text() == "mine"
    assert main(arguments(made, "--overwrite", "--quiet")) == 0
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--family", "kichen"], "unknown family 'kichen'; did you mean 'kitchen'?"),
        (["--difficulty", "2"], "difficulty: expected 0 to 1, got 2"),
        (["--difficulty", "nan"], "difficulty: expected 0 to 1, got nan"),
    ],
)
def test_bad_arguments_are_named_and_leave_no_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], message: str
) -> None:
    folder = tmp_path / "out"
    assert main(arguments(folder, *more)) == 2
    assert message in capsys.readouterr().err
    assert not folder.exists()


@pytest.mark.parametrize("count", ["0", "-1", "x"])
def test_a_count_that_is_none_is_refused(tmp_path: Path, count: str) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(arguments(tmp_path, "--count", count))
    assert stopped.value.code == 2


def test_a_folder_that_cannot_be_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = tmp_path / "a" / "b"
    assert main(arguments(missing)) == 2
    assert f"there is no folder {missing.parent}" in capsys.readouterr().err
    file = tmp_path / "file"
    file.write_text("")
    assert main(arguments(file)) == 2
    assert "is a file; give the name of a folder" in capsys.readouterr().err


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_is_read_only_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tmp_path.chmod(0o500)
    assert main(arguments(tmp_path)) == 2
    assert "cannot be written to" in capsys.readouterr().err


def test_the_help_names_all_families(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["generate", "--help"])
    text = capsys.readouterr().out
    assert all(family in text for family in FAMILIES)
