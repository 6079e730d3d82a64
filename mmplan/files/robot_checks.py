"""Faults of a robot.yaml that only show against its URDFs, by key path."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from mmplan.files.document import Document, Fault, KeyPath
from mmplan.files.suggestions import unknown
from mmplan.files.urdf import Urdf, UrdfJoint
from mmplan.files.urdf_composition import BASE_JOINTS

GROUPS = ("base", "arm", "hand")


def joined_facts(document: Document, parts: Sequence[Urdf]) -> Urdf:
    """All joints and links that a robot.yaml may name, with the limits that it sets.

    They are those of its URDFs and the joints of a base that is added.
    """
    joints = {name: joint for urdf in parts for name, joint in urdf.joints.items()}
    for name in _added_joints(document):
        joints[name] = UrdfJoint(name, -math.inf, math.inf)
    for name in document.keys("position"):
        lower, upper = _numbers(document, ("position", name)) or (0.0, 0.0)
        if name in joints and lower < upper:
            joints[name] = replace(joints[name], lower=lower, upper=upper)
    links = dict.fromkeys(link for urdf in parts for link in urdf.links)
    bodies = [link for urdf in parts for link in urdf.bodies]
    return Urdf(joints, tuple(links), tuple(bodies), {})


def robot_faults(document: Document, urdf: Urdf) -> Iterator[Fault]:
    """Unknown joints and links, and positions too few, too many or out of limits.

    Works on the document, so that one malformed section hides no fault of another.
    """
    for group in GROUPS:
        yield from _unknown_joints(document, (group, "joints"), urdf)
    yield from _follower_faults(document, urdf)
    for limits in ("parked", "position", "velocity", "acceleration"):
        yield from _unknown_keys(document, limits, "joint", urdf.joints)
    yield from _unknown_keys(document, "collision", "link", urdf.links)
    yield from _missing_limits(document, urdf)
    yield from _unknown_links(document, urdf)
    yield from position_faults(document, ("hand", "open"), "hand", urdf)
    yield from position_faults(document, ("hand", "closed"), "hand", urdf)
    for name in document.keys("configurations"):
        yield from position_faults(document, ("configurations", name), "arm", urdf)
    yield from _parked_faults(document, urdf)


def grouped_joints(document: Document) -> list[str]:
    """The joints of the three groups; those of the base also where they are added."""
    given = (_texts(document, (group, "joints")) for group in GROUPS)
    return [*_added_joints(document), *(name for names in given for name in names)]


def _added_joints(document: Document) -> tuple[str, ...]:
    """The joints of a base that is added; all there can be where its type is none."""
    if document.get("base", "joints"):
        return ()
    return BASE_JOINTS.get(str(document.get("base", "type")), BASE_JOINTS["planar"])


def _unknown_joints(document: Document, path: KeyPath, urdf: Urdf) -> Iterator[Fault]:
    for i, name in enumerate(_texts(document, path)):
        if name not in urdf.joints:
            yield Fault((*path, i), unknown("joint", name, urdf.joints))


def _follower_faults(document: Document, urdf: Urdf) -> Iterator[Fault]:
    """Joints that mimic others are in no group: they follow by themselves."""
    for group in GROUPS:
        for i, name in enumerate(_texts(document, (group, "joints"))):
            joint = urdf.joints.get(name)
            if joint is not None and joint.mimic is not None:
                message = f"'{name}' mimics '{joint.mimic.leader}'; name only that"
                yield Fault((group, "joints", i), message)
    leaders = {
        *_texts(document, ("base", "joints")),
        *_texts(document, ("arm", "joints")),
    }
    for joint in urdf.joints.values():
        if joint.mimic is not None and joint.mimic.leader in leaders:
            message = f"'{joint.name}' mimics '{joint.mimic.leader}' of base or arm"
            yield Fault(
                ("urdf",), f"{message}; only joints of the hand may be mimicked"
            )


def _unknown_keys(
    document: Document, section: str, kind: str, known: Collection[str]
) -> Iterator[Fault]:
    for name in document.keys(section):
        if name not in known:
            yield Fault((section, name), unknown(kind, name, known), at_key=True)


def _missing_limits(document: Document, urdf: Urdf) -> Iterator[Fault]:
    """Joints without an acceleration limit, added ones without one of velocity."""
    used = [name for name in grouped_joints(document) if name in urdf.joints]
    yield from _first_missing(document, "acceleration", used)
    yield from _first_missing(document, "velocity", _added_joints(document))


def _first_missing(
    document: Document, section: str, joints: Sequence[str]
) -> Iterator[Fault]:
    given = document.keys(section)
    missing = [name for name in joints if name not in given]
    if missing and (given or section == "velocity"):
        message = f"no limit for joint '{missing[0]}'"
        at = (section,) if given else ()
        yield Fault(at, message if given else f"{section}: {message}", at_key=True)


def _unknown_links(document: Document, urdf: Urdf) -> Iterator[Fault]:
    for path in (("tool",), ("tool", "link"), ("hand", "link")):
        link = document.get(*path)
        if isinstance(link, str) and link not in urdf.links:
            yield Fault(path, unknown("link", link, urdf.links))
    pairs = document.get("disabled_pairs")
    links = (*urdf.links, *_added_links(document))
    for i in range(len(pairs) if isinstance(pairs, tuple) else 0):
        for k, link in enumerate(_texts(document, ("disabled_pairs", i))[:2]):
            if link not in links:
                yield Fault(("disabled_pairs", i, k), unknown("link", link, links))


def _added_links(document: Document) -> tuple[str, ...]:
    return ("mobile_base",) if document.get("base", "bodies") else ()


def _parked_faults(document: Document, urdf: Urdf) -> Iterator[Fault]:
    grouped = grouped_joints(document)
    for name in document.keys("parked"):
        path = ("parked", name)
        if name in grouped:
            message = f"'{name}' belongs to a group and moves; it cannot be parked"
            yield Fault(path, message, at_key=True)
        elif name in urdf.joints:
            for fault in joint_value_faults((document.get(*path),), [name], urdf):
                yield fault._replace(path=path)


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


def _numbers(document: Document, path: KeyPath) -> tuple[float, float] | None:
    value = document.get(*path)
    items = value if isinstance(value, tuple) else ()
    numbers = [v for v in items if isinstance(v, int | float)]
    return (numbers[0], numbers[1]) if len(items) == len(numbers) == 2 else None


def _texts(document: Document, path: KeyPath) -> list[str]:
    """The texts in the list at `path`; none where it is not a list."""
    value = document.get(*path)
    items = value if isinstance(value, tuple) else ()
    return [item for item in items if isinstance(item, str)]
