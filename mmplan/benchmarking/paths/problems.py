"""Path-planning problems in a file: configurations among simple shapes.

The format is that in which VAMP passes on MotionBenchMaker's problems: JSON, packed by
gzip or not, with lists of problems by family.
"""

from __future__ import annotations

import gzip
import hashlib
import json
import zlib
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from mmplan.exceptions import Diagnostic, InputError
from mmplan.files.document import Document, Fault, Value, dotted
from mmplan.files.faults import validate
from mmplan.files.section import Metres, Section, Size, fault, fault_at
from mmplan.files.yaml_reader import LARGEST_FILE, parse_document
from mmplan.problem import Obstacle
from mmplan.shapes import Array, Box, Cylinder, Shape, Sphere, read_only

# The sizes that shapes have, in their order; boxes have full edge lengths.
_SIZES = {
    "box": ("x", "y", "z"),
    "cylinder": ("length", "radius"),
    "sphere": ("radius",),
}
_SUFFIXES = (".json", ".json.gz")


@dataclass(frozen=True, eq=False)
class PathProblem:
    """A start and a goal of the joints of base and arm, and what is in the way."""

    family: str
    number: int
    q_start: Array  # (joints,)
    q_goal: Array
    obstacles: tuple[Obstacle, ...]


@dataclass(frozen=True, eq=False)
class PathProblems:
    """The problems of a file, family by family."""

    name: str
    path: Path
    fingerprint: str  # SHA-256 of the content, unpacked
    problems: tuple[PathProblem, ...]

    @property
    def families(self) -> tuple[str, ...]:
        """The names of the families, in their order."""
        return tuple(dict.fromkeys(problem.family for problem in self.problems))


def _pose(rows: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    T = np.array(rows)
    turned = np.allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-6)
    if not turned or np.linalg.det(T) < 0 or T[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
        raise fault("not a pose: rotation and translation over a row 0 0 0 1")
    return rows


_Row: TypeAlias = tuple[Metres, Metres, Metres, Metres]
_Pose: TypeAlias = Annotated[tuple[_Row, _Row, _Row, _Row], AfterValidator(_pose)]


class ThingSection(Section):
    """A thing in the way."""

    name: str
    type: Literal["box", "cylinder", "sphere"]
    dims: tuple[Size, ...]
    pose: _Pose

    @model_validator(mode="after")
    def _dims_fit(self) -> ThingSection:
        sizes = _SIZES[self.type]
        if len(self.dims) != len(sizes):
            wanted = f"a {self.type} has [{', '.join(sizes)}]"
            raise fault_at(("dims",), f"{wanted}; got {len(self.dims)} numbers")
        return self


class ProblemSection(Section):
    """One problem."""

    index: int
    family: str
    start: Annotated[tuple[float, ...], Field(min_length=1)]
    goal: tuple[float, ...]
    objects: tuple[ThingSection, ...]

    @model_validator(mode="after")
    def _ends_fit(self) -> ProblemSection:
        if len(self.start) != len(self.goal):
            message = f"{len(self.goal)} joints; the start has {len(self.start)}"
            raise fault_at(("goal",), message)
        return self


class _FileSection(Section):
    families: dict[str, tuple[ProblemSection, ...]]


def load_path_problems(path: Path) -> PathProblems:
    """Read a file of problems; of one that is packed, `.gz` may be left away.

    Raises:
        InputError: It cannot be read, or is faulty, with the place of every fault.
    """
    packed = path.with_name(f"{path.name}.gz")
    if packed.exists() and not path.exists():
        path = packed
    content = _content(path)
    section = _validated(path, content)
    problems = [
        _problem(family, problem)
        for family, problems in section.families.items()
        for problem in problems
    ]
    _require_distinct(path, problems)
    suffix = next(s for s in reversed(_SUFFIXES) if path.name.endswith(s))
    name = path.name.removesuffix(suffix)
    digest = hashlib.sha256(content).hexdigest()
    return PathProblems(name, path, digest, tuple(problems))


def _content(path: Path) -> bytes:
    """What the file holds, unpacked."""

    def refuse(message: str) -> InputError:
        return InputError(Diagnostic(message, file=str(path)))

    if not path.name.endswith(_SUFFIXES):
        raise refuse(f"problems are read from {' and '.join(_SUFFIXES)} files")
    try:
        content = path.read_bytes()
        return gzip.decompress(content) if path.suffix == ".gz" else content
    except FileNotFoundError:
        raise refuse("no such file") from None
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise refuse(f"is not packed by gzip, or damaged: {error}") from None
    except OSError as error:
        raise refuse(f"cannot be read: {error.strerror}") from None


def _validated(path: Path, content: bytes) -> _FileSection:
    """The content as a section; places are sought once there are faults.

    Knowing where each value stands takes many times longer than reading them.
    """
    try:
        data = _frozen(json.loads(content))
    except json.JSONDecodeError as error:
        place = str(path), error.lineno, error.colno
        raise InputError(Diagnostic(f"not JSON: {error.msg}", *place)) from None
    except (UnicodeDecodeError, RecursionError) as error:
        message = f"not JSON: {error}"
        raise InputError(Diagnostic(message, file=str(path))) from None
    if not isinstance(data, dict) or not data:
        message = "expected families of problems: keys with lists"
        raise InputError(Diagnostic(message, file=str(path)))
    document = Document(path, content, (), {"families": data}, {}, {})
    section, faults = validate(_FileSection, document)
    if section is None:
        raise _located(path, content, faults)
    return section


def _located(path: Path, content: bytes, faults: tuple[Fault, ...]) -> InputError:
    """An error of all faults, with their places in the file where it is not huge."""
    faults = tuple(f._replace(path=f.path[1:]) for f in faults)
    with suppress(InputError):  # what YAML cannot hold
        if len(content) <= LARGEST_FILE:
            return parse_document(path, content).error(faults)
    messages = [f"{dotted(f.path)}: {f.message}" for f in faults]
    return InputError(*(Diagnostic(m, file=str(path)) for m in messages))


def _frozen(data: Any) -> Value:
    """JSON data with tuples for lists, as in a document."""
    if isinstance(data, list):
        return tuple(_frozen(item) for item in data)
    if isinstance(data, dict):
        return {key: _frozen(item) for key, item in data.items()}
    value: Value = data
    return value


def _require_distinct(path: Path, problems: list[PathProblem]) -> None:
    seen: set[tuple[str, int]] = set()
    for problem in problems:
        key = (problem.family, problem.number)
        if key in seen:
            message = f"{problem.family}: two problems have the index {problem.number}"
            raise InputError(Diagnostic(message, file=str(path)))
        seen.add(key)


def _problem(family: str, section: ProblemSection) -> PathProblem:
    """The problem of a section; each obstacle has a name of its own."""
    return PathProblem(
        family=family,
        number=section.index,
        q_start=read_only(section.start),
        q_goal=read_only(section.goal),
        obstacles=tuple(
            Obstacle(f"{thing.name} ({i})", _shape(thing), read_only(thing.pose))
            for i, thing in enumerate(section.objects)
        ),
    )


def _shape(thing: ThingSection) -> Shape:
    if thing.type == "box":
        x, y, z = thing.dims
        return Box((x, y, z))
    if thing.type == "cylinder":
        length, radius = thing.dims
        return Cylinder(radius, length)
    return Sphere(thing.dims[0])
