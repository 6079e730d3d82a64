"""The store of a benchmark of optimizers. docs/benchmarks.md describes its tables."""

from __future__ import annotations

from mmplan.benchmarking.records import Job, Key, Record
from mmplan.benchmarking.run_store import Layout, ProblemEntry, RunStore

STORE_FILE = "results.sqlite"
FORMAT = 1

__all__ = ["FORMAT", "STORE_FILE", "ProblemEntry", "Store"]


class Store(RunStore[Job, Record]):
    """The results in one folder. A process opens a folder once at a time."""

    layout = Layout(
        file=STORE_FILE,
        format=FORMAT,
        record=Record,
        key=Key,
        json=frozenset(
            {"ends", "genes", "history", "outcomes", "plan", "seconds", "times"}
        ),
        numbers={
            "evaluations": "INTEGER",
            "seed": "INTEGER",
            "success": "INTEGER",
            "used": "INTEGER",
            "score": "REAL",
            "cycles": "REAL",
        },
        truths=frozenset({"success"}),
        views="""
CREATE VIEW IF NOT EXISTS best AS
    SELECT problem, max(score) AS score, optimizer, evaluations, seed
    FROM runs WHERE success GROUP BY problem;
""",
    )

    def best(self) -> dict[str, float]:
        """The best score ever found for each problem, by any optimizer and budget."""
        return dict(self._rows("SELECT problem, score FROM best"))
