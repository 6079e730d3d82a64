"""Make the pictures of README.md and of docs/, by the commands shown there.

    python benchmarks/make_pictures.py [FOLDER]

The figures are those of D. Berenson, J. Kuffner, H. Choset: "An Optimization Approach
to Planning for Mobile Manipulation" (2008), with our scenes and our planner. All but
the first picture of figure 1 come from `mmplan render`; that one shows a grasp that no
plan has. `_families.py` draws those of grasps.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from _families import draw_families
from PIL import Image

import mmplan
from mmplan import assets
from mmplan.cli import main
from mmplan.kinematics import joint_placements
from mmplan.problem import Problem
from mmplan.shapes import Array
from mmplan.visualization.exhibit import Exhibit, exhibit_of_scene
from mmplan.visualization.part import object_carrier
from mmplan.visualization.pictures import Look, write_pictures
from mmplan.visualization.robot_parts import joint_poses

SEED = "7"
HIDDEN = "paths,ghosts,tool frame"
SMALL = ("--size", "480x400")
# Close to the glass, from beside the arm: in the rack and on the counter.
RACK = "265,32,0.95,1.06,-0.5,0.52"
GLASS = "265,18,0.95,1.68,0.35,1.02"
# The room, as near as all of the motion is in view.
ROOM = "205,33,4.5,0.6,0.0,0.75"
# A power grasp of the bowl: height on the axis (m) and direction (rad).
BOWL = (0.17, np.pi)
BROKEN = Path(__file__).parent.parent / "tests" / "broken"


def make(folder: Path) -> None:
    """Make all pictures in a folder."""
    plans = {name: folder / f"{name}.json" for name in ("wineglass", "plate")}
    for name, plan in plans.items():
        run("solve", name, "--seed", SEED, "-o", str(plan), "--quiet")
    for name in assets.scene_names():
        render(name, folder / f"{name}_scene.webp", "--size", "480x300")
    glass, plate = (str(plan) for plan in plans.values())
    film = ("--size", "480x300", "--rate", "10", "--camera", ROOM)
    render(glass, folder / "wineglass.webp", *film, "--hide", "ghosts,tool frame")
    render_figure_1(glass, folder)
    room = ("--camera", ROOM, "--hide", HIDDEN)
    render(plate, folder / "figure_4.webp", *SMALL, *room, "--time", "start,goal")
    times = ("--size", "300x260", "--time", "0,1.6,start,5.2,6.6,goal")
    render(glass, folder / "figure_5.webp", *times, *room)
    for plan in plans.values():
        plan.unlink()
    draw_families(folder / "families.webp")
    for name in ("bowl_only", "too_high"):
        picture = folder / f"miss_{name}.webp"
        scene = str(BROKEN / f"{name}.yaml")
        run("explain", scene, "-o", str(picture), "--size", "480x300", fails=True)


def render_figure_1(plan: str, folder: Path) -> None:
    """The power grasp in the rack; the grasp of the plan there; its start."""
    parts = [folder / f"part_{k}.png" for k in range(3)]
    look = Look(
        (480, 400), RACK, (0.0,), hidden=frozenset(("reach", "ghosts", "grasps"))
    )
    write_pictures(parts[0], power_grasp(mmplan.load_problem("wineglass")), look)
    for part, camera, time in ((parts[1], RACK, "goal"), (parts[2], GLASS, "start")):
        render(plan, part, *SMALL, "--camera", camera, "--time", time, "--hide", HIDDEN)
    pictures = [np.asarray(Image.open(part).convert("RGB")) for part in parts]
    gap = np.full((400, 4, 3), 255, np.uint8)
    row = np.hstack([pictures[0], gap, pictures[1], gap, pictures[2]])
    Image.fromarray(row).save(folder / "figure_1.webp", quality=80)
    for part in parts:
        part.unlink()


def power_grasp(problem: Problem) -> Exhibit:
    """The glass at its goal, held by its bowl, as if nothing were in the way."""
    scene, robot = exhibit_of_scene(problem), problem.robot
    task, (family,) = problem.tasks[0], problem.object("wineglass").grasps.values()
    T_world_tool = task.T_world_goal @ family.tool_poses(np.array([BOWL]))[0]
    q = problem.q_start.copy()
    q[robot.hand.indices] = 0.035  # the fingers about the bowl
    q[robot.base.indices], q[robot.arm.indices] = nearest_reach(problem, T_world_tool)
    T_world_joint = joint_placements(robot.model, q[None])
    poses = {
        **joint_poses(robot, T_world_joint),
        object_carrier(task.object): task.T_world_goal[None],
    }
    return replace(scene, film=replace(scene.film, poses=poses))


def nearest_reach(problem: Problem, T_world_tool: Array) -> tuple[Array, Array]:
    """A base placement and arm joints that reach a pose, whatever they collide with."""
    robot = problem.robot
    for distance in np.arange(0.5, robot.reach, 0.05):
        for angle in np.linspace(np.pi, np.pi / 2, 12):
            away = distance * np.array([np.cos(angle), np.sin(angle)])
            q_base = T_world_tool[:2, 3] + away
            T_world_base = robot.base_poses(q_base[None])[0]
            T_base_tool = np.linalg.inv(T_world_base) @ T_world_tool
            found = robot.ik.solve(T_base_tool[None])
            for branch in np.flatnonzero(found.within[0]):
                return q_base, found.q[0, branch]
    raise AssertionError("the bowl is out of reach")


def render(subject: str, picture: Path, *options: str) -> None:
    """Run `mmplan render`, and say how."""
    run("render", subject, "-o", str(picture), "--quiet", *options)


def run(*arguments: str, fails: bool = False) -> None:
    """Run a command of mmplan, and say how; `fails` if it has to find no plan."""
    print("mmplan", *arguments, flush=True)
    if main(arguments) != int(fails):
        sys.exit(1)


if __name__ == "__main__":
    default = Path(__file__).parent.parent / "docs" / "pictures"
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    folder.mkdir(exist_ok=True)
    make(folder)
