"""What all stores of benchmarks share: a folder to whose SQLite file runs are added.

A run that is stored stays stored whatever ends the process, and a process that is
started again finds what is missing.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from mmplan.benchmarking.claims import Claims, RunKey
from mmplan.exceptions import InputError

_CLAIMS_FILE = "claims.lock"
_PATIENCE = 60.0  # s that a process waits for another to finish writing


class _Keyed(Protocol):
    """What is to be done, or what came of it."""

    @property
    def key(self) -> Any:
        """What tells this run from every other in the same store."""


JobT = TypeVar("JobT", bound=_Keyed)
RecordT = TypeVar("RecordT", bound=_Keyed)
StoreT = TypeVar("StoreT", bound="RunStore[Any, Any]")


@dataclass(frozen=True)
class ProblemEntry:
    """A problem of the benchmark; `floor_plan` is what its pictures need, if any."""

    name: str
    scene: str  # path of its file
    fingerprint: str
    floor_plan: dict[str, Any]


@dataclass(frozen=True)
class Layout(Generic[RecordT]):
    """How records stand in the file: a column for each field of theirs.

    Values of the columns `json` are kept as JSON text; `numbers` are SQL types of
    columns that are no text, `INTEGER` also of truth values (`truths`).
    """

    file: str
    format: int
    record: type[RecordT]
    key: type[Any]  # a named tuple of fields of the record
    json: frozenset[str]
    numbers: Mapping[str, str]
    truths: frozenset[str]
    views: str = ""

    @cached_property
    def columns(self) -> dict[str, str]:
        """SQL types by name."""
        names = [f.name for f in fields(self.record)]  # type: ignore[arg-type]
        return {name: self.numbers.get(name, "TEXT") for name in names}

    @property
    def key_names(self) -> str:
        """The columns of the key."""
        return ", ".join(self.key._fields)

    @property
    def schema(self) -> str:
        """What makes the tables."""
        columns = ", ".join(f"{name} {kind}" for name, kind in self.columns.items())
        return f"""
CREATE TABLE IF NOT EXISTS software (versions TEXT PRIMARY KEY);
CREATE TABLE IF NOT EXISTS problems (
    name TEXT PRIMARY KEY, scene TEXT, fingerprint TEXT, floor_plan TEXT
);
CREATE TABLE IF NOT EXISTS runs ({columns}, PRIMARY KEY ({self.key_names}));
{self.views}
PRAGMA user_version = {self.format};
"""

    def row(self, record: RecordT) -> list[Any]:
        """A record as values of the columns."""
        return [self._stored(name, getattr(record, name)) for name in self.columns]

    def read(self, row: tuple[Any, ...]) -> RecordT:
        """A record from values of the columns."""
        values = dict(zip(self.columns, row, strict=True))
        for name in self.json:
            values[name] = json.loads(values[name])
        for name in self.truths:
            values[name] = bool(values[name])
        return self.record(**values)

    def _stored(self, name: str, value: Any) -> Any:
        if name in self.json:
            return json.dumps(value)
        return int(value) if isinstance(value, bool) else value


class RunStore(Generic[JobT, RecordT]):
    """The results in one folder. A process opens a folder once at a time."""

    layout: Layout[RecordT]

    def __init__(self, folder: str | Path, *, create: bool = False) -> None:
        """Open the store of a folder; with `create`, make both where they are missing.

        Raises:
            InputError: There is no store, or what is there is none.
        """
        self.folder = Path(folder)
        self.path = self.folder / self.layout.file
        if not create and not self.path.is_file():
            raise InputError(f"{folder}: holds no results ({self.layout.file})")
        with self._refusing():
            self.folder.mkdir(parents=True, exist_ok=True)
            self._claims = Claims(self.folder / _CLAIMS_FILE)
        try:
            with self._refusing(), self._claims.setting_up():
                self._database = self._connect()
        except InputError:
            self._claims.close()
            raise

    def close(self) -> None:
        """Close the file and give up all claims."""
        self._database.close()
        self._claims.close()

    def __enter__(self: StoreT) -> StoreT:
        """Use the store for a block."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Close it."""
        self.close()

    def register(self, problem: ProblemEntry, software: str) -> None:
        """Say what the next runs are runs of.

        Raises:
            InputError: The store holds runs of another scene by that name, or of
                other software: they must not be mixed.
        """
        with self._transaction():
            self._refuse_other_software(software)
            self._refuse_other_scene(problem)
            self._database.execute(
                "INSERT OR IGNORE INTO software VALUES (?)", (software,)
            )
            self._database.execute(
                "INSERT OR IGNORE INTO problems VALUES (?, ?, ?, ?)",
                (
                    problem.name,
                    problem.scene,
                    problem.fingerprint,
                    json.dumps(problem.floor_plan),
                ),
            )

    def missing(self, jobs: Iterable[JobT]) -> list[JobT]:
        """Those of the jobs whose runs are not stored."""
        names = self.layout.key_names
        rows = self._rows(f"SELECT {names} FROM runs")
        stored = {self.layout.key(*row) for row in rows}
        return [job for job in jobs if job.key not in stored]

    def claim(self, job: JobT) -> bool:
        """Whether a run is to be done by this process: not stored, nor being done."""
        if not self._claims.take(job.key):
            return False
        if self._has(job.key):  # stored since this process has looked
            self._claims.release(job.key)
            return False
        return True

    def add(self, record: RecordT) -> None:
        """Store a run for good; a run that is stored already stays as it is."""
        values = self.layout.row(record)
        marks = ", ".join("?" * len(values))
        with self._transaction():
            self._database.execute(
                f"INSERT OR IGNORE INTO runs VALUES ({marks})", values
            )
        self._claims.release(record.key)

    def records(self) -> list[RecordT]:
        """All runs, sorted by what they are runs of."""
        names, key = ", ".join(self.layout.columns), self.layout.key_names
        rows = self._rows(f"SELECT {names} FROM runs ORDER BY {key}")
        return [self.layout.read(row) for row in rows]

    def problems(self) -> list[ProblemEntry]:
        """The problems, in the order in which they came."""
        rows = self._rows("SELECT * FROM problems ORDER BY rowid")
        return [ProblemEntry(n, s, f, json.loads(plan)) for n, s, f, plan in rows]

    def software(self) -> str:
        """The versions that the runs were made with; empty before the first run."""
        rows = self._rows("SELECT versions FROM software")
        return str(rows[0][0]) if rows else ""

    def _connect(self) -> sqlite3.Connection:
        database = sqlite3.connect(self.path, timeout=_PATIENCE, isolation_level=None)
        try:
            (found,) = database.execute("PRAGMA user_version").fetchone()
            if found not in (0, self.layout.format):
                raise InputError(
                    f"{self.path}: has format {found}; this mmplan reads "
                    f"{self.layout.format}"
                )
            database.execute("PRAGMA journal_mode = WAL")
            database.execute("PRAGMA synchronous = FULL")
            if found == 0:
                database.executescript(f"BEGIN IMMEDIATE; {self.layout.schema} COMMIT;")
        except BaseException:
            database.close()
            raise
        return database

    @contextmanager
    def _refusing(self) -> Iterator[None]:
        """Turn what the system says of the folder or file into an error for people."""
        try:
            yield
        except OSError as error:
            raise InputError(f"{self.folder}: {error.strerror}") from None
        except sqlite3.DatabaseError as error:
            raise InputError(f"{self.path}: {error}") from None

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._database.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            self._database.execute("ROLLBACK")
            raise
        self._database.execute("COMMIT")

    def _rows(self, query: str, values: Iterable[Any] = ()) -> list[tuple[Any, ...]]:
        return self._database.execute(query, tuple(values)).fetchall()

    def _has(self, key: RunKey) -> bool:
        condition = " AND ".join(f"{name} = ?" for name in key._fields)
        return bool(self._rows(f"SELECT 1 FROM runs WHERE {condition}", key))

    def _refuse_other_software(self, software: str) -> None:
        known = self.software()
        if known not in ("", software):
            raise InputError(
                f"{self.folder}: holds runs of other software, which are not mixed "
                f"with new ones; give another folder\n  there: {known}\n"
                f"  here:  {software}"
            )

    def _refuse_other_scene(self, problem: ProblemEntry) -> None:
        query = "SELECT scene, fingerprint FROM problems WHERE name = ?"
        for scene, fingerprint in self._rows(query, (problem.name,)):
            if fingerprint != problem.fingerprint:
                raise InputError(
                    f"{problem.scene}: {self.folder} holds runs of another scene named "
                    f"'{problem.name}', or of this one before it was changed ({scene}, "
                    f"fingerprint {fingerprint[:12]}; now "
                    f"{problem.fingerprint[:12]}); give another folder"
                )
