"""What `benchmarks/paths.py` tells other planners, and hears from them."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest

from mmplan.benchmarking.paths.arena import contestant, make_arena
from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.exceptions import MmplanError
from tests.benchmarking.paths.made import MOTIONBENCHMAKER, arena, box, panda

BENCHMARKS = MOTIONBENCHMAKER.parents[1]
FAKE = """
class Peer:
    def __init__(self, world, step, reach, time_limit):
        print("peers may print")
        self.world, self.settings = world, [step, reach, time_limit]
    def plan(self, seed):
        if seed == 1:
            return {"first_seconds": 9.0, "message": "lost"}
        if seed == 2:
            raise SystemExit
        path = [self.world["start"], self.world["goal"]]
        return {"first": path, "first_seconds": 1.0, "path": path, "seconds": 2.0}
"""


@pytest.fixture
def peers(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The scripts' own package."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import peers.naive
    import peers.process
    import peers.world

    yield peers
    for name in [n for n in sys.modules if n.partition(".")[0] == "peers"]:
        del sys.modules[name]


@pytest.mark.parametrize("name", ["panda", "tiago"])
def test_the_files_are_the_robot(peers: ModuleType, tmp_path: Path, name: str) -> None:
    """A model of the files collides where mmplan's does, at the same places."""
    file = {"panda": "panda_motionbenchmaker.json.gz", "tiago": "tiago_whole_body.json"}
    problem = load_path_problems(MOTIONBENCHMAKER.with_name(file[name])).problems[0]
    made = make_arena(contestant(name), problem)
    world = peers.world.describe(made, tmp_path)
    model = pin.buildModelFromUrdf(world["urdf"])
    assert list(model.names[1:]) == world["joints"]
    np.testing.assert_allclose(model.lowerPositionLimit, world["lower"])
    np.testing.assert_allclose(model.upperPositionLimit, world["upper"])
    geometry = pin.buildGeomFromUrdf(model, world["urdf"], pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairs(model, geometry, world["srdf"])
    data, geometry_data = model.createData(), geometry.createData()
    rng = np.random.default_rng(0)
    lower, upper = made.joints.lower, made.joints.upper
    q = np.tile(made.q_start, (150, 1))
    q[:, made.joints.indices] = rng.uniform(lower, upper, (150, len(lower)))
    alone = make_arena(
        contestant(name), type(problem)("", 0, problem.q_start, problem.q_goal, ())
    )
    theirs = [
        pin.computeCollisions(
            model, data, geometry, geometry_data, each[made.joints.indices], True
        )
        for each in q
    ]
    ours = alone.world.in_collision(q)
    assert theirs == ours.tolist()
    assert 0 < sum(theirs) < 150
    moved = [body.parentJoint > 0 for body in geometry.geometryObjects]
    assert sum(moved) > 5


def test_meshes_are_marked_as_convex(peers: ModuleType, tmp_path: Path) -> None:
    world = peers.world.describe(arena(), tmp_path)
    root = ET.parse(world["urdf"]).getroot()
    meshes = [
        body.get("name")
        for body in root.iter("collision")
        if body.find("geometry/mesh") is not None
    ]
    marked = [c.get("name") for c in root.findall("link/collision_checking/convex")]
    assert marked == meshes
    assert len(meshes) == 9


def test_a_peer_in_a_process_of_its_own(
    peers: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "fake_peer.py").write_text(FAKE)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    process = peers.process.Process("fake", sys.executable, tmp_path)
    made = arena(box((0.1, 0.1, 0.1), 1.0, 0.0, 0.0))
    prepared = process.prepare(made, step=0.1, reach=1.0, time_limit=2.0)
    assert 0.0 < prepared.seconds < 1.0
    found = prepared.plan(0)
    np.testing.assert_array_equal(found.first, [made.q_start, made.q_goal])
    np.testing.assert_array_equal(found.path, found.first)
    assert (found.first_seconds, found.seconds) == (1.0, 2.0)
    lost = prepared.plan(1)
    assert (lost.first, lost.first_seconds, lost.message) == (None, 9.0, "lost")
    with pytest.raises(MmplanError, match="fake: its process ended"):
        prepared.plan(2)
    process.end()


def test_the_naive_script_plans(peers: ModuleType) -> None:
    made = arena(box((0.06, 0.06, 1.0), 0.244, 0.251, 0.5))
    prepared = peers.naive.prepare(made, step=1 / 32, reach=1.0, time_limit=20.0)
    found = prepared.plan(0)
    assert not made.world.any_collision(found.first)
    np.testing.assert_array_equal(found.first[[0, -1]], [made.q_start, made.q_goal])
    edges = np.linalg.norm(np.diff(found.first, axis=0), axis=1)
    assert edges.max() <= 1.0 + 1e-9
    assert found.states > np.sum(edges) * 32
    again = prepared.plan(0)
    np.testing.assert_array_equal(again.first, found.first)


def test_the_naive_script_gives_up(peers: ModuleType) -> None:
    walled = arena(
        box((1.0, 0.02, 3.0), 0.3, 0.25, 0.0), box((0.02, 1.0, 3.0), 0, 0, 0)
    )
    prepared = peers.naive.prepare(walled, step=0.5, reach=1.0, time_limit=0.05)
    found = prepared.plan(0)
    assert found.first is None
    assert found.message


def test_problems_are_told_in_plain_numbers(peers: ModuleType, tmp_path: Path) -> None:
    world = peers.world.describe(arena(box((1.0, 2.0, 3.0), 4.0, 5.0, 6.0)), tmp_path)
    told = json.loads(json.dumps(world))
    (thing,) = told["obstacles"]
    assert (thing["type"], thing["size"]) == ("box", [1.0, 2.0, 3.0])
    assert [row[3] for row in thing["pose"]] == [4.0, 5.0, 6.0, 1.0]
    assert told["still"] == ["panda_link0"]
    assert len(told["start"]) == len(panda().robot.arm) == 7
