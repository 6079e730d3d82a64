"""Benchmarks of path planners on problems that others made."""
