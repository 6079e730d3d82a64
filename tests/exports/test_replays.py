"""The stand-alone replays, each in a process of its own, say what the plan says."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest

from mmplan.cli import main
from mmplan.collision import CollisionWorld, Scenery
from mmplan.hermite import HermiteCurve
from mmplan.robot_build import load_robot
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
    command = [sys.executable, "-m", "mmplan", "robot", "urdf", "puma_mobile"]
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


# Of these, arms of the second and the third stand on a link called `world`.
@pytest.mark.parametrize("name", ["puma_mobile", "ur5_mobile", "xarm7_mobile"])
def test_the_urdf_of_the_whole_robot_moves_the_tool_as_planned(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["robot", "urdf", name]) == 0
    root = ET.fromstring(capsys.readouterr().out)
    for link in root.findall("link"):
        for body in (*link.findall("visual"), *link.findall("collision")):
            link.remove(body)
    settings = {"fusestatic": "false", "boundmass": "1e-6", "boundinertia": "1e-6"}
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", settings)
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    data, robot = mujoco.MjData(model), load_robot(name)
    rng = np.random.default_rng(0)
    low, high = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    q = rng.uniform(np.maximum(low, -3.0), np.minimum(high, 3.0))
    places = [model.joint(n).qposadr[0] for n in list(robot.model.names)[1:]]
    data.qpos[places] = q
    mujoco.mj_kinematics(model, data)
    tool = data.body("tool")
    T_world_tool = robot.tool_pose(q)
    assert tool.xpos == pytest.approx(T_world_tool[:3, 3], abs=1e-6)
    assert tool.xmat == pytest.approx(T_world_tool[:3, :3].ravel(), abs=1e-6)


def tampered(folder: Path, name: str, plan: dict[str, Any]) -> Path:
    """Another folder with a plan that is not mmplan's any more."""
    (folder / name).mkdir()
    for file in ("robot.urdf", "scene.xml"):
        (folder / name / file).write_text((folder / file).read_text())
    (folder / name / "plan.json").write_text(json.dumps(plan))
    return folder / name


def test_mujoco_finds_fault_with_a_plan_that_was_tampered_with(
    in_mujoco: Path,
) -> None:
    plan = json.loads((in_mujoco / "plan.json").read_text())
    for segment in plan["tasks"][0]["segments"]:
        for q in segment["positions"]:
            q[0] += 0.08  # the base stands 8 cm nearer to the table
    done = replay_in_mujoco(tampered(in_mujoco, "nearer", plan))
    assert done.returncode == 1
    assert "FAULT: " in done.stdout


def test_mujoco_finds_the_robot_touching_itself(in_mujoco: Path) -> None:
    plan = json.loads((in_mujoco / "plan.json").read_text())
    (task,) = plan["tasks"]
    del task["segments"][1:]
    (transit,) = task["segments"]
    robot, rng = load_robot("puma_mobile"), np.random.default_rng(0)
    world = CollisionWorld(robot, Scenery((), frozenset(), {}), {})
    q = np.tile(transit["positions"][0], (5000, 1))
    q[:, robot.arm.indices] = rng.uniform(robot.arm.lower, robot.arm.upper, (5000, 6))
    touching = q[np.flatnonzero(world.in_collision(q))[0]]
    transit["positions"][1:] = [touching.tolist()] * (len(transit["times"]) - 1)
    (contact, *_) = world.contacts(touching)
    done = replay_in_mujoco(tampered(in_mujoco, "folded", plan))
    assert done.returncode == 1
    pair = " touches ".join(sorted(f"robot:{n}" for n in contact[:2]))
    assert f"FAULT: {pair}: " in done.stdout
