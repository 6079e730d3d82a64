"""`mmplan robot import`: a URDF becomes a robot, or one clear message."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest

from mmplan.assets import example_robots
from mmplan.cli import main
from mmplan.exceptions import InputError
from mmplan.files.urdf_faults import read_sound_urdf
from mmplan.robot import Robot
from mmplan.robot_build import load_robot
from mmplan.robot_file import load_robot_description
from mmplan.robot_setup.groups import guess_groups
from mmplan.robot_setup.importing import Imported, import_robot
from mmplan.robot_setup.self_collisions import SelfCollisions
from mmplan.robot_setup.warnings import closing_direction
from mmplan.robot_setup.wishes import Wishes

FAULTY = Path(__file__).parents[1] / "faulty_urdfs"
# A three-joint arm on a lift, with one driven finger and one that mimics it. Beside it
# stands a mast with a camera that turns.
CRANE = """<robot name="crane">
  <link name="foot">{box}</link>
  <link name="post">{box}</link>
  <link name="upper">{rod}</link>
  <link name="lower">{rod}</link>
  <link name="palm">{box}</link>
  <link name="left">{finger}</link>
  <link name="right">{finger}</link>
  <link name="mast">{box}</link>
  <link name="camera"/>
  <joint name="lift" type="prismatic">
    <parent link="foot"/><child link="post"/><axis xyz="0 0 1"/>
    <origin xyz="0 0 0.2"/>
    <limit lower="0" upper="0.3" velocity="0.1" effort="10"/>
  </joint>
  <joint name="shoulder" type="continuous">
    <parent link="post"/><child link="upper"/><axis xyz="0 0 1"/>
    <origin xyz="0 0 0.2"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="lower"/><axis xyz="0 1 0"/>
    <origin xyz="0 0 0.4"/>
    <limit lower="-2" upper="2" velocity="1" effort="10"/>
  </joint>
  <joint name="wrist" type="revolute">
    <parent link="lower"/><child link="palm"/><axis xyz="0 1 0"/>
    <origin xyz="0 0 0.4"/>
    <limit lower="-2" upper="2" velocity="0" effort="10"/>
  </joint>
  <joint name="left_jaw" type="prismatic">
    <parent link="palm"/><child link="left"/><axis xyz="1 0 0"/>
    <origin xyz="0.01 0 0.1"/>
    <limit lower="0" upper="0.04" velocity="0.1" effort="10"/>
  </joint>
  <joint name="right_jaw" type="prismatic">
    <parent link="palm"/><child link="right"/><axis xyz="-1 0 0"/>
    <origin xyz="-0.01 0 0.1"/>
    <limit lower="0" upper="0.04" velocity="0.1" effort="10"/>
    <mimic joint="left_jaw"/>
  </joint>
  <joint name="stay" type="fixed">
    <parent link="foot"/><child link="mast"/><origin xyz="-0.15 0 0"/>
  </joint>
  <joint name="pan" type="continuous">
    <parent link="mast"/><child link="camera"/>
  </joint>
</robot>
""".format(
    box='<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>',
    rod='<collision><origin xyz="0 0 0.2"/>'
    '<geometry><cylinder radius="0.03" length="0.3"/></geometry></collision>',
    finger='<collision><geometry><box size="0.01 0.02 0.08"/></geometry></collision>',
)


def crane_urdf(folder: Path) -> Path:
    urdf = folder / "crane.urdf"
    urdf.write_text(CRANE)
    return urdf


def wishes(**changed: object) -> Wishes:
    asked = {"base": "planar", "tip": "palm", "name": "crane", "samples": 800}
    return Wishes(**{**asked, **changed})  # type: ignore[arg-type]


@cache
def crane() -> tuple[Imported, Robot]:
    folder = Path(mkdtemp())
    imported = import_robot(crane_urdf(folder), wishes(), folder / "robots" / "crane")
    return imported, load_robot(imported.path)


def test_groups_are_found() -> None:
    _, robot = crane()
    assert robot.base.names == ("base_x", "base_y", "base_yaw")
    assert robot.arm.names == ("lift", "shoulder", "elbow", "wrist")
    assert robot.hand.names == ("left_jaw", "right_jaw")
    assert [f.leader for f in robot.hand.followers] == [robot.hand.indices[0]]
    assert "camera" in [frame.name for frame in robot.model.frames]


def test_the_hand_opens_the_way_its_fingers_part() -> None:
    _, robot = crane()
    np.testing.assert_allclose(robot.hand_open, [0.04, 0.04])
    np.testing.assert_allclose(robot.hand_closed, [0.0, 0.0])


def test_the_tool_frame_is_between_the_fingertips() -> None:
    _, robot = crane()
    palm = robot.model.frames[robot.model.getFrameId("palm")]
    T = np.linalg.inv(palm.placement.homogeneous) @ robot.T_joint_tool
    np.testing.assert_allclose(T[:3, 2], [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(np.abs(T[:3, 1]), [1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(T[:2, 3], 0, atol=1e-6)
    assert 0.1 < T[2, 3] < 0.14, "between the pads, behind the tips at 0.14"
    closing = closing_direction(robot)
    assert closing is not None
    assert abs(closing[1]) > 0.99


def test_what_was_guessed_is_said_and_written() -> None:
    imported, _ = crane()
    text = imported.path.read_text()
    for note in imported.notes:
        assert note in text
    notes = "\n".join(imported.notes)
    for word in ("velocity of shoulder", "velocity of wrist", "pedestal", "pairs of"):
        assert word in notes
    assert "velocity of elbow" not in notes


def test_resting_places_are_free_and_within_limits() -> None:
    _, robot = crane()
    links = SelfCollisions(robot)
    assert set(robot.configurations) == {"home", "tucked"}
    geometry = robot.geometry
    checked = [
        tuple(robot.link_of(geometry.geometryObjects[k]) for k in (p.first, p.second))
        for p in geometry.collisionPairs
    ]
    assert checked
    for q_arm in robot.configurations.values():
        q = robot.q_neutral.copy()
        q[robot.arm.indices] = q_arm
        assert not links.any_of(q[None], checked)[0]  # type: ignore[arg-type]
        assert np.all(q_arm >= robot.arm.lower)
        assert np.all(q_arm <= robot.arm.upper)


def test_every_pair_has_a_reason() -> None:
    imported, _ = crane()
    pairs = load_robot_description(imported.path).disabled_pairs
    assert all(reason for _, _, reason in pairs)
    assert ["upper", "lower", "adjacent"] in [list(pair) for pair in pairs]


def test_an_arm_without_fingers_gets_a_hand(tmp_path: Path) -> None:
    text = CRANE
    for jaw in ("left", "right"):
        text = text.replace(
            f'name="{jaw}_jaw" type="prismatic"', f'name="{jaw}_jaw" type="fixed"'
        )
    urdf = tmp_path / "bare.urdf"
    urdf.write_text(text.replace('<mimic joint="left_jaw"/>', ""))
    folder = tmp_path / "bare"
    imported = import_robot(urdf, wishes(base="fixed", name="bare"), folder)
    robot = load_robot(imported.path)
    assert robot.hand.names == ("finger_left_joint", "finger_right_joint")
    assert any("fixed to 'palm'" in note for note in imported.notes)
    assert (folder / "two_finger_hand.urdf").is_file()


def test_meshes_are_taken_along(tmp_path: Path) -> None:
    package = tmp_path / "crane_description"
    for name in ("urdf", "meshes"):
        (package / name).mkdir(parents=True)
    (package / "meshes" / "wedge.obj").write_text(
        "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    )
    mesh = '<mesh filename="package://crane_description/meshes/wedge.obj"/>'
    urdf = package / "urdf" / "crane.urdf"
    urdf.write_text(CRANE.replace('<box size="0.1 0.1 0.1"/>', mesh))
    imported = import_robot(urdf, wishes(), tmp_path / "moved" / "crane")
    package.rename(tmp_path / "gone")
    robot = load_robot(imported.path)
    assert any(hasattr(g.geometry, "points") for g in robot.geometry.geometryObjects)


def test_a_u_is_cut_into_pieces(tmp_path: Path) -> None:
    pytest.importorskip("coacd")
    from tests.collision.meshes import u_shape, write_obj

    write_obj(tmp_path / "u.obj", *u_shape())
    urdf = tmp_path / "crane.urdf"
    first = '<link name="foot"><collision><geometry><box size="0.1 0.1 0.1"/>'
    u = '<link name="foot"><collision><geometry><mesh filename="u.obj"/>'
    urdf.write_text(CRANE.replace(first, u))
    imported = import_robot(urdf, wishes(), tmp_path / "crane")
    description = load_robot_description(imported.path)
    assert description.collision == {"foot": "decomposed"}
    robot = load_robot(imported.path)
    pieces = [g for g in robot.geometry.geometryObjects if robot.link_of(g) == "foot"]
    assert len(pieces) >= 3
    (imported.path.parent / "collision" / "foot").rename(tmp_path / "away")
    with pytest.raises(InputError, match=r"collision\.foot: no pieces"):
        load_robot(imported.path)


@pytest.mark.parametrize("path", sorted(FAULTY.glob("*.urdf")), ids=lambda p: p.stem)
def test_a_faulty_urdf_is_refused_and_leaves_nothing(
    path: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "robots" / "lever"
    command = ["robot", "import", str(path), "--base", "fixed", "--tip", "lever"]
    assert main([*command, "-o", str(out)]) == 2
    stdout, stderr = capfd.readouterr()
    assert stdout == ""
    assert stderr.startswith(f"mmplan: {path}:")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"tip": "plam"}, "--tip: unknown link 'plam'; did you mean 'palm'?"),
        ({"tip": "foot"}, "--tip: no joint that moves is above link 'foot'"),
        ({"arm": ("elbo",)}, "--arm: unknown joint 'elbo'; did you mean 'elbow'?"),
        ({"hand": ("jaw",)}, "--hand: unknown joint 'jaw'"),
        ({"hand": Path("no.urdf")}, "no.urdf: cannot be read: No such file"),
    ],
)
def test_what_is_not_there_is_named(
    changed: dict[str, object], message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError) as caught:
        import_robot(crane_urdf(tmp_path), wishes(**changed), tmp_path / "crane")
    assert message in str(caught.value)
    assert [p.name for p in tmp_path.iterdir()] == ["crane.urdf"]


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "crane").mkdir()
    with pytest.raises(InputError, match="is there already"):
        import_robot(crane_urdf(tmp_path), wishes(), tmp_path / "crane")


def test_long_chains_keep_seven_joints_and_a_lift() -> None:
    share = example_robots()
    if share is None:
        pytest.skip("needs example-robot-data")
    folder = share / "example-robot-data" / "robots"
    root = read_sound_urdf(
        folder / "tiago_description" / "robots" / "tiago_no_hand.urdf", (share,)
    ).root
    groups = guess_groups(root, "wrist_ft_tool_link")
    assert groups.arm[0] == "torso_lift_joint"
    assert len(groups.arm) == 8


# The commands


def test_the_table_of_robots(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", "--json"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    rows = {row["name"]: row for row in json.loads(out)}
    puma = rows["puma_mobile"]
    assert (puma["base_joints"], puma["arm_joints"], puma["hand_joints"]) == (2, 6, 2)
    assert puma["ik_solver"] == "puma"
    assert 0 < puma["ik_seconds"] < 1
    assert 0 < puma["collision_seconds"] < 1


def test_inspecting_prints_everything(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robot", "inspect", "puma_mobile"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    for text in (
        "joint6",
        "tool frame 'tool' in 'hand'",
        "5 pairs of links are checked",
        "31 pairs are not checked",
        "the elbow cannot fold up",
        "inverse kinematics 'puma': 100.0 %",
        "warning: wrist_roll / hand: not checked",
    ):
        assert text in out
    assert main(["robot", "inspect", "puma_mobile", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found["pairs"]) == 36
    assert found["ik"]["solved"] == 1.0
    assert main(["robot", "inspect", "puma_mobil"]) == 2
    assert "did you mean 'puma_mobile'?" in capsys.readouterr().err


def test_the_composed_urdf_can_be_read_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    imported, robot = crane()
    assert main(["robot", "urdf", str(imported.path)]) == 0
    urdf = tmp_path / "whole.urdf"
    urdf.write_text(capsys.readouterr().out)
    root = read_sound_urdf(urdf).root
    joints = [j.get("name") for j in root.findall("joint") if j.get("type") != "fixed"]
    assert set(joints) == set(robot.model.names[1:])
