"""The numbered examples run, say what they should, and leave stderr empty."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
SAID = {
    "01_solve_in_python": "proven; smallest clearance",
    "02_custom_score_term": "'nearness': ",
    "03_custom_grasp_family": "grasp 'above', approach along [ 0.  0. -1.]",
    "04_own_robot": "slow_puma: base of 0.64 m",
    "05_compare_optimizers": "blockwise ",
}
ELSEWHERE = {"06_replay_in_mujoco"}  # takes files, and is tested with the exports


def test_every_numbered_example_is_run() -> None:
    assert {p.stem for p in EXAMPLES.glob("[0-9]*.py")} == set(SAID) | ELSEWHERE


@pytest.mark.parametrize("name", SAID)
def test_an_example_runs(name: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", str(EXAMPLES / f"{name}.py")],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        cwd=tmp_path,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert SAID[name] in done.stdout
    if name == "02_custom_score_term":
        without, with_term = (
            float(line.split(" goes ")[1].split(" m ")[0])
            for line in done.stdout.splitlines()
        )
        assert with_term < without
