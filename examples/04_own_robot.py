"""A robot of one's own: a folder with a robot.yaml and the URDF that it names.

This one is the Puma with a wider base that is not to go fast. `mmplan robot import`
writes a first robot.yaml for any URDF.
"""

from __future__ import annotations

from pathlib import Path

import mmplan
from mmplan.assets import robots_folder

HERE = Path(__file__).parent


def main() -> None:
    """Write the robot and a scene with it into this folder, then solve the scene."""
    shipped = robots_folder() / "puma_mobile"
    folder = Path("slow_puma")
    folder.mkdir(exist_ok=True)
    urdf = (shipped / "puma_mobile.urdf").read_text(encoding="utf-8")
    wide = urdf.replace('radius="0.28" length="0.33"', 'radius="0.32" length="0.33"')
    (folder / "slow_puma.urdf").write_text(wide, encoding="utf-8")
    text = (shipped / "robot.yaml").read_text(encoding="utf-8")
    for old, new in (
        ("name: puma_mobile", "name: slow_puma"),
        ("urdf: puma_mobile.urdf", "urdf: slow_puma.urdf"),
        ("radius: 0.28", "radius: 0.32"),
        ("base_x: 0.8", "base_x: 0.3"),
        ("base_y: 0.8", "base_y: 0.3"),
    ):
        assert old in text, f"the shipped robot.yaml has no '{old}' any more"
        text = text.replace(old, new)
    (folder / "robot.yaml").write_text(text, encoding="utf-8")

    scene = (HERE / "cup.yaml").read_text(encoding="utf-8")
    own = scene.replace("model: puma_mobile", "model: slow_puma/robot.yaml")
    Path("own_robot.yaml").write_text(own, encoding="utf-8")

    problem = mmplan.load_problem("own_robot.yaml")
    print(f"{problem.robot.name}: base of {2 * problem.robot.base_radius:.2f} m")
    print(f"solved: {mmplan.solve(problem, seed=1).duration:.2f} s of motion")


if __name__ == "__main__":
    main()
