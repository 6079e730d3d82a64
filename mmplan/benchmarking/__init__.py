"""Benchmarks of optimizers at equal budgets: runs, a durable store, honest statistics.

from mmplan.benchmarking import run_benchmark, write_report

run_benchmark(["wineglass", "plate"], "results", runs=200)
write_report("results")
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mmplan.benchmarking.records import Job, Record
from mmplan.benchmarking.store import Store

if TYPE_CHECKING:
    from mmplan.benchmarking.benchmark import run_benchmark
    from mmplan.benchmarking.report import write_report

__all__ = ["Job", "Record", "Store", "run_benchmark", "write_report"]


def __getattr__(name: str) -> Any:
    """Import what computes on first use; reading results needs none of it."""
    if name == "run_benchmark":
        from mmplan.benchmarking.benchmark import run_benchmark

        return run_benchmark
    if name == "write_report":
        from mmplan.benchmarking.report import write_report

        return write_report
    raise AttributeError(f"module 'mmplan.benchmarking' has no attribute '{name}'")
