"""Peers that run in a process of their own, as mmplan's benchmark wants planners."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

from peers.world import describe, path_of

from mmplan.benchmarking.paths.arena import Arena
from mmplan.benchmarking.paths.records import Answer, Prepared
from mmplan.exceptions import MmplanError


class Process:
    """A peer, and the Python that it is installed for."""

    def __init__(self, name: str, python: str, folder: Path) -> None:
        """Start it; worlds are written to the folder."""
        self._name, self._folder = name, folder
        self._process = subprocess.Popen(
            [python, str(Path(__file__).with_name("serve.py")), name],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def prepare(
        self, arena: Arena, step: float, reach: float, time_limit: float
    ) -> Prepared:
        """The planner for an arena; there is one at a time."""
        settings = {"step": step, "reach": reach, "time_limit": time_limit}
        world = describe(arena, self._folder)
        answer = self._ask({"world": world, "settings": settings})

        def plan(seed: int) -> Answer:
            told = self._ask({"seed": seed})
            for key in ("first", "path"):
                told[key] = path_of(arena, told.get(key))
            return Answer(**told)

        return Prepared(plan, answer["seconds"])

    def end(self) -> None:
        """End the process."""
        self._process.communicate()

    def _ask(self, request: dict[str, Any]) -> dict[str, Any]:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            pass  # reading tells
        line = self._process.stdout.readline()
        if not line:
            raise MmplanError(f"{self._name}: its process ended; see its errors above")
        answer: dict[str, Any] = json.loads(line)
        return answer
