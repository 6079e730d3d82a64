"""The panel of the optimizer's candidates, their scores, and the populations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from viser import LineSegmentsHandle, PointCloudHandle, ViserServer

from mmplan.kinematics import joint_placements
from mmplan.scoring import End
from mmplan.shapes import Array
from mmplan.visualization.exhibit import (
    GOAL_COLOUR,
    START_COLOUR,
    Exhibit,
    translucent,
)
from mmplan.visualization.part import ROBOT, SCENE, Part, object_carrier
from mmplan.visualization.robot_parts import joint_poses
from mmplan.visualization.search import CandidateEnd, Cycle, Search, ShownCandidate
from mmplan.visualization.viewer.stage import Stage, rgb
from mmplan.visualization.viewer.widgets import set_value

_NONE = "none shown"
_COLOURS = {End.START: START_COLOUR, End.GOAL: GOAL_COLOUR}
_RED = (200, 30, 30)


class CandidatePanel:
    """Steps through candidates; each is shown as a ghost at start and goal."""

    def __init__(
        self, server: ViserServer, exhibit: Exhibit, found: Sequence[Search]
    ) -> None:
        """Add the widgets."""
        self._server = server
        self._exhibit = exhibit
        self._stages: dict[tuple[End, str], Stage] = {}
        self._lines: dict[End, LineSegmentsHandle] = {}
        many = len(found) > 1
        self._candidates: dict[str, ShownCandidate] = {
            f"{f'task {s.task + 1}: ' if many else ''}{c.label}: {c.total:.1f}": c
            for s in found
            for c in s.candidates
        }
        gui = server.gui
        with gui.add_folder("Candidates of the optimizer", expand_by_default=False):
            names = [_NONE, *self._candidates]
            self._choice = gui.add_dropdown("candidate", names)
            step = gui.add_button_group("step", ["previous", "next"])
            self._ends = {end: gui.add_checkbox(end.name.lower(), True) for end in End}
            self._distances = gui.add_checkbox("distances", True)
            self._table = gui.add_markdown("")
        self._choice.on_update(lambda _: self.update())
        for box in (*self._ends.values(), self._distances):
            box.on_update(lambda _: self.update())
        step.on_click(lambda _: self._step(1 if step.value == "next" else -1))

    def update(self) -> None:
        """Show what the widgets say."""
        chosen = self._candidates.get(self._choice.value)
        for stage in self._stages.values():
            stage.show_all(visible=False)
        for line in self._lines.values():
            line.remove()
        self._lines.clear()
        self._table.content = "" if chosen is None else _tables(chosen)
        if chosen is None:
            return
        for end in End:
            if self._ends[end].value:
                self._show_end(end, chosen.ends[end], chosen.object)

    def _step(self, by: int) -> None:
        names = [_NONE, *self._candidates]
        here = names.index(self._choice.value)
        set_value(self._choice, names[(here + by) % len(names)])
        self.update()

    def _show_end(self, end: End, shown: CandidateEnd, item: str) -> None:
        if (end, item) not in self._stages:
            root = f"/candidate {end.name.lower()} {item}"
            parts = list(_ghosts(self._exhibit, end, item))
            self._stages[end, item] = Stage(self._server.scene, root, parts)
        stage = self._stages[end, item]
        stage.place(_poses(self._exhibit, shown, item))
        stage.show_all(visible=True)
        if self._distances.value and shown.nearest:
            segments = [[n.on_link, n.on_obstacle] for n in shown.nearest]
            self._lines[end] = self._server.scene.add_line_segments(
                f"/distances {end.name.lower()}",
                np.array(segments, dtype=np.float32),
                _RED,
                thickness=0.006,
            )


class PopulationPanel:
    """Shows the populations of bases on the floor, cycle by cycle."""

    def __init__(self, server: ViserServer, found: Sequence[Search]) -> None:
        """Add the widgets."""
        self._server = server
        self._cycles: list[Cycle] = [c for search in found for c in search.cycles]
        self._clouds: list[PointCloudHandle] = []
        gui = server.gui
        with gui.add_folder("Populations over the cycles", expand_by_default=False):
            self._slider = gui.add_slider("shown", 0, max(1, len(self._cycles)), 1, 0)
            self._text = gui.add_markdown("not shown")
        self._slider.on_update(lambda _: self.update())

    def update(self) -> None:
        """Show what the slider says; nothing at 0."""
        for cloud in self._clouds:
            cloud.remove()
        self._clouds.clear()
        number = int(self._slider.value)
        if not 0 < number <= len(self._cycles):
            self._text.content = "not shown"
            return
        cycle = self._cycles[number - 1]
        text = "bases for the start blue, for the goal orange; the paler the worse"
        self._text.content = f"{cycle.label}: {text}"
        for end in End:
            self._add_cloud(cycle, end)

    def _add_cloud(self, cycle: Cycle, end: End) -> None:
        population = cycle.ends[end]
        share = population.scores / max(float(population.scores.max(initial=0.0)), 1e-9)
        pale = np.array([205.0, 205.0, 205.0])
        full = np.array(rgb(_COLOURS[end]), dtype=np.float64)
        colours = pale + share[:, None] * (full - pale)
        heights = np.full((len(share), 1), 0.015 + 0.01 * end)
        cloud = self._server.scene.add_point_cloud(
            f"/population {end.name.lower()}",
            np.hstack([population.positions, heights]).astype(np.float32),
            colours.astype(np.uint8),
            point_size=0.04,
            point_shape="circle",
        )
        self._clouds.append(cloud)


def _ghosts(exhibit: Exhibit, end: End, item: str) -> list[Part]:
    """The robot and the object in the colour of an end."""
    mine = [
        part
        for part in exhibit.parts
        if part.layer == ROBOT
        or (part.layer == SCENE and part.carrier == object_carrier(item))
    ]
    colour = translucent(_COLOURS[end])._replace(opacity=0.5)
    return [part.ghost(colour, part.carrier, part.name) for part in mine]


def _poses(exhibit: Exhibit, end: CandidateEnd, item: str) -> Mapping[str, Array]:
    robot = exhibit.problem.robot
    T_world_joint = joint_placements(robot.model, end.q[None])
    poses = {name: T[0] for name, T in joint_poses(robot, T_world_joint).items()}
    return {**poses, object_carrier(item): end.T_world_object}


def _tables(candidate: ShownCandidate) -> str:
    """The score by term and by link, at start and goal, as Markdown."""
    start, goal = (end.breakdown for end in candidate.ends)
    lines = ["| | start | goal |", "|---|---:|---:|"]
    lines += [
        f"| {name} | {value:.1f} | {goal.terms[name]:.1f} |"
        for name, value in start.terms.items()
    ]
    lines.append(f"| **score** | {start.total:.1f} | {goal.total:.1f} |")
    for name, end in (("start", start), ("goal", goal)):
        lines += ["", f"Clutter by link at the {name}:", ""]
        lines += ["| link | mm | points |", "|---|---:|---:|"]
        lines += [
            f"| {_escaped(k.link)} | {1000.0 * k.distance:.0f} | {k.points:.1f} |"
            for k in end.links
        ]
    return "\n".join(lines)


def _escaped(name: str) -> str:
    return name.replace("_", "\\_").replace("|", "\\|")
