"""How long whole commands take, from the shell's point of view.

    python benchmarks/commands.py [--seeds 10]

Each command is a process of its own; the commands take turns, seed by seed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

MMPLAN = [sys.executable, "-m", "mmplan"]
FAULTY = "mmplan: 1\nname: faulty\nrobot: {model: puma_mobil}\nobstacle: {}\n"


def main() -> None:
    """Print the median of each command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    seeds = parser.parse_args().seeds
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "faulty.yaml").write_text(FAULTY)
        seconds = {
            command: [
                _seconds(command.format(seed=seed), folder) for seed in range(seeds)
            ]
            for command in (
                "--help",
                "check faulty.yaml",
                "solve wineglass --seed {seed} -o plan.json --quiet",
                "solve plate --seed {seed} -o plan.json --quiet",
                "verify plan.json",
            )
        }
    print("| command | seconds, median | slowest |\n|---|---|---|")
    for command, values in seconds.items():
        print(f"| `mmplan {command}` | {np.median(values):.2f} | {max(values):.2f} |")


def _seconds(arguments: str, folder: Path) -> float:
    begin = time.perf_counter()
    subprocess.run(
        [*MMPLAN, *arguments.split()], cwd=folder, capture_output=True, check=False
    )
    return time.perf_counter() - begin


if __name__ == "__main__":
    main()
