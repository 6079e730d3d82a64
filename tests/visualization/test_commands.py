"""`mmplan view`, `mmplan render` and `mmplan solve --html`, as a person types them."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from mmplan.cli import main
from tests.tabletop import SCENE, cup_scene

COMMAND = (sys.executable, "-m", "mmplan")


@pytest.mark.parametrize("subject", ["plan", "scene"])
def test_the_viewer_serves_this_machine_alone_until_ctrl_c(
    subject: str, plan_file: Path
) -> None:
    path = plan_file if subject == "plan" else SCENE
    process = subprocess.Popen(
        [*COMMAND, "view", str(path), "--port", "8123"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    url = process.stdout.readline().strip()
    assert url.startswith("http://127.0.0.1:81")
    assert_serves(url, process)
    out, err = ended(process)
    assert (process.returncode, out) == (0, "")
    assert err == "open this in a browser; Ctrl-C ends\n"


def test_solve_shows_the_plan_and_leaves_stdout_to_its_results(
    tmp_path: Path,
) -> None:
    asked = ("--seed", "3", "--view", "--json", "--quiet")
    process = subprocess.Popen(
        [*COMMAND, "solve", str(cup_scene(tmp_path)), *asked],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    url, note = (process.stderr.readline() for _ in range(2))
    assert url.startswith("http://127.0.0.1:")
    assert note == "open this in a browser; Ctrl-C ends\n"
    assert_serves(url.strip(), process)
    out, err = ended(process)
    assert (process.returncode, err) == (0, "")
    assert json.loads(out)["solved"] is True


def assert_serves(url: str, process: subprocess.Popen[str]) -> None:
    """There is a page at that address, and the process listens nowhere else."""
    with urllib.request.urlopen(url, timeout=60) as page:
        assert b"<html" in page.read()
    port = int(url.rpartition(":")[2])
    assert listening(process.pid) == {("0100007F", port)}


def ended(process: subprocess.Popen[str]) -> tuple[str, str]:
    """What is left of stdout and stderr after Ctrl-C."""
    process.send_signal(signal.SIGINT)
    return process.communicate(timeout=60)


def listening(pid: int) -> set[tuple[str, int]]:
    """The addresses (IPv4, as Linux writes them) and ports a process listens at."""
    sockets = set()
    for link in Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):  # closed in the meantime
            target = str(link.readlink())
            if target.startswith("socket:["):
                sockets.add(target[8:-1])
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/{pid}/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A" and fields[9] in sockets:
                address, _, port = fields[1].partition(":")
                found.add((address, int(port, 16)))
    return found


def test_render_writes_what_the_name_says(
    plan_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "plan.html"
    assert main(["render", str(plan_file), "-o", str(page)]) == 0
    assert capsys.readouterr() == (f"written to {page}\n", "")
    assert page.read_text().startswith("<!DOCTYPE html>")
    assert main(["render", str(SCENE), "-o", str(tmp_path / "s.html"), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "plan.jpg"], "plan.jpg: expected a name in .html, .png"),
        (["-o", "no/plan.png"], "no/plan.png: there is no folder"),
        (["-o", "plan.png", "--hide", "robots"], "did you mean 'robot'?"),
        (["-o", "plan.png", "--camera", "left"], "--camera: expected auto, top"),
        (["-o", "plan.png", "--time", "-1"], "--time: the motion lasts"),
    ],
    ids=lambda value: value[1] if isinstance(value, list) else "",
)
def test_what_cannot_be_rendered_is_refused(
    arguments: list[str],
    message: str,
    plan_file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    # An option's value that begins with a dash needs the sign of equality.
    joined = [*arguments[:2], *(["=".join(arguments[2:])] if arguments[2:] else [])]
    assert main(["render", str(plan_file), *joined]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert message in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("size", ["640", "640x", "8x8", "9000x100", "-1x5"])
def test_a_size_is_two_numbers(size: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["render", "wineglass", "-o", "x.png", f"--size={size}"])
    assert "--size" in capsys.readouterr().err


def test_a_plan_of_another_scene_is_refused(
    plan_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changed = tmp_path / "changed.yaml"
    changed.write_text(SCENE.read_text().replace("[0.6, 1.6, 0.8]", "[0.6, 1.7, 0.8]"))
    arguments = ["-o", str(tmp_path / "x.html"), "--scene", str(changed)]
    assert main(["render", str(plan_file), *arguments]) == 2
    assert "made for another state of scene" in capsys.readouterr().err


def test_solve_writes_the_page_beside_the_plan(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, page = cup_scene(tmp_path), tmp_path / "plan.html"
    assert (
        main(["solve", str(scene), "--seed", "3", "--html", str(page), "--json"]) == 0
    )
    assert json.loads(capsys.readouterr().out)["solved"] is True
    assert "transfer" in page.read_text()
    assert main(["solve", str(scene), "--html", str(tmp_path / "no" / "x.html")]) == 2
    assert "there is no folder" in capsys.readouterr().err
