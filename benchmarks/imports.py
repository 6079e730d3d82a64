"""What `mmplan robot import` makes of URDFs that are not shipped as robots.

Each robot of the list, all of example-robot-data, is imported into a folder that is
thrown away, loaded, and looked at. The table is the one in docs/robots.md.

    python benchmarks/imports.py [names ...]
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

from mmplan.assets import example_robots
from mmplan.exceptions import InputError, MmplanError
from mmplan.robot_build import load_robot
from mmplan.robot_setup.importing import import_robot
from mmplan.robot_setup.measurements import measure_ik
from mmplan.robot_setup.wishes import Wishes


class Case(NamedTuple):
    """A URDF in the folder of robots, and what is asked for."""

    urdf: str
    base: str
    tip: str


CASES = {
    "z1": Case("z1_description/urdf/z1.urdf", "planar", "gripperStator"),
    "baxter": Case(
        "baxter_description/urdf/baxter.urdf", "planar", "right_gripper_base_link"
    ),
    "tiago_pro": Case(
        "tiago_pro_description/robots/tiago_pro.urdf",
        "planar",
        "gripper_left_base_link",
    ),
    "talos_left_arm": Case(
        "talos_data/robots/talos_left_arm.urdf", "fixed", "gripper_left_base_link"
    ),
    "so101": Case("so_arm_description/urdf/so101.urdf", "fixed", "gripper_frame_link"),
    "ur3": Case("ur_description/urdf/ur3_robot.urdf", "fixed", "tool0"),
    "anymal_kinova": Case(
        "anymal_b_simple_description/robots/anymal-kinova.urdf",
        "planar",
        "j2s6s200_end_effector",
    ),
    "alex_psyonic": Case(
        "alex_description/urdf/alex_psyonic_hands.urdf", "planar", "LeftGripper"
    ),
}


def row(name: str, case: Case, folder: Path) -> str:
    """The line of the table of one import."""
    share = example_robots()
    if share is None:
        raise SystemExit("needs example-robot-data: pip install 'mmplan[robots]'")
    urdf = share / "example-robot-data" / "robots" / case.urdf
    asked = f"| {name} | {case.base} | `{case.tip}` |"
    start = perf_counter()
    try:
        wishes = Wishes(base=case.base, tip=case.tip, name=name)
        imported = import_robot(urdf, wishes, folder / name)
        robot = load_robot(imported.path)
    except MmplanError as error:
        text = str(error).splitlines()[0].replace(f"{urdf.parent}/", "")
        text = text.partition("; did you mean")[0]
        count = len(error.diagnostics) if isinstance(error, InputError) else 1
        more = f" (the first of {count} faults)" if count > 1 else ""
        return f"{asked} - | - | - | - | refused: {text}{more} |"
    seconds = perf_counter() - start
    ik = measure_ik(robot, 500)
    pairs = next(n for n in imported.notes if n.startswith("pairs"))
    return (
        f"{asked} {len(robot.arm)} | {int(robot.hand.leads.sum())} | "
        f"{robot.reach:.2f} m | {100 * ik.solved:.1f} % | "
        f"{pairs.removeprefix('pairs of links: ')}; {seconds:.0f} s |"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=list(CASES), help=", ".join(CASES))
    print("| Robot | `--base` | `--tip` | Arm | Hand | Reach | IK | Result |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for name in parser.parse_args(arguments).names:
            print(row(name, CASES[name], Path(folder)), flush=True)


if __name__ == "__main__":
    main()
