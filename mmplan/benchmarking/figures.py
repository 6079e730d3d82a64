"""The pictures of a report, by matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from scipy.spatial import ConvexHull

from mmplan.benchmarking.contests import Contest
from mmplan.benchmarking.records import STAGES, Record
from mmplan.benchmarking.statistics import best_so_far
from mmplan.benchmarking.tables import mean_seconds, stages_of

_SIZE = (5.2, 3.9)  # of one panel, inches
_WIDTH_EACH = 1.2  # of a panel for each contender, at least
_PLANS_A_ROW = 3
_MARGIN = 0.4  # around what a floor plan must show, m
# What hangs higher than this does not stand in the base's way, m.
_OVERHEAD = 1.0
_ENDS = {"start": ("o", "#0072b2"), "goal": ("^", "#d55e00")}


def figures(contests: Sequence[Contest]) -> dict[str, Figure]:
    """The pictures of one problem by title, a panel for each budget or contender."""
    largest = contests[-1]
    return {
        "Scores": _panels(contests, _scores, share_y=True),
        "Best score so far": _panels(contests, _curves, share_y=True),
        "Time by stage": _panels(contests, _times),
        "Chosen bases": _bases(largest),
    }


def _panels(
    contests: Sequence[Contest],
    draw: Callable[[Axes, Contest], None],
    *,
    share_y: bool = False,
) -> Figure:
    """One panel for each budget."""
    n, (width, height) = len(contests), _SIZE
    width = max(width, _WIDTH_EACH * max(len(c.contenders) for c in contests))
    figure = Figure(figsize=(width * n, height), layout="constrained")
    axes = figure.subplots(1, n, squeeze=False, sharey=share_y)[0]
    for panel, contest in zip(axes, contests, strict=True):
        draw(panel, contest)
        panel.set_title(contest.name, fontsize=10)
    return figure


def _colours(labels: Sequence[str]) -> dict[str, Any]:
    return {label: colormaps["tab10"](i % 10) for i, label in enumerate(labels)}


def _scores(panel: Axes, contest: Contest) -> None:
    """Every run a dot, boxes over the successful ones; failures are at 0."""
    rng = np.random.default_rng(0)
    colours = _colours(list(contest.contenders))
    for place, (label, colour) in enumerate(colours.items()):
        scores = np.array(list(contest.normalized(label).values()))
        found = scores[scores > 0.0]
        if len(found):
            panel.boxplot(
                found, positions=[place], widths=0.5, showfliers=False, zorder=3
            )
        x = place + rng.uniform(-0.18, 0.18, len(scores))
        panel.scatter(x, scores, s=9, alpha=0.5, color=colour, linewidths=0)
    panel.set_xticks(range(len(colours)), _wrapped(colours), fontsize=8)
    panel.set_ylabel("score (100: best ever found)")
    panel.grid(axis="y", alpha=0.3)


def _curves(panel: Axes, contest: Contest) -> None:
    share = 100.0 / contest.best if contest.best > 0.0 else 0.0
    colours = _colours(list(contest.contenders))
    for label, colour in colours.items():
        curve = best_so_far(contest.contenders[label], share)
        panel.plot(curve.evaluations, curve.mean, color=colour, label=label)
        panel.fill_between(
            curve.evaluations,
            curve.low,
            curve.high,
            color=colour,
            alpha=0.25,
            linewidth=0,
        )
    panel.set_xlim(0, contest.evaluations)
    panel.set_xlabel("score evaluations")
    panel.set_ylabel("mean best score so far, 95 % band")
    panel.legend(fontsize=8, loc="lower right")
    panel.grid(alpha=0.3)


def _times(panel: Axes, contest: Contest) -> None:
    stages = stages_of([r for runs in contest.contenders.values() for r in runs])
    labels = list(contest.contenders)
    left = np.zeros(len(labels))
    for stage in stages:
        width = np.array(
            [mean_seconds(contest.contenders[label], stage) for label in labels]
        )
        colour = colormaps["Set2"](STAGES.index(stage))
        panel.barh(range(len(labels)), width, left=left, color=colour, label=stage)
        left += width
    panel.set_yticks(range(len(labels)), _wrapped(labels), fontsize=8)
    panel.invert_yaxis()
    panel.set_xlabel("CPU seconds a run, mean")
    panel.set_ylim(len(labels) + 0.3, -0.6)
    panel.legend(fontsize=7, ncols=3, loc="lower right")


def _bases(contest: Contest) -> Figure:
    """One floor plan for each contender, with the bases of all successful runs."""
    n = len(contest.contenders)
    columns = min(n, _PLANS_A_ROW)
    rows = -(-n // columns)
    low, high = _view(contest)
    width, height = high - low
    size = (4.6 * columns, rows * (0.9 + 4.6 * height / width))
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flat
    for panel in axes[n:]:
        panel.remove()
    for panel, (label, runs) in zip(axes, contest.contenders.items(), strict=False):
        _floor(panel, contest.problem.floor_plan)
        _scatter_bases(panel, runs)
        panel.set_title(f"{label}, {contest.evaluations} evaluations", fontsize=10)
        panel.set_aspect("equal")
        panel.set_xlim(low[0], high[0])
        panel.set_ylim(low[1], high[1])
        panel.set_xlabel("x, m")
    axes[0].set_ylabel("y, m")
    axes[0].legend(fontsize=8, loc="lower left")
    return figure


def _floor(panel: Axes, plan: dict[str, Any]) -> None:
    """The footprints of what stands on the floor; dashed what hangs above the base."""
    for body in plan["bodies"]:
        if body["kind"] == "ground":
            continue
        corners = np.array(body["corners"])
        outline = corners[ConvexHull(corners).vertices]
        overhead = body["heights"][0] > _OVERHEAD
        panel.add_patch(
            Polygon(
                outline,
                facecolor="none" if overhead else "#dddddd",
                edgecolor="#777777",
                linestyle="--" if overhead else "-",
                linewidth=0.7,
            )
        )
    for end, (_, colour) in _ENDS.items():
        x, y = plan[end]
        name = f"object at {end}"
        panel.scatter(x, y, s=150, marker="*", color=colour, ec="black", label=name)


def _scatter_bases(panel: Axes, runs: Sequence[Record]) -> None:
    found = [r for r in runs if r.success]
    for end, (marker, colour) in _ENDS.items():
        places = np.array([r.ends[end]["base"][:2] for r in found]).reshape(-1, 2)
        panel.scatter(
            places[:, 0],
            places[:, 1],
            s=22,
            marker=marker,
            color=colour,
            alpha=0.6,
            linewidths=0,
            label=f"base at {end}",
            zorder=3,
        )


def _view(contest: Contest) -> tuple[Any, Any]:
    """The lower and the upper corner of what is shown: bases and object poses."""
    plan = contest.problem.floor_plan
    points = [plan["start"], plan["goal"]]
    for runs in contest.contenders.values():
        points += [end["base"][:2] for r in runs for end in r.ends.values()]
    places = np.array(points)
    margin = plan["radius"] + _MARGIN
    return places.min(axis=0) - margin, places.max(axis=0) + margin


def _wrapped(labels: Sequence[str] | dict[str, Any]) -> list[str]:
    return [label.replace("+", "+\n") for label in labels]
