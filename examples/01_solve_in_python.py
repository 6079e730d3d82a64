"""Solve a scene in Python and look at the plan."""

from __future__ import annotations

from pathlib import Path

import mmplan

SCENE = Path(__file__).parent / "cup.yaml"


def main() -> None:
    """Load, solve, print, save, load again, prove."""
    problem = mmplan.load_problem(SCENE)
    plan = mmplan.solve(problem, seed=1)
    for task in plan.tasks:
        print(f"{task.object} by grasp '{task.grasp}'")
        print(f"  base at the start {task.start.base}, at the goal {task.goal.base}")
        for segment in task.segments:
            print(f"  {segment.name:9} {segment.duration:5.2f} s")
    plan.save("plan.json")
    report = mmplan.verify(mmplan.Plan.load("plan.json"), problem)
    assert report.clearance is not None
    print(f"proven; smallest clearance {1000 * report.clearance.distance:.1f} mm")


if __name__ == "__main__":
    main()
