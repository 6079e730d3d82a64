"""A peer in a process of its own, with whatever Python it is installed for.

    python serve.py roboplan

reads a line of JSON at a time: an arena as `world.py` describes it, which it prepares
for, or a seed, with which it plans. Answers are a line each; times are CPU seconds.
"""

from __future__ import annotations

import json
import sys
import time
from importlib import import_module


def main() -> None:
    """Answer until nobody asks any more."""
    answers = sys.stdout
    sys.stdout = sys.stderr  # peers print
    peer_class = import_module(f"{sys.argv[1]}_peer").Peer
    peer = None
    for line in sys.stdin:
        request = json.loads(line)
        begin = time.process_time()
        if "world" in request:
            peer = peer_class(request["world"], **request["settings"])
            answer = {"seconds": time.process_time() - begin}
        else:
            answer = peer.plan(request["seed"])
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main()
