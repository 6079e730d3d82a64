"""A table of a report, for a terminal and as Markdown."""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import fill

import numpy as np

from mmplan.benchmarking.statistics import Proportion

_WORDS = frozenset({"problem", "family", "contender", "contenders"})


@dataclass(frozen=True)
class Table:
    """A table with a title and what must be said about it.

    A detailed one has rows for each of so many problems that only files show it.
    """

    title: str
    note: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    detailed: bool = False

    def is_text(self, column: int) -> bool:
        """Whether a column holds words rather than numbers."""
        return self.header[column] in _WORDS

    def text(self) -> str:
        """The table for a terminal, as wide as it is."""
        widths = [max(map(len, c)) for c in zip(self.header, *self.rows, strict=True)]
        lines = [
            "  ".join(
                cell.ljust(width) if self.is_text(i) else cell.rjust(width)
                for i, (cell, width) in enumerate(zip(row, widths, strict=True))
            )
            for row in (self.header, *self.rows)
        ]
        return "\n".join([self.title, "", *lines, "", fill(self.note), ""])

    def markdown(self) -> str:
        """The table as Markdown."""
        lines = [self.header, ("---",) * len(self.header), *self.rows]
        table = "\n".join(f"| {' | '.join(line)} |" for line in lines)
        return f"### {self.title}\n\n{table}\n\n{self.note}\n"


def rate(p: Proportion) -> str:
    """A share with its interval, in percent."""
    return f"{100 * p.share:.1f} % ({100 * p.low:.1f} to {100 * p.high:.1f})"


def number(value: float) -> str:
    """A number; nothing where there is none."""
    return "" if np.isnan(value) else f"{value:.2f}"
