"""The stand-alone replays, each in a process of its own, say what the plan says."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mmplan.cli import main
from mmplan.hermite import HermiteCurve
from tests.exports.conftest import Solved

EXAMPLES = Path(__file__).parents[2] / "examples"
TIME = 2.345


def run(script: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-W", "error", str(script), *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


@pytest.mark.parametrize("name", ["csv", "npz", "ros-yaml", "mcap", "rosbag2"])
def test_a_replay_finds_the_joints_at_any_time(
    name: str, solved: Solved, tmp_path: Path
) -> None:
    path = tmp_path / "exported"
    assert main(["export", str(solved.path), "--to", name, "-o", str(path)]) == 0
    script = EXAMPLES / "replays" / f"replay_{name.replace('-', '_')}.py"
    done = run(script, path, str(TIME))
    assert (done.returncode, done.stderr) == (0, "")
    curve = HermiteCurve(solved.times, solved.positions, solved.velocities)
    (q,) = curve.positions(np.array([TIME]))
    wanted = dict(zip(solved.plan.joints, q.tolist(), strict=True))
    told = [line.split() for line in done.stdout.splitlines() if " at " not in line]
    assert len(told) >= len(wanted) - 2
    for joint, value in told:
        assert float(value) == pytest.approx(wanted[joint], abs=1e-6)


@pytest.fixture(scope="module")
def in_mujoco(solved: Solved, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with all that the replay in MuJoCo takes."""
    folder = tmp_path_factory.mktemp("mujoco")
    scene = folder / "scene.xml"
    assert main(["export", str(solved.path), "--to", "mjcf", "-o", str(scene)]) == 0
    command = [sys.executable, "-m", "mmplan.cli", "robot", "urdf", "puma_mobile"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    (folder / "robot.urdf").write_text(done.stdout)
    (folder / "plan.json").write_text(solved.path.read_text())
    return folder


def replay_in_mujoco(folder: Path) -> subprocess.CompletedProcess[str]:
    script = EXAMPLES / "06_replay_in_mujoco.py"
    files = [folder / name for name in ("plan.json", "robot.urdf", "scene.xml")]
    return run(script, *files)


def test_mujoco_agrees_that_the_plan_does_what_it_promises(in_mujoco: Path) -> None:
    done = replay_in_mujoco(in_mujoco)
    assert (done.returncode, done.stderr) == (0, "")
    assert "every object is at its goal" in done.stdout


def test_mujoco_finds_fault_with_a_plan_that_was_tampered_with(
    in_mujoco: Path,
) -> None:
    file = in_mujoco / "plan.json"
    plan = json.loads(file.read_text())
    for segment in plan["tasks"][0]["segments"]:
        for q in segment["positions"]:
            q[0] += 0.08  # the base stands 8 cm nearer to the table
    (in_mujoco / "tampered").mkdir()
    for name in ("robot.urdf", "scene.xml"):
        (in_mujoco / "tampered" / name).write_text((in_mujoco / name).read_text())
    (in_mujoco / "tampered" / "plan.json").write_text(json.dumps(plan))
    done = replay_in_mujoco(in_mujoco / "tampered")
    assert done.returncode == 1
    assert "FAULT: " in done.stdout
