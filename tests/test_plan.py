from __future__ import annotations

import errno
import json
import os
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from mmplan import assets
from mmplan.exceptions import InputError
from mmplan.plan import Plan
from mmplan.plan_file import plan_schema
from mmplan.verification import examine
from tests.honest import bottle_plan, bottle_problem


@pytest.fixture(scope="module")
def plan() -> Plan:
    plan = bottle_plan()
    return replace(plan, verification=examine(plan, bottle_problem()))


def saved(plan: Plan, folder: Path) -> Path:
    path = folder / "plan.json"
    plan.save(path)
    return path


def spoil(path: Path, *keys: str | int, value: Any) -> None:
    """Replace one value of a plan file."""
    content = json.loads(path.read_text())
    place = content
    for key in keys[:-1]:
        place = place[key]
    place[keys[-1]] = value
    path.write_text(json.dumps(content))


def test_loading_gives_back_every_number_exactly(plan: Plan, tmp_path: Path) -> None:
    loaded = Plan.load(saved(plan, tmp_path))
    for task, task_loaded in zip(plan.tasks, loaded.tasks, strict=True):
        assert np.array_equal(task.T_object_tool, task_loaded.T_object_tool)
        assert task.start.scores == task_loaded.start.scores
        for a, b in zip(task.segments, task_loaded.segments, strict=True):
            assert a.name == b.name
            assert np.array_equal(a.times, b.times)
            assert np.array_equal(a.positions, b.positions)
            assert np.array_equal(a.velocities, b.velocities)
            for poses, poses_loaded in (
                (a.attached, b.attached),
                (a.objects, b.objects),
            ):
                assert poses.keys() == poses_loaded.keys()
                assert all(np.array_equal(poses[k], poses_loaded[k]) for k in poses)
    assert loaded.verification == plan.verification
    assert loaded.duration == plan.duration


def test_saving_what_was_loaded_gives_the_same_bytes(
    plan: Plan, tmp_path: Path
) -> None:
    first = saved(plan, tmp_path)
    second = tmp_path / "again.json"
    Plan.load(first).save(second)
    assert first.read_bytes() == second.read_bytes()


def test_plans_differ_only_in_the_time_of_day(plan: Plan, tmp_path: Path) -> None:
    later = replace(plan, created=plan.created + timedelta(hours=1))
    first = saved(plan, tmp_path).read_text().splitlines()
    second = saved(later, tmp_path).read_text().splitlines()
    different = [a for a, b in zip(first, second, strict=True) if a != b]
    assert len(different) == 1
    assert '"created"' in different[0]


def test_a_row_of_numbers_is_a_line(plan: Plan, tmp_path: Path) -> None:
    lines = saved(plan, tmp_path).read_text().splitlines()
    rows = sum(2 * len(s.times) for task in plan.tasks for s in task.segments)
    joints = len(plan.joints)
    full = [
        x for x in lines if x.strip().startswith("[") and x.count(",") >= joints - 1
    ]
    assert len(full) == rows


def test_scene_path_is_relative_to_the_plan(plan: Plan, tmp_path: Path) -> None:
    scene = tmp_path / "scenes" / "bottle.yaml"
    folder = tmp_path / "plans"
    folder.mkdir()
    path = saved(replace(plan, path=scene), folder)
    assert json.loads(path.read_text())["scene"]["path"] == "../scenes/bottle.yaml"
    assert Plan.load(path).path == scene


@pytest.mark.parametrize(
    "interruption", [KeyboardInterrupt(), OSError(errno.ENOSPC, "x")]
)
def test_an_interrupted_save_leaves_the_old_file(
    plan: Plan,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    interruption: BaseException,
) -> None:
    path = tmp_path / "plan.json"
    path.write_text("old")

    def fail(_: int) -> None:
        raise interruption

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises((KeyboardInterrupt, InputError)):
        plan.save(path)
    assert [p.name for p in tmp_path.iterdir()] == ["plan.json"]
    assert path.read_text() == "old"


def test_a_plan_with_nan_is_not_written(plan: Plan, tmp_path: Path) -> None:
    task = plan.tasks[0]
    spoiled = replace(task, genes=np.array([0.1, np.nan]))
    path = tmp_path / "plan.json"
    with pytest.raises(InputError, match=r"tasks\[0\]\.grasp\.genes\[1\].*finite"):
        replace(plan, tasks=(spoiled,)).save(path)
    assert not path.exists()


def test_a_folder_is_no_place_for_a_plan(plan: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written: this is a folder"):
        plan.save(tmp_path)
    with pytest.raises(InputError, match="cannot be written: No such file"):
        plan.save(tmp_path / "missing" / "plan.json")


def test_a_device_is_written_to_and_stays(plan: Plan) -> None:
    plan.save("/dev/null")
    assert Path("/dev/null").is_char_device()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "the file is empty"),
        (b" \n", "the file is empty"),
        (b"mmplan: 1\n", "plan.json:1:1: not JSON"),
        (b'{"mmplan_plan": 1,\n "seed": }', "plan.json:2:10: not JSON"),
        (b"\x89PNG\r\n\x1a\n\x00\xff", "not a text file"),
        (b"[" * 100_000, "nested too deeply"),
        (b"{}", "no key 'mmplan_plan'"),
        (b'{"mmplan_plan": 2, "new": 1}', "format version 2 is not known"),
        (b"[1, 2]", "valid dictionary|object"),
    ],
)
def test_what_is_no_plan_is_refused(
    tmp_path: Path, content: bytes, message: str
) -> None:
    path = tmp_path / "plan.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message) as error:
        Plan.load(path)
    assert "plan.json" in str(error.value)


def test_a_truncated_plan_is_refused(plan: Plan, tmp_path: Path) -> None:
    path = saved(plan, tmp_path)
    text = path.read_text()
    path.write_text(text[: len(text) // 2])
    with pytest.raises(InputError, match=r"plan\.json:\d+:\d+: not JSON"):
        Plan.load(path)


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
        Plan.load(tmp_path / "plan.json")
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        Plan.load(tmp_path)


SEGMENT = ("tasks", 0, "segments", 2)


@pytest.mark.parametrize(
    ("keys", "value", "message"),
    [
        (
            (*SEGMENT, "times", 3),
            float("nan"),
            r"tasks\[0\]\.segments\[2\]\.times\[3\]",
        ),
        ((*SEGMENT, "times", 3), True, r"segments\[2\]\.times\[3\].*not True"),
        ((*SEGMENT, "times", 3), "1", r"segments\[2\]\.times\[3\].*not '1'"),
        ((*SEGMENT, "positions", 1), [0.0] * 9, r"positions\[1\]: 9 numbers for 10"),
        ((*SEGMENT, "positions"), [], r"segments\[2\]: 0 rows of positions for 12"),
        ((*SEGMENT, "attached"), {"x": [[1, 0, 0, 0]]}, r"attached\.x"),
        (
            (*SEGMENT, "objects", "bottle", 3),
            [0, 0, 1, 1],
            r"objects\.bottle: not a pose",
        ),
        (
            (*SEGMENT, "objects", "bottle", 0),
            [2, 0, 0, 1],
            r"objects\.bottle: not a pose",
        ),
        (("tasks",), [], "tasks"),
        (("seeed",), 7, "seeed: Extra inputs are not permitted"),
        (("created",), "yesterday", "created"),
        (("robot", "joints"), None, r"robot\.joints"),
        (("duration",), 1e400, "duration.*finite"),
    ],
)
def test_faults_are_named_by_their_key_path(
    plan: Plan, tmp_path: Path, keys: tuple[str | int, ...], value: Any, message: str
) -> None:
    path = saved(plan, tmp_path)
    spoil(path, *keys, value=value)
    with pytest.raises(InputError, match=message):
        Plan.load(path)


def test_all_faults_come_at_once_but_not_thousands(plan: Plan, tmp_path: Path) -> None:
    path = saved(plan, tmp_path)
    rows = len(plan.tasks[0].segments[0].times)
    spoil(path, "tasks", 0, "segments", 0, "positions", value=[[None] * 10] * rows)
    with pytest.raises(InputError, match=f"and {rows * 10 - 20} more") as error:
        Plan.load(path)
    assert len(error.value.diagnostics) == 21


def test_the_schema_accepts_a_plan_and_refuses_a_spoiled_one(
    plan: Plan, tmp_path: Path
) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    schema = plan_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    content = json.loads(saved(plan, tmp_path).read_text())
    jsonschema.validate(content, schema)
    content["robot"]["joints"] = "base_x"
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(content, schema)


def replay_with_pinocchio(path: Path, urdf: Path, time: float) -> dict[str, Any]:
    """Object poses at a time of the whole plan, as docs/plan_format.md explains."""
    plan = json.loads(path.read_text())
    model = pin.buildModelFromUrdf(str(urdf))
    data = model.createData()
    for task in plan["tasks"]:
        for segment in task["segments"]:
            times = segment["times"]
            if time > times[-1] and segment is not plan["tasks"][-1]["segments"][-1]:
                time -= times[-1]
                continue
            i = max(k for k in range(len(times) - 1) if times[k] <= time or k == 0)
            h = times[i + 1] - times[i]
            s = min((time - times[i]) / h, 1.0)
            q = pin.neutral(model)
            for k, joint in enumerate(plan["robot"]["joints"]):
                p0, p1 = (segment["positions"][i + e][k] for e in (0, 1))
                v0, v1 = (segment["velocities"][i + e][k] for e in (0, 1))
                q[model.joints[model.getJointId(joint)].idx_q] = (
                    (2 * s**3 - 3 * s**2 + 1) * p0
                    + (s**3 - 2 * s**2 + s) * h * v0
                    + (3 * s**2 - 2 * s**3) * p1
                    + (s**3 - s**2) * h * v1
                )
            pin.framesForwardKinematics(model, data, q)
            T_world_tool = data.oMf[model.getFrameId(plan["robot"]["tool"])].homogeneous
            poses = {name: np.array(T) for name, T in segment["objects"].items()}
            for name, T_tool_object in segment["attached"].items():
                poses[name] = T_world_tool @ np.array(T_tool_object)
            return poses
    raise AssertionError("a plan without segments")


def test_a_program_without_mmplan_replays_the_file(plan: Plan, tmp_path: Path) -> None:
    path = saved(plan, tmp_path)
    urdf = assets.robots_folder() / "puma_mobile" / "puma_mobile.urdf"
    problem = bottle_problem()
    start = replay_with_pinocchio(path, urdf, 0.0)["bottle"]
    goal = replay_with_pinocchio(path, urdf, plan.duration)["bottle"]
    assert start == pytest.approx(problem.objects[0].T_world_object, abs=1e-9)
    assert goal == pytest.approx(problem.tasks[0].T_world_goal, abs=1e-9)
    durations = [segment.duration for segment in plan.tasks[0].segments]
    half_way = sum(durations[:4]) + durations[4] / 2
    lifted = replay_with_pinocchio(path, urdf, half_way)["bottle"]
    assert lifted[1, 3] == pytest.approx((start[1, 3] + goal[1, 3]) / 2, abs=1e-9)
    assert lifted[2, 3] == pytest.approx(start[2, 3] + 0.08, abs=1e-9)
