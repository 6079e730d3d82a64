"""What holds for the package as a whole: import cost, layers, public names."""

from __future__ import annotations

import importlib.metadata
import json
import subprocess
import sys
from pathlib import Path

import pytest

import mmplan

CHECKOUT = Path(__file__).parents[1]
HEAVY = {"coal", "matplotlib", "ompl", "pinocchio", "scipy", "toppra"}

# Runs the command line in a fresh interpreter and prints what it imported, as JSON.
PROBE = """
import json, sys
from mmplan.cli import main
sys.argv = ["mmplan", *json.loads(sys.argv[1])]
code = 0
try:
    code = main()
except SystemExit as end:
    code = end.code
modules = sorted({name.partition(".")[0] for name in sys.modules})
print(json.dumps({"code": code or 0, "modules": modules}))
"""


def imported_by_command(*arguments: str, cwd: Path) -> tuple[int, set[str]]:
    """The exit code of `mmplan *arguments` and the top-level modules it imported."""
    run = subprocess.run(
        [sys.executable, "-c", PROBE, json.dumps(arguments)],
        capture_output=True,
        text=True,
        check=True,
        cwd=cwd,
    )
    outcome = json.loads(run.stdout.splitlines()[-1])
    return outcome["code"], set(outcome["modules"])


def test_help_imports_nothing_heavy(tmp_path: Path) -> None:
    code, modules = imported_by_command("--help", cwd=tmp_path)
    assert code == 0
    assert not modules & HEAVY


@pytest.mark.parametrize("command", ["solve", "check"])
def test_error_in_scene_file_imports_nothing_heavy(
    command: str, tmp_path: Path
) -> None:
    (tmp_path / "scene.yaml").write_text("mmplan: 1\nobstacle: {}\n")
    code, modules = imported_by_command(command, "scene.yaml", cwd=tmp_path)
    assert code == 2
    assert not modules & HEAVY


def test_error_in_arguments_of_generate_imports_nothing_heavy(tmp_path: Path) -> None:
    arguments = ("generate", "--family", "shelv", "-o", "out")
    code, modules = imported_by_command(*arguments, cwd=tmp_path)
    assert code == 2
    assert not modules & HEAVY


def test_importing_the_package_imports_nothing_heavy() -> None:
    program = "import mmplan, sys; print(*sys.modules)"
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert run.stderr == ""
    assert not {name.partition(".")[0] for name in run.stdout.split()} & HEAVY


def test_public_names_exist() -> None:
    missing = [name for name in mmplan.__all__ if not hasattr(mmplan, name)]
    assert missing == []
    assert {"load_problem", "solve", "verify"} <= set(mmplan.__all__)


def test_type_information_is_shipped() -> None:
    assert (Path(mmplan.__file__).parent / "py.typed").is_file()


def test_robots_and_scenes_hold_no_python() -> None:
    # Such a file would break editable installs.
    folders = (CHECKOUT / "robots", CHECKOUT / "scenes")
    assert [str(p) for folder in folders for p in folder.rglob("*.py")] == []


def test_version_has_a_changelog_entry() -> None:
    version = importlib.metadata.version("mmplan")
    assert f"## [{version}]" in (CHECKOUT / "CHANGELOG.md").read_text()
