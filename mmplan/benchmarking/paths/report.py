"""The report of a benchmark of path planners: tables and logs in OMPL's format."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mmplan.atomic_file import write_whole
from mmplan.benchmarking.ompl_format import EXACT, TIMEOUT, Column, Experiment, Planner
from mmplan.benchmarking.paths.records import STORE_FILE, PathRecord, PathStore
from mmplan.benchmarking.paths.tables import contender_labels, path_tables
from mmplan.benchmarking.run_store import ProblemEntry
from mmplan.benchmarking.table import Table
from mmplan.exceptions import InputError

TABLES, LOGS = "paths.md", "ompl"


@dataclass(frozen=True)
class PathReport:
    """What was written where, and the tables for whoever wants to show them."""

    page: Path
    tables: tuple[Table, ...]
    logs: tuple[Path, ...]


def holds_paths(folder: str | Path) -> bool:
    """Whether the results in a folder are those of path planners."""
    return (Path(folder) / STORE_FILE).is_file()


def write_path_report(folder: str | Path) -> PathReport:
    """Write tables and logs of the results in a folder into that folder.

    Raises:
        InputError: There are no results.
    """
    tables: list[Table] = []
    logs: list[Path] = []
    with PathStore(folder) as store:
        records, software = store.records(), store.software()
        if not records:
            raise InputError(f"{folder}: holds no runs yet")
        (Path(folder) / LOGS).mkdir(exist_ok=True)
        for entry in store.problems():
            runs = [r for r in records if r.problems == entry.name]
            tables += path_tables(runs)
            logs += _logs(Path(folder) / LOGS, entry, runs, software)
    page = Path(folder) / TABLES
    write_whole(page, "\n".join(table.markdown() for table in tables))
    return PathReport(page, tuple(tables), tuple(logs))


def _logs(
    folder: Path, entry: ProblemEntry, records: Sequence[PathRecord], software: str
) -> list[Path]:
    """A log for each family: its problems are the runs of one experiment."""
    paths = []
    for family in dict.fromkeys(r.family for r in records):
        runs = [r for r in records if r.family == family]
        paths.append(folder / f"{entry.name}_{family}.log")
        write_whole(paths[-1], _experiment(entry, family, runs, software).log())
    return paths


def _experiment(
    entry: ProblemEntry, family: str, records: Sequence[PathRecord], software: str
) -> Experiment[PathRecord]:
    planners = contender_labels(dict.fromkeys((r.planner, r.settings) for r in records))
    return Experiment(
        name=f"{entry.name}_{family}",
        properties=(),
        hosts=[r.host for r in records],
        finished=min(r.finished for r in records),
        setup=(f"problems {entry.scene}", f"fingerprint {entry.fingerprint}", software),
        seed=min(r.seed for r in records),
        time_limit=max(_seconds(r) for r in records),
        seconds=sum(_seconds(r) for r in records),
        planners=[
            Planner(
                label=label,
                common={"settings": settings},
                columns=_COLUMNS,
                runs=[
                    r for r in records if (r.planner, r.settings) == (name, settings)
                ],
            )
            for (name, settings), label in planners.items()
        ],
    )


def _seconds(record: PathRecord) -> float:
    return record.first_seconds if record.seconds is None else record.seconds


def _column(name: str, kind: str, field: str) -> Column[PathRecord]:
    return Column(name, kind, lambda r: getattr(r, field))


_COLUMNS: tuple[Column[PathRecord], ...] = (
    _column("solved", "BOOLEAN", "solved"),
    Column("status", "ENUM", lambda r: EXACT if r.solved else TIMEOUT),
    Column("time", "REAL", _seconds),
    _column("time to first path", "REAL", "first_seconds"),
    _column("time to prepare", "REAL", "setup_seconds"),
    _column("valid", "BOOLEAN", "valid"),
    _column("first path valid", "BOOLEAN", "valid_first"),
    _column("first path collides", "BOOLEAN", "collides"),
    _column("first path length", "REAL", "first_length"),
    _column("solution length", "REAL", "length"),
    _column("first path way", "REAL", "first_way"),
    _column("solution way", "REAL", "way"),
    _column("clearance", "REAL", "clearance"),
    _column("states", "INTEGER", "states"),
    _column("edges", "INTEGER", "edges"),
    _column("problem", "INTEGER", "number"),
    _column("seed", "INTEGER", "seed"),
)
