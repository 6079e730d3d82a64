"""What it takes to look at a plan: the viewer, the page, pictures and a video.

    python benchmarks/viewing.py [--scene wineglass] [--runs 3]

Each command is a process of its own. CPU seconds are those of all its threads, until
the viewer has sent its page, or until the command ends; the quickest run counts.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path
from typing import NamedTuple

import mmplan

MMPLAN = [sys.executable, "-m", "mmplan"]
SEED = 7
VIDEO = "plan.mp4"
FILES = {
    "plan.html": [],
    "plan.png": ["--size", "640x400"],
    "plan.webp": ["--size", "640x400", "--rate", "10"],
    VIDEO: ["--size", "640x400"],
}


class Cost(NamedTuple):
    """Seconds."""

    cpu: float
    wall: float


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="wineglass")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        solve = ["solve", options.scene, "--seed", str(SEED), "-o", "plan.json"]
        subprocess.run([*MMPLAN, *solve, "--quiet"], cwd=folder, check=True)
        duration = mmplan.Plan.load(folder / "plan.json").duration
        print(f"{options.scene}, seed {SEED}: {duration:.2f} s of motion\n")
        print("| command | CPU s | wall s | MB |\n|---|---|---|---|")
        ready = min(_viewer(folder) for _ in range(options.runs))
        print(f"| `mmplan view plan.json`, until it serves | {_text(ready)} | |")
        for file, look in FILES.items():
            command = ["render", "plan.json", "-o", file, *look]
            cost = min(_command(command, folder) for _ in range(options.runs))
            size = (folder / file).stat().st_size / 1e6
            print(f"| `mmplan {' '.join(command)}` | {_text(cost)} | {size:.2f} |")
            if file == VIDEO:
                ten = Cost(*(10.0 * seconds / duration for seconds in cost))
                print(f"| the same for 10 s of motion | {_text(ten)} | |")


def _text(cost: Cost) -> str:
    return f"{cost.cpu:.1f} | {cost.wall:.1f}"


def _command(arguments: list[str], folder: Path) -> Cost:
    """What a command takes until it ends."""
    begin = time.perf_counter()
    process = subprocess.Popen([*MMPLAN, *arguments, "--quiet"], cwd=folder)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        sys.exit(f"mmplan {' '.join(arguments)}: exit code {process.returncode}")
    return Cost(usage.ru_utime + usage.ru_stime, time.perf_counter() - begin)


def _viewer(folder: Path) -> Cost:
    """What the viewer takes until it has sent its page."""
    begin = time.perf_counter()
    command = [*MMPLAN, "view", "plan.json", "--port", "8200"]
    process = subprocess.Popen(
        command,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    url = process.stdout.readline().strip()
    urllib.request.urlopen(url, timeout=60).read()
    wall = time.perf_counter() - begin
    numbers = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    cpu = sum(int(ticks) for ticks in numbers[11:13]) / os.sysconf("SC_CLK_TCK")
    process.send_signal(signal.SIGINT)
    process.wait()
    return Cost(cpu, wall)


if __name__ == "__main__":
    main()
