"""roboplan's time parametrization of paths, in a process of its own.

    python roboplan_timing.py < request.json

The request has an arena as `world.py` describes it, `acceleration` (rad/s², one number
a joint) and `paths`. The answer has a duration (s) for each path, null where roboplan
finds none, and the CPU seconds that each took.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from roboplan import core, toppra


def main() -> None:
    """Answer one request."""
    request = json.load(sys.stdin)
    world, answers = request["world"], sys.stdout
    sys.stdout = sys.stderr  # it prints
    scene = core.Scene("timing", core.loadUrdfSceneDescription(world["urdf"]))
    scene.importSrdf(Path(world["srdf"]).read_text(encoding="utf-8"))
    limits = {
        name: {"max_acceleration": [value]}
        for name, value in zip(world["joints"], request["acceleration"], strict=True)
    }
    with tempfile.TemporaryDirectory() as folder:
        config = Path(folder) / "limits.yaml"
        config.write_text(json.dumps({"joint_limits": limits}))  # JSON is YAML
        scene.importJointLimitsFromConfig(core.loadJointLimitsConfig(config))
    found = [_timed(scene, world, np.array(path)) for path in request["paths"]]
    print(json.dumps(found), file=answers)


def _timed(scene: core.Scene, world: dict, path: np.ndarray) -> dict:
    begin = time.process_time()
    made = core.JointPath()
    made.joint_names, made.positions = world["joints"], list(path)
    try:
        timing = toppra.PathParameterizerTOPPRA(scene, world["group"])
        duration = float(timing.generate(made).times[-1])
    except RuntimeError:
        duration = None
    return {"duration": duration, "seconds": time.process_time() - begin}


if __name__ == "__main__":
    main()
