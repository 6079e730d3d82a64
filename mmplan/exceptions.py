"""The errors of mmplan: one tree, one class for each exit code of the command line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mmplan.failure import FailureReport


class MmplanError(Exception):
    """Base of every error that mmplan raises on purpose."""


@dataclass(frozen=True)
class Diagnostic:
    """One fault in an input file: where it is, what it is and what was allowed.

    `line` and `column` count from 1; both are None where the fault belongs to the
    file as a whole. `source` is the offending line as it stands in the file.
    """

    message: str
    file: str | None = None
    line: int | None = None
    column: int | None = None
    source: str | None = None

    def __str__(self) -> str:
        """`file:line:column: message`, then the line with a caret below the place."""
        place = [str(p) for p in (self.file, self.line, self.column) if p is not None]
        text = ": ".join([*([":".join(place)] if place else []), self.message])
        if self.source is None:
            return text
        caret = f"\n    {' ' * (self.column - 1)}^" if self.column else ""
        return f"{text}\n    {self.source}{caret}"


class InputError(MmplanError):
    """Input that cannot be used; carries every fault found (exit code 2)."""

    def __init__(self, *diagnostics: Diagnostic | str) -> None:
        """Collect the faults; a plain string is a fault without a place."""
        self.diagnostics = tuple(
            Diagnostic(d) if isinstance(d, str) else d for d in diagnostics
        )
        super().__init__("\n".join(str(d) for d in self.diagnostics))


class NoPlanError(MmplanError):
    """The problem has no solution that mmplan could find (exit code 1)."""

    def __init__(self, message: str, report: FailureReport | None = None) -> None:
        """Keep the account of what every candidate failed at beside the message."""
        self.report = report
        super().__init__(message)


class VerificationError(MmplanError):
    """A plan that does not hold what it promises (exit code 1)."""

    def __init__(self, faults: tuple[str, ...]) -> None:
        """Keep the single faults, worst first, beside the message."""
        self.faults = faults
        super().__init__("; ".join(faults))
