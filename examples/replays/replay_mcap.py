"""Where every joint of a plan is at a time: from `mmplan export --to mcap`.

    python replay_mcap.py plan.mcap 2.5

Needs numpy, mcap and mcap-ros2-support.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from hermite import hermite
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


def main(file: str, time: str) -> None:
    """Print the joints' positions at a time (s)."""
    times, states = [], []
    with Path(file).open("rb") as recording:
        reader = make_reader(recording, decoder_factories=[DecoderFactory()])
        found = reader.iter_decoded_messages(topics=["/joint_states"])
        for _, _, record, state in found:
            times.append(1e-9 * record.log_time)
            states.append(state)
    positions = np.array([state.position for state in states])
    velocities = np.array([state.velocity for state in states])
    q = hermite(float(time), np.array(times), positions, velocities)
    for joint, value in zip(states[0].name, q, strict=True):
        print(f"{joint} {value:.9f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
