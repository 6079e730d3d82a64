"""Where every object is in every segment of a plan."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mmplan.plan import Segment, TaskPlan
from mmplan.problem import Problem
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Stage:
    """One segment with the state of the world in it.

    An object stands where its task found it (`T_world_start`) until it is attached,
    and after that where the tool left it. `T_world_goal` is where the task wants it.
    """

    task_index: int
    task: TaskPlan
    segment: Segment
    standing: dict[str, Array]  # object -> T_world_object (4, 4)
    attached: dict[str, Array]  # object -> T_tool_object (4, 4)
    T_world_start: Array  # (4, 4)
    T_world_goal: Array  # (4, 4)

    @property
    def place(self) -> str:
        """Which segment this is, for messages."""
        return place_of(self.task_index, self.task, self.segment)

    def object_poses(self, T_world_tool: Array) -> dict[str, Array]:
        """T_world_object of every object while the tool is at a pose (4, 4)."""
        carried = {name: T_world_tool @ T for name, T in self.attached.items()}
        return {**self.standing, **carried}


def place_of(index: int, task: TaskPlan, segment: Segment) -> str:
    """A segment as messages name it: task (from 1), object, segment."""
    return f"task {index + 1} ({task.object}), {segment.name}"


def replay(problem: Problem, tasks: Sequence[TaskPlan]) -> Iterator[Stage]:
    """The stages of a plan for a problem, in order.

    Every object named in `tasks` must be one of the problem; there must not be more
    tasks than the problem has.
    """
    standing = {item.name: item.T_world_object for item in problem.objects}
    for index, task in enumerate(tasks):
        T_world_start = standing[task.object]
        for segment in task.segments:
            still = {k: T for k, T in standing.items() if k not in segment.attached}
            stage = Stage(
                task_index=index,
                task=task,
                segment=segment,
                standing=still,
                attached=segment.attached,
                T_world_start=T_world_start,
                T_world_goal=problem.tasks[index].T_world_goal,
            )
            yield stage
            T_world_tool = problem.robot.tool_pose(segment.positions[-1])
            standing = stage.object_poses(T_world_tool)
