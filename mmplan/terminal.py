"""What people see: tables of results on stdout, progress on a terminal's stderr."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

if TYPE_CHECKING:
    from mmplan.plan import Plan, TaskPlan
    from mmplan.verification_report import Peak, VerificationReport


_UNBOUND = 10_000  # columns, more than any table has


class ProgressDisplay:
    """A bar for each stage of `solve`, drawn only on a terminal."""

    def __init__(self, bars: Progress) -> None:
        """Draw into `bars`."""
        self._bars = bars
        self._tasks: dict[str, int] = {}

    def __call__(self, what: str, done: int, of: int | None) -> None:
        """Show how far a stage has come."""
        if what not in self._tasks:
            self._tasks[what] = self._bars.add_task(what, total=of)
        self._bars.update(self._tasks[what], completed=done, total=of)  # type: ignore[arg-type]


@contextmanager
def progress_display(*, quiet: bool) -> Iterator[ProgressDisplay | None]:
    """A progress display on stderr while the block runs, if that is a terminal."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed}/{task.total}"),
        TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True) as bars:
        yield ProgressDisplay(bars)


def show(*parts: Table | str) -> None:
    """Print results on stdout, without colours or a width where it is no terminal."""
    width = None if sys.stdout.isatty() else _UNBOUND
    console = Console(highlight=False, soft_wrap=True, width=width)
    for part in parts:
        console.print(part, markup=False) if isinstance(part, str) else console.print(
            part
        )


def plan_tables(plan: Plan, output: Path | None) -> list[Table | str]:
    """A plan in a few tables: choices, segments, proof."""
    parts: list[Table | str] = []
    for task in plan.tasks:
        parts += [
            f"{task.object}, grasp '{task.grasp}'",
            _ends(task),
            "",
            _segments(task),
            "",
        ]
    if plan.verification is not None:
        parts.append(verification_table(plan, plan.verification))
    if output is not None:
        parts.append(f"plan written to {output}")
    return parts


def verification_table(plan: Plan, report: VerificationReport) -> str:
    """The proof in a few lines."""
    text = f"verified: {plan.duration:.2f} s of motion, free of collision at all times"
    c = report.clearance
    if c is not None:
        text += (
            f"\nsmallest clearance {c.distance * 1000:.2f} mm: "
            f"{c.first} / {c.second}, {c.segment} at {c.time:.2f} s"
        )
    return "\n".join([text, *(_peak(plan, peak) for peak in report.peaks)])


def _peak(plan: Plan, peak: Peak) -> str:
    place = f"{peak.segment} at {peak.time:.2f} s"
    item = plan.tasks[peak.task].object
    if peak.rule == "torque":
        return f"largest torque for {item}: {peak.largest:.1%} of its limit, {place}"
    what, unit = {"tilt": ("tilt", "rad"), "tool_speed": ("speed of the tool", "m/s")}[
        peak.rule
    ]
    proven = "" if peak.proven is None else f", proven below {peak.proven:.4f}"
    return (
        f"largest {what} while {item} is carried: {peak.largest:.4f} {unit}{proven} "
        f"(at most {peak.limit:g} allowed), {place}"
    )


def _ends(task: TaskPlan) -> Table:
    joints = len(task.start.base)
    place = ", ".join(("base x", "y", "heading")[:joints])
    table = _table("", *[place][:joints], *task.start.scores, "score")
    for name, end in (("start", task.start), ("goal", task.goal)):
        base = [", ".join(f"{x:.3f}" for x in end.base)][:joints]
        terms = [f"{value:.1f}" for value in end.scores.values()]
        table.add_row(name, *base, *terms, f"{sum(end.scores.values()):.1f}")
    return table


def _segments(task: TaskPlan) -> Table:
    table = _table("", *(segment.name for segment in task.segments))
    table.add_row("seconds", *(f"{s.duration:.2f}" for s in task.segments))
    return table


def grid(
    headers: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1
) -> Table:
    """A table of texts, of which the first `left` columns are flush left."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for i, header in enumerate(headers):
        table.add_column(header, justify="left" if i < left else "right")
    for row in rows:
        table.add_row(*row)
    return table


def _table(first: str, *others: str) -> Table:
    """A table of numbers with a name in the first column."""
    table = Table(first, box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for header in others:
        table.add_column(header, justify="right")
    return table
