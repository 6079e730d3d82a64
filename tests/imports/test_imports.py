"""Scenes of other programs become scenes that load and mean the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mmplan import assets
from mmplan.cli import main
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.shapes import Box, Capsule, Cylinder, Fixture, Mesh, Sphere
from tests.exports.conftest import Solved, solved  # noqa: F401  # a fixture

PLANNING_SCENE = """
name: two things
robot_state:
  joint_state: {name: [joint1, joint2], position: [0.1, 0.2]}
  attached_collision_objects: [{link_name: hand, object: {id: pen}}]
world:
  collision_objects:
    - id: table
      pose: {position: [0.5, 0, 0.2], orientation: [0, 0, 0.7071068, 0.7071068]}
      primitives: [{type: box, dimensions: [0.4, 0.6, 0.4]}]
      primitive_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]
    - id: 1 can
      primitives: [{type: 3, dimensions: [0.12, 0.03]}]
      primitive_poses:
        - position: {x: 0.5, y: 0.1, z: 0.46}
          orientation: {x: 0, y: 0, z: 0, w: 1}
    - id: wedge
      meshes:
        - vertices: [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]
          triangles: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
      mesh_poses: [{position: [0, 3, 1], orientation: [0, 0, 0, 1]}]
    - id: ball
      primitives: [{type: sphere, dimensions: [0.05]}]
      primitive_poses: [{position: [0, -3, 1], orientation: [0, 0, 0, 1]}]
      plane_poses: [{}]
  octomap: {origin: {}}
allowed_collision_matrix: {entry_names: []}
"""
REQUEST = """
start_state:
  joint_state: {name: [joint1, joint2, joint3, joint4, joint5, joint6],
    position: [0.0, 1.92, -3.9, 0.0, -1.57, 0.0]}
goal_constraints:
  - joint_constraints: [{joint_name: joint1, position: 1.0}]
"""
OLD_SCENE = """(noname)+
* post
1
cylinder
0.02 0.5
2 0 0.25
0 0 0 1
0 0 0 0
* plane
1
plane
0 0 1 0
0 0 0
0 0 0 1
0 0 0 0
.
"""
MODEL = """<mujoco model="room"><worldbody>
  <geom name="floor plane" type="plane" size="0 0 1"/>
  <geom name="ghost" type="box" size="1 1 1" contype="0" conaffinity="0"/>
  <body name="shelf" pos="1 0 0.5" euler="0 0 90">
    <geom type="box" size="0.1 0.2 0.3"/>
    <geom name="pole" type="capsule" size="0.02 0.4" pos="0.5 0 0"/>
    <geom name="egg" type="ellipsoid" size="0.1 0.1 0.2" pos="0 0 1"/>
  </body>
  <body pos="2 2 1"><freejoint/><geom name="ball" size="0.04"/></body>
</worldbody></mujoco>
"""


def imported(folder: Path, format_: str, *arguments: str | Path) -> Problem:
    """What the command makes of files, loaded as a scene."""
    scene = folder / "scene.yaml"
    given = ["import", "--from", format_, *map(str, arguments), "-o", str(scene)]
    assert main(given) == 0
    return load_problem(scene)


def things(problem: Problem) -> dict:
    found = {o.name: (o.shape, o.T_world_obstacle) for o in problem.obstacles}
    found |= {o.name: (o.shape, o.T_world_object) for o in problem.objects}
    return found


@pytest.mark.parametrize("format_", ["moveit-scene", "mjcf"])
def test_what_is_exported_and_imported_again_is_the_same_scene(
    format_: str,
    solved: Solved,  # noqa: F811
    tmp_path: Path,
) -> None:
    file = tmp_path / ("world.scene" if format_ == "moveit-scene" else "world.xml")
    plan = str(solved.path)
    assert main(["export", plan, "--to", format_, "-o", str(file)]) == 0
    given = ["--move", "cup", "--to", "0.4,0,0.88", "--base=-1,0"]
    problem = imported(tmp_path, format_, file, *given)
    wanted = things(solved.problem)
    for name, (shape, T) in things(problem).items():
        assert shape == wanted[name][0]
        assert np.allclose(T, wanted[name][1], atol=1e-6)
    assert set(things(problem)) == set(wanted)
    (task,) = problem.tasks
    assert np.allclose(task.T_world_goal[:3, 3], [0.4, 0.0, 0.88])


def test_a_planning_scene_and_what_is_not_in_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "planning.yaml"
    file.write_text(PLANNING_SCENE)
    given = ["--move", "o1_can", "--to", "0.5,-0.1,0.46,0,0,1.5"]
    problem = imported(tmp_path, "moveit-scene", file, *given)
    found = things(problem)
    assert problem.name == "two_things"
    table, T = found["table"]
    assert table == Box((0.4, 0.6, 0.4))
    assert np.allclose(T[:3, :3], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-6)
    assert found["o1_can"][0] == Cylinder(0.03, 0.12)
    assert found["ball"][0] == Sphere(0.05)
    wedge, T = found["wedge"]
    assert isinstance(wedge, Mesh)
    assert np.allclose(T[:3, 3], [0, 3, 1])
    assert (tmp_path / "two_things_meshes" / "wedge.obj").is_file()
    assert found["floor"][1][2, 3] == pytest.approx(-0.05)
    told = capsys.readouterr().err.splitlines()
    assert all(line.startswith("mmplan: not imported: ") for line in told)
    for word in ("'pen'", "octomap", "allowed_collision_matrix", "plane_poses"):
        assert any(word in line for line in told)
    assert any("joint1, joint2" in line for line in told)


def test_a_request_says_where_the_arm_starts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, request = tmp_path / "scene0001.yaml", tmp_path / "request0001.yaml"
    scene.write_text(PLANNING_SCENE)
    request.write_text(REQUEST)
    given = ["--move", "o1_can", "--to", "0.5,-0.1,0.46"]
    problem = imported(tmp_path, "motionbenchmaker", scene, request, *given)
    arm = problem.robot.arm
    wanted = [0.0, 1.92, -3.9, 0.0, -1.57, 0.0]
    assert problem.q_start[arm.indices].tolist() == wanted
    assert "goal_constraints" in capsys.readouterr().err


def test_the_older_text_has_shapes_in_the_world(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "old.scene"
    file.write_text(OLD_SCENE)
    given = ["--move", "post", "--to", "2,1,0.25"]
    problem = imported(tmp_path, "moveit-scene", file, *given)
    shape, T = things(problem)["post"]
    assert shape == Cylinder(0.02, 0.5)
    assert np.allclose(T[:3, 3], [2, 0, 0.25])
    assert "a plane" in capsys.readouterr().err


def test_a_model_of_mujoco(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "room.xml"
    file.write_text(MODEL)
    given = ["--move", "ball", "--to", "2,1,1", "--base=-2,0"]
    found = things(imported(tmp_path, "mjcf", file, *given))
    assert set(found) == {"floor_plane", "shelf_2", "pole", "ball"}
    assert found["shelf_2"][0] == Box((0.2, 0.4, 0.6))
    assert found["pole"][0] == Capsule(0.02, 0.8)
    assert np.allclose(found["pole"][1][:3, 3], [1, 0.5, 0.5])
    assert found["floor_plane"][1][2, 3] == pytest.approx(-0.05)
    told = capsys.readouterr().err
    assert "egg: a geom of type ellipsoid" in told
    assert "1 joints, held where they start" in told


def test_a_urdf_becomes_a_fixture_and_without_a_task_the_file_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "scene.yaml"
    urdf = assets.find_scene("wineglass").parent / "dishwasher.urdf"
    assert main(["import", "--from", "urdf", str(urdf), "-o", str(scene)]) == 0
    assert "there is no task" in capsys.readouterr().err
    assert "- {move: NAME" in scene.read_text()
    cup = "objects: {cup: {cylinder: {radius: 0.03, length: 0.1}, at: {xyz: [3,3,3]}}}"
    task = "tasks: [{move: cup, to: {xyz: [3, 3, 3.5]}}]"
    scene.write_text(f"{scene.read_text()}\n{cup}\n{task}\n")
    problem = load_problem(scene)
    fixture = things(problem)["dishwasher"][0]
    assert isinstance(fixture, Fixture)
    assert dict(fixture.configuration).keys() >= {"door", "lower_rack"}


@pytest.mark.parametrize(
    ("format_", "text", "message"),
    [
        ("moveit-scene", "name: x\nworld: [", "planning.yaml:2:9"),
        ("moveit-scene", "a: 1", "has neither 'world'"),
        ("motionbenchmaker", "- 1", "is no mapping"),
        ("moveit-scene", PLANNING_SCENE.replace("sphere", "torus"), "shape 'torus'"),
        ("moveit-scene", PLANNING_SCENE.replace("[0.05]", "[-1]"), "sizes above 0"),
        ("moveit-scene", PLANNING_SCENE, "--move: unknown thing 'nothing'"),
        ("mjcf", "<mujoco><worldbody><geom/></worldbody></mujoco>", "planning.yaml: "),
        ("urdf", "<robot", "is not XML"),
        ("xacro", "", "unknown format 'xacro'"),
    ],
)
def test_a_faulty_file_is_one_message(
    format_: str,
    text: str,
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    file, scene = tmp_path / "planning.yaml", tmp_path / "scene.yaml"
    file.write_text(text)
    given = ["--move", "nothing", "--to", "0,0,0", "-o", str(scene)]
    assert main(["import", "--from", format_, str(file), *given]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert message in err
    assert not scene.exists()


@pytest.mark.parametrize("line", range(1, 16))
def test_a_text_that_ends_too_early_names_the_line(
    line: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, scene = tmp_path / "cut.scene", tmp_path / "scene.yaml"
    file.write_text("\n".join(OLD_SCENE.splitlines()[:line]))
    code = main(["import", "--from", "moveit-scene", str(file), "-o", str(scene)])
    assert code == 2
    assert f"cut.scene:{line}: the file ends where " in capsys.readouterr().err
