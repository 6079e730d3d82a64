"""What computes the results: versions, and a hash of mmplan's own code."""

from __future__ import annotations

import hashlib
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_LIBRARIES = ("coal", "numpy", "ompl", "pin", "scipy", "toppra")
_OPTIONAL = ("cma", "nevergrad", "pymoo")  # what some optimizers are built on
# What asks for runs and shows them, and has no part in what comes of them.
_ASIDE = frozenset({"benchmarking", "cli.py", "commands", "schema.py", "terminal.py"})


@cache
def software() -> str:
    """All versions that decide what comes of a run, in one line.

    The hash of the code tells states of a checkout apart that go by one version.
    """
    versions = {name: version(name) for name in _LIBRARIES} | _installed(_OPTIONAL)
    libraries = ", ".join(f"{name} {number}" for name, number in versions.items())
    return f"mmplan {version('mmplan')} (code {_code()}), {libraries}"


def _installed(names: tuple[str, ...]) -> dict[str, str]:
    """The versions of those that are there."""
    found = {}
    for name in names:
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def _code() -> str:
    """The first digits of a hash of the package's source files."""
    package = Path(__file__).parents[1]
    total = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        place = path.relative_to(package)
        if place.parts[0] not in _ASIDE:
            total.update(f"{place}\0".encode())
            total.update(path.read_bytes())
    return total.hexdigest()[:12]
