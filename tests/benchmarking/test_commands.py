"""`mmplan benchmark` and `mmplan benchmark report`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mmplan.cli import main
from tests.benchmarking.made import contest_scene, stored

SMALL = ("--runs", "2", "--evaluations", "60,90")


def test_a_benchmark_and_its_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, folder = str(contest_scene(tmp_path)), str(tmp_path / "results")
    assert main(["benchmark", scene, "-o", folder, *SMALL, "--seed", "5"]) == 0
    told = capsys.readouterr()
    assert told.out.startswith("8 runs done, 0 were there before\n")
    assert told.err == ""
    assert {(r.seed, r.evaluations) for r in stored(Path(folder))} == {
        (seed, budget) for seed in (5, 6) for budget in (60, 90)
    }
    assert main(["benchmark", scene, "-o", folder, *SMALL, "--seed", "5"]) == 0
    assert capsys.readouterr().out.startswith("0 runs done, 8 were there before\n")
    assert main(["benchmark", "report", folder]) == 0
    shown = capsys.readouterr().out
    assert "CoEvolution − RandomSampling" in shown
    assert shown.endswith(f"written to {folder}/report.html\n")


def test_results_for_programs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, folder = str(contest_scene(tmp_path)), str(tmp_path / "results")
    contest = ("--optimizers", "random", "--runs", "1", "--evaluations", "200")
    assert main(["benchmark", scene, "-o", folder, *contest, "--plan", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"before": 0, "done": 1, "left": 0}
    assert main(["benchmark", "report", folder, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert Path(report["page"]).is_file()
    assert report["tables"][0]["rows"][0][2] == "RandomSampling+RRTConnect"
    assert "Motions" in [table["title"] for table in report["tables"]]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--optimizers", "coevolutoin"), "did you mean 'coevolution'?"),
        (("--planners", "RRTConect"), "did you mean 'RRTConnect'?"),
    ],
)
def test_unknown_names_are_refused(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
    message: str,
) -> None:
    scene, folder = str(contest_scene(tmp_path)), tmp_path / "results"
    assert main(["benchmark", scene, "-o", str(folder), *options]) == 2
    assert message in capsys.readouterr().err
    assert not folder.exists()


def test_a_scene_with_several_tasks_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = str(Path(__file__).parents[1] / "scenes" / "tabletop.yaml")
    assert main(["benchmark", scene, "-o", str(tmp_path / "results")]) == 2
    assert "has 2 tasks; a benchmark wants scenes with one" in capsys.readouterr().err


def test_two_scenes_of_one_name_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenes = [str(contest_scene(folder)) for folder in folders(tmp_path)]
    Path(scenes[1]).write_text(Path(scenes[0]).read_text() + "# another\n")
    assert main(["benchmark", *scenes, "-o", str(tmp_path / "results")]) == 2
    assert "has the name 'tabletop', as" in capsys.readouterr().err


def folders(parent: Path) -> list[Path]:
    made = [parent / "first", parent / "second"]
    for folder in made:
        folder.mkdir()
    return made


@pytest.mark.parametrize(
    "options",
    [
        ("--runs", "0"),
        ("--jobs", "two"),
        ("--evaluations", "500,,2000"),
        ("--jobs", "2", "--scheduler", "tcp://127.0.0.1:1"),
    ],
)
def test_options_without_sense_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["benchmark", "wineglass", "-o", str(tmp_path), *options])
    assert "usage: mmplan benchmark" in capsys.readouterr().err


def test_a_report_of_nothing_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["benchmark", "report", str(tmp_path)]) == 2
    assert "holds no results" in capsys.readouterr().err


def test_help_tells_of_both(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        main(["benchmark", "report", "--help"])
    assert "usage: mmplan benchmark report" in capsys.readouterr().out
