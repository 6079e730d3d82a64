"""Faults of a robot.yaml that only show against its URDF, by key path."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mmplan.files.document import Document, Fault, KeyPath
from mmplan.files.suggestions import unknown
from mmplan.files.urdf import Urdf

GROUPS = ("base", "arm", "hand")


def robot_faults(document: Document, urdf: Urdf) -> Iterator[Fault]:
    """Unknown joints and links, and positions too few, too many or out of limits.

    Works on the document, so that one malformed section hides no fault of another.
    """
    for group in GROUPS:
        yield from _unknown_joints(document, (group, "joints"), urdf)
    yield from _unknown_accelerations(document, urdf)
    yield from _unknown_links(document, urdf)
    yield from position_faults(document, ("hand", "open"), "hand", urdf)
    yield from position_faults(document, ("hand", "closed"), "hand", urdf)
    for name in document.keys("configurations"):
        yield from position_faults(document, ("configurations", name), "arm", urdf)


def _unknown_joints(document: Document, path: KeyPath, urdf: Urdf) -> Iterator[Fault]:
    for i, name in enumerate(_texts(document, path)):
        if name not in urdf.joints:
            yield Fault((*path, i), unknown("joint", name, urdf.joints))


def _unknown_accelerations(document: Document, urdf: Urdf) -> Iterator[Fault]:
    given = document.keys("acceleration")
    for name in given:
        if name not in urdf.joints:
            path = ("acceleration", name)
            yield Fault(path, unknown("joint", name, urdf.joints), at_key=True)
    used = [n for g in GROUPS for n in _texts(document, (g, "joints"))]
    missing = [n for n in used if n in urdf.joints and n not in given]
    if given and missing:
        message = f"no limit for joint '{missing[0]}'"
        yield Fault(("acceleration",), message, at_key=True)


def _unknown_links(document: Document, urdf: Urdf) -> Iterator[Fault]:
    tool = document.get("tool")
    if isinstance(tool, str) and tool not in urdf.links:
        yield Fault(("tool",), unknown("link", tool, urdf.links))
    pairs = document.get("disabled_pairs")
    for i in range(len(pairs) if isinstance(pairs, tuple) else 0):
        for k, link in enumerate(_texts(document, ("disabled_pairs", i))[:2]):
            if link not in urdf.links:
                message = unknown("link", link, urdf.links)
                yield Fault(("disabled_pairs", i, k), message)


def position_faults(
    document: Document, path: KeyPath, group: str, urdf: Urdf
) -> Iterator[Fault]:
    """Faults of the positions at `path` of a group of joints of a robot.yaml."""
    joints = _texts(document, (group, "joints"))
    values = document.get(*path)
    if isinstance(values, tuple) and joints:
        for fault in joint_value_faults(values, joints, urdf):
            yield fault._replace(path=path + fault.path)


def joint_value_faults(
    values: tuple[object, ...], joints: Sequence[str], urdf: Urdf
) -> Iterator[Fault]:
    """Faults of one position (rad or m) a joint, at paths from the list of values."""
    if len(values) != len(joints):
        message = f"expected {len(joints)} numbers, one for each of "
        yield Fault((), f"{message}{', '.join(joints)}; got {len(values)}")
        return
    for i, (value, name) in enumerate(zip(values, joints, strict=True)):
        joint = urdf.joints.get(name)
        if joint is None or isinstance(value, bool):
            continue
        if isinstance(value, int | float) and not joint.lower <= value <= joint.upper:
            limits = f"{joint.lower:g} to {joint.upper:g}"
            yield Fault((i,), f"{value:g} is outside the limits of '{name}', {limits}")


def _texts(document: Document, path: KeyPath) -> list[str]:
    """The texts in the list at `path`; none where it is not a list."""
    value = document.get(*path)
    items = value if isinstance(value, tuple) else ()
    return [item for item in items if isinstance(item, str)]
