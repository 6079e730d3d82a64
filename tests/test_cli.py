"""The command line: exit codes, what goes to stdout and stderr, and no loose ends."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import mmplan
from mmplan import assets
from mmplan.cli import main
from mmplan.plan import Plan
from mmplan.plan_file import plan_schema
from mmplan.terminal import progress_display
from tests.tabletop import cup_scene

COMMAND = (sys.executable, "-m", "mmplan")
FAULTY = Path(__file__).parent / "faulty"
CORPUS = sorted(FAULTY.rglob("*.yaml"))


def run(
    *arguments: str | Path, cwd: Path | None = None
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        cwd=cwd,
    )


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a scene, and its plan made by the command line."""
    folder = tmp_path_factory.mktemp("solved")
    cup_scene(folder)
    done = run(
        "solve", "cup.yaml", "-o", "plan.json", "--seed", "3", "--quiet", cwd=folder
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder


@pytest.fixture
def copied(solved: Path, tmp_path: Path) -> Path:
    """The same folder for a test that changes it."""
    return shutil.copytree(solved, tmp_path / "copied")


# Solving


def test_quiet_success_says_nothing_and_leaves_one_file(solved: Path) -> None:
    assert sorted(p.name for p in solved.iterdir()) == ["cup.yaml", "plan.json"]
    assert Plan.load(solved / "plan.json").seed == 3


def test_the_same_seed_gives_the_same_file_in_another_process(copied: Path) -> None:
    before = (copied / "plan.json").read_text()
    done = run(
        "solve", "cup.yaml", "-o", "plan.json", "--seed", "3", "--json", cwd=copied
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert without_time(before) == without_time((copied / "plan.json").read_text())
    summary = json.loads(done.stdout)
    assert summary["solved"] is True
    assert summary["output"] == "plan.json"
    assert summary["verification"]["ok"] is True
    assert [task["object"] for task in summary["tasks"]] == ["cup"]


def without_time(plan: str) -> str:
    text, n = re.subn(r'"created": "[^"]*"', "", plan)
    assert n == 1
    return text


def test_people_get_tables_on_stdout(
    copied: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(copied)
    assert main(["solve", "cup.yaml", "-o", "other.json", "--seed", "4"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    for word in ("cup, grasp 'side'", "manipulability", "transfer", "verified: "):
        assert word in out
    assert "plan written to other.json" in out
    assert "\x1b" not in out
    assert without_time((copied / "other.json").read_text()) != without_time(
        (copied / "plan.json").read_text()
    )


def test_optimizer_and_evaluations_replace_the_scenes(
    copied: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, out = str(copied / "cup.yaml"), str(copied / "random.json")
    arguments = ["--optimizer", "random", "--evaluations", "400", "--quiet"]
    assert main(["solve", scene, "-o", out, *arguments]) == 0
    assert capsys.readouterr() == ("", "")
    assert main(["solve", scene, "--optimizer", "coevolutoin"]) == 2
    err = capsys.readouterr().err
    assert err.startswith("mmplan: --optimizer: ")
    assert "did you mean 'coevolution'?" in err


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["solve"],
        ["fly"],
        ["solve", "wineglass", "--seed", "-1"],
        ["solve", "wineglass", "--seed", "1.5"],
        ["solve", "wineglass", "--evaluations", "0"],
        ["solve", "wineglass", "--evaluations", "many"],
        ["verify"],
        ["check"],
    ],
    ids=" ".join,
)
def test_wrong_arguments_are_refused(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "usage: mmplan" in err


# Output files


def test_output_that_cannot_be_written_is_refused_before_solving(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mmplan.pipeline.solve", unreachable)
    for output, message in (
        (tmp_path / "no" / "plan.json", "there is no folder"),
        (tmp_path, "is a folder; give the name of a file"),
    ):
        assert main(["solve", "wineglass", "-o", str(output)]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        assert err.startswith(f"mmplan: {output}: {message}")
    assert list(tmp_path.iterdir()) == []


def unreachable(*_: object, **__: object) -> None:
    raise AssertionError("this must not be reached")


HOPELESS = "{evaluations: 60, bases: 8, grasps: 8, partners: 3}"


def hopeless(folder: Path) -> Path:
    """A scene in which the cup can be grasped but not be put where it is wanted."""
    path = cup_scene(folder, optimizer=HOPELESS)
    text = path.read_text().replace(
        "to: {xyz: [0.4, 0.0, 0.88]}", "to: {xyz: [0.4, 0.0, 2.88]}"
    )
    path.write_text(text)
    return path


def test_failure_is_exit_code_1_with_the_account(tmp_path: Path) -> None:
    scene = hopeless(tmp_path)
    (tmp_path / "plan.json").write_text("what stood here")
    done = run("solve", scene, "-o", tmp_path / "plan.json", "--json")
    assert done.returncode == 1
    lines = done.stderr.splitlines()
    assert lines[0] == "mmplan: task 1 (cup): no grasp works at the goal"
    assert any("out of the arm's reach" in line for line in lines)
    content = json.loads(done.stdout)
    assert content["solved"] is False
    assert content["failure"]["reason"] == "no grasp works at the goal"
    assert content["message"] == "\n".join(lines).removeprefix("mmplan: ")
    # The file that was there is as it was, and nothing lies beside it.
    assert (tmp_path / "plan.json").read_text() == "what stood here"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["cup.yaml", "plan.json"]


def test_failure_is_told_even_if_quiet(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["solve", str(hopeless(tmp_path)), "--quiet"]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("mmplan: task 1 (cup): ")


def test_ctrl_c_ends_with_130_and_leaves_nothing(tmp_path: Path) -> None:
    scene = cup_scene(tmp_path)
    arguments = ["solve", scene, "-o", tmp_path / "plan.json", "--evaluations", "9" * 8]
    process = subprocess.Popen(
        [*COMMAND, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    wait_until_it_computes(process.pid)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert (out, err) == ("", "mmplan: interrupted\n")
    assert [p.name for p in tmp_path.iterdir()] == ["cup.yaml"]


def wait_until_it_computes(pid: int) -> None:
    """Until a process has loaded the libraries and half a second more."""
    maps = Path(f"/proc/{pid}/maps")
    for _ in range(600):
        if "ompl" in maps.read_text():
            break
        time.sleep(0.05)
    time.sleep(0.5)


def test_progress_is_shown_on_a_terminal(tmp_path: Path) -> None:
    terminal, end = os.openpty()
    process = subprocess.Popen(
        [*COMMAND, "solve", cup_scene(tmp_path), "--evaluations", "300"],
        stdout=subprocess.DEVNULL,
        stderr=end,
        env={**os.environ, "TERM": "xterm"},
    )
    os.close(end)
    display = b"".join(read_all(terminal))
    os.close(terminal)
    assert process.wait(timeout=60) == 0
    assert b"optimization" in display


def read_all(terminal: int) -> Iterator[bytes]:
    """What is written to a terminal until all have closed it."""
    with contextlib.suppress(OSError):  # how Linux tells the end
        while chunk := os.read(terminal, 1 << 16):
            yield chunk


@pytest.mark.parametrize(("quiet", "terminal"), [(True, True), (False, False)])
def test_no_progress_if_quiet_or_not_on_a_terminal(
    quiet: bool, terminal: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    with progress_display(quiet=quiet) as display:
        assert display is None


# Scenes with faults


def test_the_corpus_is_found() -> None:
    assert len(CORPUS) >= 80


@pytest.mark.parametrize("scene", CORPUS, ids=lambda path: path.stem)
def test_a_faulty_scene_is_one_message_and_exit_code_2(
    scene: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["solve", str(scene)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"mmplan: {scene.parent}{os.sep}")
    assert "Traceback" not in err
    announced = re.findall(
        r"^# expect: (?:\S+\.yaml:)?(\d+):(\d+): ",
        scene.read_bytes().decode("utf-8", "replace"),
        re.M,
    )
    places = re.findall(r"^(?:mmplan: )?/\S+?:(\d+):(\d+): \S", err, re.M)
    assert places[: len(announced)] == announced


@pytest.mark.parametrize("name", ["nan.yaml", "many_faults.yaml", "files/binary.yaml"])
def test_a_faulty_scene_in_a_process_of_its_own(name: str) -> None:
    done = run("solve", FAULTY / name, "--json")
    assert done.returncode == 2
    assert done.stderr.startswith(f"mmplan: {FAULTY / name}:")
    assert "Traceback" not in done.stderr
    content = json.loads(done.stdout)
    assert content["solved"] is False
    for fault in content["faults"]:
        assert fault["file"] == str(FAULTY / name)
        assert fault["message"] in done.stderr


# Checking


def test_check_reports_good_and_bad_scenes_together(
    capsys: pytest.CaptureFixture[str], solved: Path
) -> None:
    good, bad = (
        str(solved / "cup.yaml"),
        [str(FAULTY / n) for n in ("nan.yaml", "tab.yaml")],
    )
    assert main(["check", bad[0], good, bad[1]]) == 2
    out, err = capsys.readouterr()
    assert out == f"{good}: ok: puma_mobile, 2 obstacles, 2 objects, 1 tasks\n"
    assert bad[0] in err
    assert bad[1] in err


def test_check_of_good_scenes(capsys: pytest.CaptureFixture[str], solved: Path) -> None:
    good = str(solved / "cup.yaml")
    assert main(["check", good, good]) == 0
    assert capsys.readouterr().err == ""
    assert main(["check", good, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"ok": True, "faults": []}


def test_check_as_json(capsys: pytest.CaptureFixture[str], solved: Path) -> None:
    assert (
        main(["check", str(solved / "cup.yaml"), str(FAULTY / "nan.yaml"), "--json"])
        == 2
    )
    content = json.loads(capsys.readouterr().out)
    assert content["ok"] is False
    (fault,) = content["faults"]
    assert fault["file"] == str(FAULTY / "nan.yaml")
    assert fault["line"] > 0


# Verifying


def test_verify_finds_the_scene_after_both_have_moved(
    copied: Path, tmp_path: Path
) -> None:
    moved = copied.rename(tmp_path / "moved")
    done = run("verify", moved / "plan.json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("verified: ")
    assert "smallest clearance" in done.stdout


def test_verify_takes_the_scene_where_it_is_told(
    copied: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = (copied / "cup.yaml").rename(tmp_path / "elsewhere.yaml")
    plan = str(copied / "plan.json")
    assert main(["verify", plan]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"mmplan: {plan}: its scene ")
    assert "--scene" in err
    assert main(["verify", plan, "--scene", str(scene), "--json"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert json.loads(out)["ok"] is True


def test_verify_refuses_a_scene_that_has_changed(
    copied: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = copied / "cup.yaml"
    scene.write_text(scene.read_text().replace("[0.6, 1.6, 0.8]", "[0.6, 1.7, 0.8]"))
    assert main(["verify", str(copied / "plan.json")]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert "was made for another state of scene 'tabletop'" in err


def test_verify_refuses_a_plan_that_was_spoiled(
    copied: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = copied / "plan.json"
    plan = json.loads(path.read_text())
    transfer = next(s for s in plan["tasks"][0]["segments"] if s["name"] == "transfer")
    transfer["positions"][len(transfer["positions"]) // 2][0] += 0.3
    path.write_text(json.dumps(plan))
    assert main(["verify", str(path), "--json"]) == 1
    out, err = capsys.readouterr()
    report = json.loads(out)
    assert report["ok"] is False
    assert report["faults"][0]["message"] in err


@pytest.mark.parametrize("content", [b"", b"{}", b"\xff\x00", b"[1, 2"])
def test_verify_refuses_what_is_no_plan(
    content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "plan.json"
    path.write_bytes(content)
    assert main(["verify", str(path)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"mmplan: {path}")
    assert "Traceback" not in err


# What is shipped


def test_every_scene_that_is_shipped_has_a_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["scenes"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    lines = [line.split(maxsplit=1) for line in out.splitlines()]
    assert [name for name, _ in lines] == list(assets.scene_names())
    assert main(["scenes", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [[row["name"], row["description"]] for row in listed] == lines


def test_the_schemas_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == mmplan.scene_schema()
    assert main(["schema", "plan"]) == 0
    assert json.loads(capsys.readouterr().out) == plan_schema()


def test_the_version_is_told() -> None:
    done = run("--version")
    assert (done.returncode, done.stderr) == (0, "")
    assert re.fullmatch(r"\d+\.\d+\.\d+\S*\n", done.stdout)


def test_a_reader_that_leaves_early_is_no_error() -> None:
    process = subprocess.Popen(
        [*COMMAND, "schema"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait(timeout=60) == 0


def test_what_is_shipped_is_listed_without_the_data_of_other_packages(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(assets, "example_robots", lambda: None)
    assert main(["robots", "--json"]) == 0
    told = capsys.readouterr()
    assert [row["name"] for row in json.loads(told.out)] == ["puma_mobile"]
    assert "tiago" in told.err
    assert "pip install 'mmplan[robots]'" in told.err
    assert main(["scenes", "--json"]) == 0
    names = [row["name"] for row in json.loads(capsys.readouterr().out)]
    assert names == list(assets.scene_names())
