"""Where every joint of a plan is at a time: from `mmplan export --to npz`.

    python replay_npz.py plan.npz 2.5

Needs numpy.
"""

from __future__ import annotations

import sys

import numpy as np
from hermite import hermite


def main(file: str, time: str) -> None:
    """Print the joints' positions at a time (s)."""
    with np.load(file, allow_pickle=False) as plan:
        samples = [plan[name] for name in ("times", "positions", "velocities")]
        for joint, value in zip(
            plan["joints"], hermite(float(time), *samples), strict=True
        ):
            print(f"{joint} {value:.9f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
