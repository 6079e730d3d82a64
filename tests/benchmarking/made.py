"""What the tests of the benchmark share: a quick contest, and records made up."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mmplan.benchmarking import Record, Store
from mmplan.benchmarking.store import STORE_FILE, ProblemEntry
from tests.tabletop import cup_scene

CONVERTER = Path(sys.executable).parent / "ompl_benchmark_statistics"
COMMAND = (sys.executable, "-m", "mmplan", "benchmark")
# Populations so small that a few evaluations are several cycles.
SMALL = "{bases: 6, grasps: 6, partners: 2}"


def contest_scene(folder: Path, **settings: str) -> Path:
    """The cup's task with small populations."""
    return cup_scene(folder, **{"optimizer": SMALL, **settings})


def start(*arguments: object) -> subprocess.Popen[str]:
    """The command in the background, in a process group of its own."""
    return subprocess.Popen(
        [*COMMAND, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def stored(folder: Path) -> list[Record]:
    """The records of a folder."""
    with Store(folder) as store:
        return store.records()


def results(folder: Path) -> list[dict[str, Any]]:
    """What must be the same however the runs were done."""
    return [record.result for record in stored(folder)]


def children(process: int) -> set[int]:
    """The ids of a process's children."""
    found = set()
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        found |= {int(child) for child in task.read_text().split()}
    return found


def is_alive(process: int) -> bool:
    """Whether a process is there and not a zombie."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def is_group_alive(group: int) -> bool:
    """Whether any process of a group is there."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def has_runs(folder: Path) -> bool:
    """Whether a folder has a store with runs in it."""
    return (folder / STORE_FILE).exists() and bool(stored(folder))


def wait_until(condition: Callable[[], bool]) -> None:
    """Wait for something that another process brings about."""
    deadline = time.monotonic() + 90
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)


FLOOR_PLAN: dict[str, Any] = {
    "bodies": [
        {
            "owner": "table",
            "kind": "obstacle",
            "corners": [[1.0, -1.0], [2.0, -1.0], [2.0, 1.0], [1.0, 1.0]],
            "heights": [0.0, 0.8],
        },
        {
            "owner": "lamp",
            "kind": "obstacle",
            "corners": [[1.4, 0.0], [1.6, 0.0], [1.5, 0.3], [1.5, 0.1]],
            "heights": [1.5, 1.9],
        },
    ],
    "start": [1.2, 0.3],
    "goal": [1.2, -0.3],
    "radius": 0.28,
}


def entry(name: str = "wineglass") -> ProblemEntry:
    """A problem that only the store and the report know."""
    return ProblemEntry(name, f"/scenes/{name}.yaml", "f" * 64, FLOOR_PLAN)


def made_up(**fields: Any) -> Record:
    """A record as no run made it, of a run that succeeded unless told otherwise."""
    score = fields.get("score", 80.0)
    ends = {
        end: {
            "base": [0.5, y],
            "score": {"grasp": 0.0, "manipulability": score / 4, "clutter": score / 4},
        }
        for end, y in (("start", 0.4), ("goal", -0.4))
    }
    values: dict[str, Any] = {
        "problem": "wineglass",
        "optimizer": "coevolution",
        "evaluations": 6940,
        "planner": "",
        "seed": 0,
        "settings": "{}",
        "label": "CoEvolution",
        "success": True,
        "score": score,
        "ends": ends,
        "grasp": "stem",
        "genes": [0.05, 1.5],
        "used": 6940,
        "cycles": 3.35,
        "history": [[700, score / 2], [3000, score], [6940, score]],
        "outcomes": {"start": {"feasible": 5}, "goal": {"feasible": 4}},
        "failure": None,
        "plan": None,
        "seconds": [0.1, 0.5, 1.0],
        "times": {
            "collision": {"cpu": 0.5, "wall": 0.6},
            "optimizer": {"cpu": 0.25, "wall": 0.4},
        },
        "host": "somewhere",
        "finished": "2026-01-02T03:04:05+00:00",
    }
    return Record(**{**values, **fields})


def failed(**fields: Any) -> Record:
    """A record of a run that found nothing."""
    nothing: dict[str, Any] = {
        "success": False,
        "score": 0.0,
        "ends": {},
        "grasp": None,
        "genes": None,
        "history": [[6940, 0.0]],
        "seconds": [1.0],
    }
    return made_up(**{**nothing, **fields})


def converted(log: str, folder: Path) -> sqlite3.Connection:
    """The database that `ompl_benchmark_statistics` makes of a log."""
    path, database = folder / "benchmark.log", folder / "arena.db"
    path.write_text(log)
    done = subprocess.run(
        [CONVERTER, path, "-d", database], capture_output=True, text=True, check=True
    )
    assert "duplicate" not in done.stdout
    assert done.stderr == ""
    connection = sqlite3.connect(database)
    connection.row_factory = sqlite3.Row
    return connection
