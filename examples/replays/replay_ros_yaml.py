"""Where arm, hand and base are at a time: from `mmplan export --to ros-yaml`.

    python replay_ros_yaml.py plan.yaml 2.5

Needs numpy and PyYAML. The base's pose is printed at the sample before that time.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from hermite import hermite


def main(file: str, time: str) -> None:
    """Print the joints' positions and the base's pose at a time (s)."""
    with Path(file).open(encoding="utf-8") as text:
        message = next(yaml.safe_load_all(text))
    arm, base = message["joint_trajectory"], message["multi_dof_joint_trajectory"]
    times = np.array([seconds(p["time_from_start"]) for p in arm["points"]])
    samples = [
        np.array([point[name] for point in arm["points"]])
        for name in ("positions", "velocities")
    ]
    q = hermite(float(time), times, *samples)
    for joint, value in zip(arm["joint_names"], q, strict=True):
        print(f"{joint} {value:.9f}")
    point = base["points"][int(np.searchsorted(times, float(time), "right")) - 1]
    for name, transform in zip(base["joint_names"], point["transforms"], strict=True):
        at = transform["translation"]
        print(f"{name} at {at['x']:.4f} {at['y']:.4f} {at['z']:.4f}")


def seconds(time: dict[str, Any]) -> float:
    """A duration of ROS in s."""
    return float(time["sec"] + 1e-9 * time["nanosec"])


if __name__ == "__main__":
    main(*sys.argv[1:])
