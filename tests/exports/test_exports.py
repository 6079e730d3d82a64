"""Every export, read back by a reader that is none of mmplan's, says the same."""

from __future__ import annotations

import csv
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from mmplan.cli import main
from mmplan.exports import EXPORTS
from tests.exports.conftest import Solved


@pytest.fixture
def exported(request: pytest.FixtureRequest, solved: Solved, tmp_path: Path) -> Path:
    """The plan in the format that the test asks for, written by the command line."""
    path = tmp_path / "exported"
    assert (
        main(["export", str(solved.path), "--to", request.param, "-o", str(path)]) == 0
    )
    return path


def exports(name: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("exported", [name], indirect=True)


def poses_of_the_cup(solved: Solved) -> np.ndarray:
    """Where the cup is at each sample by forward kinematics, (n, 4, 4)."""
    robot, (task,) = solved.problem.robot, solved.plan.tasks
    poses, row = [], 0
    for number, segment in enumerate(task.segments):
        for q in segment.positions[1 if number else 0 :]:
            held = segment.attached.get("cup")
            still = segment.objects["cup"]
            poses.append(still if held is None else robot.tool_pose(q) @ held)
            row += 1
    assert row == len(solved.times)
    return np.array(poses)


def matrix(x: float, y: float, z: float, w: float) -> np.ndarray:
    """The rotation of a unit quaternion, as MuJoCo sees it."""
    R = np.empty(9)
    mujoco.mju_quat2Mat(R, np.array([w, x, y, z]))
    return R.reshape(3, 3)


@exports("csv")
def test_csv(exported: Path, solved: Solved) -> None:
    with exported.open(newline="") as file:
        rows = list(csv.DictReader(file))
    joints = solved.plan.joints
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    assert np.array_equal(np.array(columns["time"], float), solved.times)
    for values, suffix in ((solved.positions, ""), (solved.velocities, "_velocity")):
        read = np.array([columns[f"{j}{suffix}"] for j in joints], float).T
        assert np.array_equal(read, values)
    names = list(dict.fromkeys(columns["segment"]))
    assert names == [s.name for s in solved.plan.tasks[0].segments]
    xyz = np.array([columns[f"cup_{axis}"] for axis in "xyz"], float).T
    assert np.allclose(xyz, poses_of_the_cup(solved)[:, :3, 3], atol=1e-9)


@exports("npz")
def test_npz(exported: Path, solved: Solved) -> None:
    with np.load(exported, allow_pickle=False) as arrays:
        assert tuple(arrays["joints"]) == solved.plan.joints
        assert np.array_equal(arrays["times"], solved.times)
        assert np.array_equal(arrays["positions"], solved.positions)
        assert np.array_equal(arrays["velocities"], solved.velocities)
        assert arrays["segment_ends"][-1] == pytest.approx(solved.plan.duration)
        for pose, T in zip(arrays["object_cup"], poses_of_the_cup(solved), strict=True):
            assert np.allclose(pose[:3], T[:3, 3], atol=1e-9)
            assert np.allclose(matrix(*pose[3:]), T[:3, :3], atol=1e-9)


@exports("ros-yaml")
def test_ros_yaml(exported: Path, solved: Solved) -> None:
    message, end = yaml.safe_load_all(exported.read_text())
    assert end is None
    arm = message["joint_trajectory"]
    robot = solved.problem.robot
    names = [*robot.arm.names, *robot.hand.names]
    assert sorted(arm["joint_names"]) == sorted(names)
    which = [solved.plan.joints.index(name) for name in arm["joint_names"]]
    read = np.array([point["positions"] for point in arm["points"]])
    assert np.array_equal(read, solved.positions[:, which])
    read = np.array([point["velocities"] for point in arm["points"]])
    assert np.array_equal(read, solved.velocities[:, which])
    times = [seconds(p["time_from_start"]) for p in arm["points"]]
    assert np.allclose(times, solved.times, atol=1e-9)
    base = message["multi_dof_joint_trajectory"]
    assert base["joint_names"] == ["base"]
    xy = [
        [p["transforms"][0]["translation"][axis] for axis in "xy"]
        for p in base["points"]
    ]
    assert np.allclose(xy, solved.positions[:, robot.base.indices])


def seconds(time: dict[str, int]) -> float:
    assert set(time) == {"sec", "nanosec"}
    assert 0 <= time["nanosec"] < 1_000_000_000
    return time["sec"] + 1e-9 * time["nanosec"]


@exports("mcap")
def test_mcap(exported: Path, solved: Solved) -> None:
    with exported.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        read = [
            (channel.topic, record.log_time, message)
            for _, channel, record, message in reader.iter_decoded_messages()
        ]
    compare_recording(read, solved)


@exports("rosbag2")
def test_rosbag2(exported: Path, solved: Solved) -> None:
    types = get_typestore(Stores.ROS2_HUMBLE)
    with Reader(exported) as bag:
        read = [
            (c.topic, time, types.deserialize_cdr(data, c.msgtype))
            for c, time, data in bag.messages()
        ]
    compare_recording(read, solved)


def compare_recording(read: list[tuple[str, int, object]], solved: Solved) -> None:
    """Both kinds of recordings hold the same messages."""
    by_topic: dict[str, list] = {}
    for topic, time, message in read:
        by_topic.setdefault(topic, []).append((time, message))
    states = by_topic["/joint_states"]
    assert [time for time, _ in states] == [round(t * 1e9) for t in solved.times]
    assert tuple(states[0][1].name) == solved.plan.joints
    assert np.array_equal([list(m.position) for _, m in states], solved.positions)
    assert np.array_equal([list(m.velocity) for _, m in states], solved.velocities)
    (_, trajectory), *_ = by_topic["/joint_trajectory"]
    assert len(trajectory.points) == len(solved.times)
    assert "base_x" not in trajectory.joint_names
    cup = [
        t.transform
        for _, m in by_topic["/tf"]
        for t in m.transforms
        if t.child_frame_id == "cup"
    ]
    for transform, T in zip(cup, poses_of_the_cup(solved), strict=True):
        at, turn = transform.translation, transform.rotation
        assert np.allclose([at.x, at.y, at.z], T[:3, 3], atol=1e-9)
        R = matrix(turn.x, turn.y, turn.z, turn.w)
        assert np.allclose(R, T[:3, :3], atol=1e-9)


@exports("mjcf")
def test_mjcf(exported: Path, solved: Solved) -> None:
    model = mujoco.MjModel.from_xml_path(str(exported))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    table, cup = model.body("table"), data.body("cup")
    assert np.allclose(cup.xpos, solved.problem.object("cup").T_world_object[:3, 3])
    (geom,) = np.flatnonzero(model.geom_bodyid == table.id)
    assert np.allclose(model.geom_size[geom], [0.3, 0.8, 0.4])
    assert np.allclose(data.geom_xpos[geom], [0.5, 0.0, 0.4])
    assert {e.tag for e in ET.parse(exported).getroot()} == {"asset", "worldbody"}


@exports("moveit-scene")
def test_moveit_scene(exported: Path, solved: Solved) -> None:
    text = exported.read_text()
    lines = text.splitlines()
    assert lines[0] == solved.plan.scene
    assert lines[-1] == "."
    table = lines.index("* table")
    shape = ["1", "box", "0.6 1.6 0.8"]
    assert lines[table + 3 : table + 6] == shape
    assert [float(v) for v in lines[table + 6].split()] == [0.5, 0.0, 0.4]
    cup = lines.index("* cup")
    assert [float(v) for v in lines[cup + 1].split()] == [0.4, 0.5, 0.88]
    assert lines[cup + 4 : cup + 6] == ["cylinder", "0.035 0.16"]


def test_faulty_requests_are_refused_with_one_message(
    solved: Solved, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan, there = str(solved.path), tmp_path / "there"
    there.mkdir()
    for arguments, message in (
        (["--to", "npy", "-o", "x"], "unknown format 'npy'"),
        (["--to", "npz", "-o", str(there)], "is a folder"),
        (["--to", "csv", "-o", str(there / "a" / "b.csv")], "there is no folder"),
        (["--to", "csv", "-o", "x", "--scene", "wineglass"], "another state"),
    ):
        assert main(["export", plan, *arguments]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        assert err.startswith("mmplan: ")
        assert message in err
    assert list(there.iterdir()) == []
    assert set(EXPORTS) >= {"ros-yaml", "csv", "npz", "mcap", "rosbag2", "moveit-scene"}
