"""Pictures by MuJoCo: of what was asked for, and clear words where there are none."""

from __future__ import annotations

import ctypes.util
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mmplan.exceptions import InputError
from mmplan.visualization.camera import best_camera, camera_of, sun_of
from mmplan.visualization.exhibit import Exhibit, exhibit_of_scene
from mmplan.visualization.offscreen import Studio
from mmplan.visualization.pictures import Look, moments_of, write_pictures
from tests.tabletop import SCENE

SIZE = (160, 100)

has_gl = pytest.mark.skipif(
    "MMPLAN_NO_SKIP" not in os.environ
    and not any(map(ctypes.util.find_library, ("EGL", "OSMesa"))),
    reason="there is no software OpenGL (libegl1 or libosmesa6)",
)


def pixels(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


@has_gl
def test_a_picture_shows_the_robot_where_it_is(
    exhibit: Exhibit, tmp_path: Path
) -> None:
    pictures = []
    for name, time in (("a.png", 0.0), ("b.png", 3.0), ("c.webp", 3.0)):
        look = Look(SIZE, times=(time,))
        write_pictures(tmp_path / name, exhibit, look)
        pictures.append(pixels(tmp_path / name))
    first, second, third = pictures
    assert first.shape == (100, 160, 3)
    assert (np.abs(first - second).max(axis=2) > 30).mean() > 0.01
    assert np.abs(second - third).mean() < 4.0  # the same but for compression
    # It is neither black nor all of one colour.
    assert first.mean() > 80.0
    assert first.std() > 10.0


@has_gl
def test_several_times_make_a_strip(exhibit: Exhibit, tmp_path: Path) -> None:
    times = moments_of(exhibit.film, "start,goal,end")
    write_pictures(tmp_path / "strip.png", exhibit, Look(SIZE, times=times))
    assert pixels(tmp_path / "strip.png").shape[:2] == (100, 3 * 160 + 2 * 4)


@has_gl
@pytest.mark.parametrize("kind", ["gif", "webp", "mp4"])
def test_animations_last_as_long_as_the_motion(
    kind: str, exhibit: Exhibit, tmp_path: Path
) -> None:
    path = tmp_path / f"plan.{kind}"
    done: list[tuple[int, int]] = []
    look = Look(SIZE, rate=2.0)
    write_pictures(path, exhibit, look, lambda n, of: done.append((n, of)))
    frames = done[-1][1]
    assert done == [(n + 1, frames) for n in range(frames)]
    assert (frames - 1) / 2.0 == pytest.approx(exhibit.film.duration, abs=0.5)
    if kind == "mp4":
        assert path.read_bytes()[4:8] == b"ftyp"
        return
    with Image.open(path) as image:
        assert image.n_frames >= frames - 2  # equal ones may be one
        assert image.info.get("loop") == 0
        shown = [np.asarray(frame.convert("RGB")) for frame in _frames(image)]
    changes = [np.abs(a.astype(int) - b).max() for a, b in pairwise(shown)]
    assert max(changes) > 50


def _frames(image: Image.Image) -> list[Image.Image]:
    frames = []
    for number in range(image.n_frames):
        image.seek(number)
        frames.append(image.copy())
    return frames


@has_gl
def test_hidden_layers_are_not_drawn(exhibit: Exhibit, tmp_path: Path) -> None:
    shown = {}
    for hidden in ((), ("paths",), ("robot", "scene", "paths", "ghosts", "tool frame")):
        path = tmp_path / f"{len(hidden)}.png"
        write_pictures(
            path, exhibit, Look(SIZE, times=(1.0,), hidden=frozenset(hidden))
        )
        shown[hidden] = pixels(path)
    everything, no_paths, _ = shown.values()
    assert np.abs(everything - no_paths).max() > 50


@has_gl
def test_a_picture_of_a_scene(exhibit: Exhibit, tmp_path: Path) -> None:
    scene = exhibit_of_scene(exhibit.problem)
    write_pictures(tmp_path / "scene.png", scene, Look(SIZE))
    assert pixels(tmp_path / "scene.png").std() > 10.0
    with pytest.raises(InputError, match="a still picture is"):
        write_pictures(tmp_path / "scene.gif", scene, Look(SIZE))


def test_without_any_opengl_it_says_what_to_install(
    exhibit: Exhibit, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(ctypes.util, "find_library", lambda _: None)
    camera = best_camera(exhibit)
    with pytest.raises(InputError, match="apt-get install libegl1"):
        Studio(exhibit.parts, SIZE, camera, sun_of(exhibit, camera))


def test_the_names_of_moments(exhibit: Exhibit) -> None:
    film = exhibit.film
    grasp, release = (
        next(m for m in film.marks if m.name == name) for name in ("grasp", "release")
    )
    assert moments_of(film, "0, start,goal,end") == (
        0.0,
        grasp.end,
        release.start,
        film.duration,
    )
    for text, message in (("noon", "expected seconds"), ("99", "lasts from 0 to")):
        with pytest.raises(InputError, match=message):
            moments_of(film, text)


def test_the_camera_looks_where_it_is_told(exhibit: Exhibit) -> None:
    camera = camera_of(exhibit, "90,30,2,0.1,0.2,0.3")
    assert np.allclose(camera.target, [0.1, 0.2, 0.3])
    assert np.allclose(camera.eye, [0.1, 0.2 + 2 * np.cos(np.pi / 6), 1.3])
    auto = camera_of(exhibit, "auto")
    assert np.array_equal(camera_of(exhibit, "90,30").target, auto.target)
    start, goal = (camera_of(exhibit, name) for name in ("start", "goal"))
    assert np.allclose(start.target, [0.4, 0.5, 0.88])
    assert np.allclose(goal.target, [0.4, 0.0, 0.88])
    for text in ("left", "1", "1,2,3,4", "nan,1", "0,0,-1"):
        with pytest.raises(InputError, match="--camera"):
            camera_of(exhibit, text)


def test_the_best_camera_is_not_behind_a_wall(exhibit: Exhibit) -> None:
    # The table is all there is: from anywhere above it everything is in sight.
    camera = best_camera(exhibit)
    assert camera.eye[2] > 0.8


# The order decides which part of mmplan imports MuJoCo first.
@has_gl
@pytest.mark.parametrize("order", ["import draw", "draw import"])
def test_models_of_mujoco_are_read_and_pictures_drawn_in_either_order(
    order: str, tmp_path: Path
) -> None:
    model, scene, picture = (tmp_path / n for n in ("box.xml", "s.yaml", "s.png"))
    model.write_text(
        '<mujoco><worldbody><geom name="b" type="box" size=".1 .1 .1"/></worldbody>'
        "</mujoco>"
    )
    commands = {
        "import": ["import", "--from", "mjcf", str(model), "-o", str(scene)],
        "draw": ["render", str(SCENE), "-o", str(picture), "--size", "64x40"],
    }
    lines = [f"assert main({commands[name]!r}) == 0" for name in order.split()]
    program = "\n".join(["from mmplan.cli import main", *lines])
    environment = {k: v for k, v in os.environ.items() if k != "MUJOCO_GL"}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert pixels(picture).shape == (40, 64, 3)
