"""A good scene becomes the problem that it says."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan import assets
from mmplan.files.pose_section import PoseSection
from mmplan.grasps import Rim
from mmplan.problem import OptimizerSettings, PlannerSettings, ScoreSettings
from mmplan.scene_build import build_problem
from mmplan.scene_file import load_problem
from mmplan.scene_reader import SceneFile, read_scene
from mmplan.scene_values import pose
from mmplan.shapes import Box, Capsule, Cone, Cylinder, Fixture, Mesh, Revolve, Sphere

FAULTY = Path(__file__).parent / "faulty"
SCENE = """\
mmplan: 1
name: everything
robot:
  model: puma_mobile
  start: {base: [-1, 02], arm: [0, 2, -3.4, 0, -1.2, 0], hand: [0.01, 0.02]}
  bounds: {x: [-3, 1e1]}
obstacles:
  box: {box: [0.6, 2.4, 0.9], at: {xyz: [1.5, 0.0, 0.45]}, ground: true}
  sphere: {sphere: {radius: 0.1}}
  cylinder: {cylinder: {radius: 0.1, length: 0.2}}
  capsule: {capsule: {radius: 0.1, length: 0.2}}
  cone: {cone: {radius: 0.1, length: 0.2}}
  mesh: {mesh: mesh.obj, scale: 0.001}
  stretched: {mesh: mesh.obj, scale: [1, 2, 3]}
  fixture: {urdf: drawer.urdf, configuration: {drawer: 0.3}}
objects:
  plate:
    revolve: [[0, 0], [0.1, 0.01], [0.1, 0.02], [0, 0.015]]
    at: {xyz: [1.4, 0.3, 0.9], quat: [0, 0, 0.7071, 0.7071]}
    grasps:
      lip: {family: rim}
      low_lip: {family: rim, height: 0.01, spread: 0.5}
tasks:
  - {move: plate, to: {xyz: [1.3, -1.2, 0.35], rpy: [0, 0, 1]}, approach: 0.2, lift: 0}
  - {move: plate, to: {xyz: [1.3, -1.0, 0.35]}}
score: {clutter: 2}
optimizer: {name: random, evaluations: 100}
planner: {name: RRTstar, resolution: 5e-3}
"""


@pytest.fixture
def scene_path(tmp_path: Path) -> Path:
    shutil.copy(FAULTY / "files" / "drawer.urdf", tmp_path)
    (tmp_path / "mesh.obj").write_text("v 0 0 0\n")
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    return path


def test_every_key_reaches_the_problem(scene_path: Path) -> None:
    problem = build_problem(read_scene(scene_path))
    folder = scene_path.parent
    assert problem.name == "everything"
    assert problem.path == scene_path
    assert {o.name: o.shape for o in problem.obstacles} == {
        "box": Box((0.6, 2.4, 0.9)),
        "sphere": Sphere(0.1),
        "cylinder": Cylinder(0.1, 0.2),
        "capsule": Capsule(0.1, 0.2),
        "cone": Cone(0.1, 0.2),
        "mesh": Mesh(folder / "mesh.obj", (0.001, 0.001, 0.001)),
        "stretched": Mesh(folder / "mesh.obj", (1.0, 2.0, 3.0)),
        "fixture": Fixture(folder / "drawer.urdf", (("drawer", 0.3),)),
    }
    assert [o.name for o in problem.obstacles if o.ground] == ["box"]
    assert problem.score == ScoreSettings(clutter=2.0)
    assert problem.optimizer == OptimizerSettings(name="random", evaluations=100)
    assert problem.planner == PlannerSettings(name="RRTstar", resolution=0.005)
    first, second = problem.tasks
    assert (first.object, first.approach, first.lift) == ("plate", 0.2, 0.0)
    assert (first.lower, first.retreat, second.approach) == (None, None, None)


def test_grasps_take_the_lip_from_the_widest_point(scene_path: Path) -> None:
    plate = build_problem(read_scene(scene_path)).object("plate")
    assert isinstance(plate.shape, Revolve)
    assert plate.grasps == {
        "lip": Rim(0.1, 0.02, math.pi / 3),
        "low_lip": Rim(0.1, 0.01, 0.5),
    }


def test_the_default_spread_is_that_of_the_family() -> None:
    assert Rim.spread == pytest.approx(math.pi / 3, abs=1e-15)


def test_start_and_bounds(scene_path: Path) -> None:
    problem = build_problem(read_scene(scene_path))
    expected = [-1, 2, 0, 2, -3.4, 0, -1.2, 0, 0.01, 0.02]
    np.testing.assert_array_equal(problem.q_start, expected)
    margin = 1.5 * problem.robot.reach
    lower, upper = problem.robot.base.lower[1], problem.robot.base.upper[1]
    np.testing.assert_allclose(
        problem.base_bounds,
        [[-3, 10], [max(lower, -1.2 - margin), min(upper, 2 + margin)]],
    )


def test_named_start(scene_path: Path) -> None:
    text = SCENE.replace("[0, 2, -3.4, 0, -1.2, 0], hand: [0.01, 0.02]", "tucked")
    scene_path.write_text(text)
    problem = build_problem(read_scene(scene_path))
    robot = problem.robot
    np.testing.assert_array_equal(
        problem.q_start[robot.arm.indices], robot.configurations["tucked"]
    )
    np.testing.assert_array_equal(problem.q_start[robot.hand.indices], robot.hand_open)


angles = st.floats(-math.pi, math.pi)


@given(angles, angles, angles)
def test_rpy_is_roll_then_pitch_then_yaw_about_fixed_axes(
    roll: float, pitch: float, yaw: float
) -> None:
    def about(axis: int, angle: float) -> np.ndarray:
        quat = [0.0, 0.0, 0.0, math.cos(angle / 2)]
        quat[axis] = math.sin(angle / 2)
        return pose(PoseSection(quat=tuple(quat)))

    T = pose(PoseSection(xyz=(1.0, 2.0, 3.0), rpy=(roll, pitch, yaw)))
    expected = about(2, yaw) @ about(1, pitch) @ about(0, roll)
    np.testing.assert_allclose(T[:3, :3], expected[:3, :3], atol=1e-12)
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)
    np.testing.assert_array_equal(T[:, 3], [1.0, 2.0, 3.0, 1.0])
    assert not T.flags.writeable


def test_a_quarter_turn_about_z_by_quaternion_takes_x_to_y() -> None:
    T = pose(PoseSection(quat=(0.0, 0.0, 0.7071, 0.7071)))
    np.testing.assert_allclose(T[:3, 0], [0.0, 1.0, 0.0], atol=1e-12)


class TestFingerprint:
    def test_does_not_depend_on_the_folder(
        self, scene_path: Path, tmp_path_factory: pytest.TempPathFactory
    ) -> None:
        elsewhere = tmp_path_factory.mktemp("elsewhere") / "copy"
        shutil.copytree(scene_path.parent, elsewhere)
        here, there = read_scene(scene_path), read_scene(elsewhere / "scene.yaml")
        assert here.fingerprint() == there.fingerprint()

    @pytest.mark.parametrize("name", ["scene.yaml", "mesh.obj", "drawer.urdf"])
    def test_changes_with_every_file(self, scene_path: Path, name: str) -> None:
        before = read_scene(scene_path).fingerprint()
        file = scene_path.parent / name
        file.write_text(file.read_text() + "\n")
        assert read_scene(scene_path).fingerprint() != before

    def test_changes_with_the_robot(self, scene_path: Path) -> None:
        robot = scene_path.parent / "robot"
        shutil.copytree(assets.robots_folder() / "puma_mobile", robot)
        scene_path.write_text(SCENE.replace("puma_mobile", "robot/robot.yaml"))
        prints = {read_scene(scene_path).fingerprint()}
        for file in ("robot.yaml", "puma_mobile.urdf"):
            path = robot / file
            path.write_text(path.read_text() + "\n")
            prints.add(read_scene(scene_path).fingerprint())
        assert len(prints) == 3


class TestNames:
    @pytest.mark.parametrize("name", assets.scene_names())
    def test_a_shipped_scene_loads_by_its_bare_name(
        self, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.chdir(tmp_path)
        problem = load_problem(name)
        assert problem.path == assets.scenes_folder() / f"{name}.yaml"
        assert problem.tasks

    def test_a_file_that_exists_wins(
        self, scene_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.chdir(scene_path.parent)
        scene_path.rename("wineglass.yaml")
        assert read_scene("wineglass.yaml").section.name == "everything"
        assert read_scene("wineglass").section.name == "wineglass"

    def test_every_shipped_scene_has_a_description(self) -> None:
        for name in assets.scene_names():
            assert isinstance(read_scene(name), SceneFile)
            assert read_scene(name).section.description


def test_a_faulty_scene_is_refused_without_the_heavy_libraries() -> None:
    code = """
import sys
from mmplan.exceptions import InputError
from mmplan.scene_file import load_problem
try:
    load_problem(sys.argv[1])
except InputError as error:
    heavy = {"coal", "ompl", "pinocchio", "numpy", "scipy"} & set(sys.modules)
    print(len(error.diagnostics), sorted(heavy))
"""
    run = subprocess.run(
        [sys.executable, "-c", code, str(FAULTY / "many_faults.yaml")],
        capture_output=True,
        text=True,
        check=True,
    )
    assert (run.stdout, run.stderr) == ("9 []\n", "")
