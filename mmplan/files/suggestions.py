"""Words for what was allowed, and guesses at what was meant."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

MOST_LISTED = 20


def listed(names: Iterable[str]) -> str:
    """The names in one line: `a, b, c`; `none` where there are none."""
    every = list(names)
    shown = ", ".join(every[:MOST_LISTED]) or "none"
    more = len(every) - MOST_LISTED
    return f"{shown} and {more} more" if more > 0 else shown


def suggestion(name: str, allowed: Iterable[str]) -> str:
    """`; did you mean 'x'?` where a name is close to one allowed, else nothing."""
    by_lower_case = {a.lower(): a for a in allowed}
    close = get_close_matches(name.lower(), by_lower_case, n=1, cutoff=0.6)
    return f"; did you mean '{by_lower_case[close[0]]}'?" if close else ""


def unknown(kind: str, name: str, allowed: Iterable[str]) -> str:
    """The message for a name that is none of those allowed."""
    names = sorted(allowed)
    guess = suggestion(name, names) or ";"
    return f"unknown {kind} '{name}'{guess} known: {listed(names)}"
