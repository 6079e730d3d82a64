"""Where every joint of a plan is at a time: from `mmplan export --to csv`.

    python replay_csv.py plan.csv 2.5

Needs numpy.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
from hermite import hermite


def main(file: str, time: str) -> None:
    """Print the joints' positions at a time (s)."""
    with Path(file).open(newline="", encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    joints = [n.removesuffix("_velocity") for n in rows[0] if n.endswith("_velocity")]
    times = np.array([float(row["time"]) for row in rows])
    positions = np.array([[float(row[j]) for j in joints] for row in rows])
    velocities = [[float(row[f"{j}_velocity"]) for j in joints] for row in rows]
    q = hermite(float(time), times, positions, np.array(velocities))
    for joint, value in zip(joints, q, strict=True):
        print(f"{joint} {value:.9f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
