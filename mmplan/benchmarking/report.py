"""The report of a benchmark: one page that opens anywhere, tables, pictures, logs."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from mmplan.atomic_file import write_whole
from mmplan.benchmarking.contests import Contest, contests
from mmplan.benchmarking.ompl_log import ompl_log
from mmplan.benchmarking.store import Store
from mmplan.exceptions import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mmplan.benchmarking.table import Table

PAGE, TABLES, FIGURES, LOGS = "report.html", "tables.md", "figures", "ompl"
_LIBRARIES = ("jinja2", "matplotlib", "scipy")
# A page with more pictures than those of so many problems serves nobody.
_MOST_PICTURED = 12
_DPI = 110


@dataclass(frozen=True)
class Report:
    """What was written where, and the tables for whoever wants to show them."""

    page: Path
    tables: tuple[Table, ...]
    figures: tuple[Path, ...]
    logs: tuple[Path, ...]


class _Picture(NamedTuple):
    title: str
    data: str  # PNG in base64


def write_report(folder: str | Path) -> Report:
    """Write the report of the results in a folder into that folder.

    Raises:
        InputError: There are no results, or a library that it takes is missing.
    """
    _require_libraries()
    from mmplan.benchmarking.tables import tables

    with Store(folder) as store:
        found = contests(store)
        if not found:
            raise InputError(f"{folder}: holds no runs yet")
        made = tables(found)
        pictures, paths, left_out = _pictures(found, Path(folder) / FIGURES)
        page = _page(store, found, made, pictures, left_out)
        logs = _logs(found, store.software(), Path(folder) / LOGS)
    write_whole(Path(folder) / PAGE, page)
    text = "\n".join(table.markdown() for table in made)
    write_whole(Path(folder) / TABLES, text)
    return Report(Path(folder) / PAGE, tuple(made), tuple(paths), tuple(logs))


def _require_libraries() -> None:
    missing = [name for name in _LIBRARIES if find_spec(name) is None]
    if missing:
        raise InputError(
            f"a report needs {', '.join(missing)}: pip install 'mmplan[benchmark]'"
        )


def _pictures(
    found: Sequence[Contest], folder: Path
) -> tuple[dict[str, list[_Picture]], list[Path], list[str]]:
    """The pictures by problem, the files they are in too, the problems without."""
    from mmplan.benchmarking.figures import figures

    folder.mkdir(exist_ok=True)
    pictures: dict[str, list[_Picture]] = {}
    paths: list[Path] = []
    left_out: list[str] = []
    for problem, group in groupby(found, key=lambda c: c.problem.name):
        if len(pictures) == _MOST_PICTURED:
            left_out.append(problem)
            continue
        pictures[problem] = []
        for title, figure in figures(list(group)).items():
            content = _png(figure)
            paths.append(folder / f"{problem}_{title.lower().replace(' ', '_')}.png")
            paths[-1].write_bytes(content)
            text = base64.b64encode(content).decode()
            pictures[problem].append(_Picture(title, text))
    return pictures, paths, left_out


def _png(figure: Figure) -> bytes:
    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=_DPI)
    return content.getvalue()


def _logs(found: Sequence[Contest], software: str, folder: Path) -> list[Path]:
    folder.mkdir(exist_ok=True)
    paths = []
    for contest in found:
        path = folder / f"{contest.problem.name}_{contest.evaluations}.log"
        write_whole(path, ompl_log(contest, software))
        paths.append(path)
    return paths


def _page(
    store: Store,
    found: Sequence[Contest],
    tables: Sequence[Table],
    pictures: dict[str, list[_Picture]],
    left_out: list[str],
) -> str:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("mmplan.benchmarking", ""),
        autoescape=True,
        undefined=StrictUndefined,
    )
    records = [r for c in found for runs in c.contenders.values() for r in runs]
    values: dict[str, Any] = {
        "problems": list(dict.fromkeys(c.problem.name for c in found)),
        "entries": store.problems(),
        "best": store.best(),
        "runs": len(records),
        "finished": max(r.finished for r in records),
        "hosts": sorted({r.host for r in records}),
        "software": store.software(),
        "tables": tables,
        "figures": pictures,
        "left_out": left_out,
    }
    return environment.get_template("report.html").render(values)
