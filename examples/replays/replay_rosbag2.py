"""Where every joint of a plan is at a time: from `mmplan export --to rosbag2`.

    python replay_rosbag2.py bag 2.5

Needs numpy and rosbags.
"""

from __future__ import annotations

import sys

import numpy as np
from hermite import hermite
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore


def main(folder: str, time: str) -> None:
    """Print the joints' positions at a time (s)."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    times, states = [], []
    with Reader(folder) as bag:
        topics = [c for c in bag.connections if c.topic == "/joint_states"]
        for connection, stamp, data in bag.messages(connections=topics):
            times.append(1e-9 * stamp)
            states.append(types.deserialize_cdr(data, connection.msgtype))
    positions = np.array([state.position for state in states])
    velocities = np.array([state.velocity for state in states])
    q = hermite(float(time), np.array(times), positions, velocities)
    for joint, value in zip(states[0].name, q, strict=True):
        print(f"{joint} {value:.9f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
