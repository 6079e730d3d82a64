"""Faults of how the joints of a URDF connect its links, and of who mimics whom."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from xml.etree import ElementTree as ET

from mmplan.files.suggestions import listed, unknown
from mmplan.files.urdf_numbers import numbers

TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")

Found = Iterator[tuple[ET.Element, str]]


def structure_faults(root: ET.Element) -> Found:
    """Names used twice, unknown links, links with two parents, not exactly one root."""
    links, joints = root.findall("link"), root.findall("joint")
    yield from _repeated(links)
    yield from _repeated(joints)
    names = [link.get("name", "") for link in links]
    found = [fault for joint in joints for fault in _joint_faults(joint, names)]
    yield from found
    if not found:
        yield from _tree_faults(root, links, joints)


def _repeated(elements: list[ET.Element]) -> Found:
    seen: set[str] = set()
    for element in elements:
        name = element.get("name", "")
        if not name:
            yield element, f"a <{element.tag}> needs a name"
        elif name in seen:
            yield (
                element,
                f"a second <{element.tag}> of this name; one is allowed",
            )
        seen.add(name)


def _joint_faults(joint: ET.Element, links: list[str]) -> Found:
    kind = joint.get("type", "")
    if kind not in TYPES:
        yield joint, unknown("type", kind, TYPES)
    for end in ("parent", "child"):
        element = joint.find(end)
        if element is None:
            yield joint, f"has no <{end}>; a joint needs <parent link> and <child link>"
        elif element.get("link") not in links:
            yield element, unknown("link", element.get("link", ""), links)


def _tree_faults(
    root: ET.Element, links: list[ET.Element], joints: list[ET.Element]
) -> Found:
    children = [_end(joint, "child") for joint in joints]
    for name, count in Counter(children).items():
        if count > 1:
            above = [j.get("name", "") for j in joints if _end(j, "child") == name]
            link = next(link for link in links if link.get("name") == name)
            yield link, f"is the child of {count} joints ({listed(above)}); one allowed"
    roots = [link for link in links if link.get("name") not in children]
    if not links:
        yield root, "has no links"
    elif not roots:
        yield root, "has no root: its joints form a loop"
    elif len(roots) > 1:
        names = ", ".join(f"'{link.get('name')}'" for link in roots)
        text = f"{len(roots)} links have no parent: {names}; one root is allowed"
        yield roots[1], f"{text}: join them by a <joint>"


def mimic_faults(root: ET.Element) -> Found:
    """Joints that mimic one that is not there, themselves, or one that mimics."""
    joints = {joint.get("name", ""): joint for joint in root.findall("joint")}
    for name, joint in joints.items():
        mimic = joint.find("mimic")
        if mimic is None:
            continue
        leader = mimic.get("joint", "")
        if leader not in joints:
            yield mimic, unknown("joint", leader, joints)
        elif leader == name:
            yield mimic, "mimics itself"
        elif (above := joints[leader].find("mimic")) is not None:
            yield mimic, _chain(mimic, above)


def _chain(mimic: ET.Element, above: ET.Element) -> str:
    """What to write instead of a mimic of a mimic."""
    leader, first = mimic.get("joint"), above.get("joint")
    text = f"mimics '{leader}', which itself mimics '{first}'; mimic '{first}'"
    m, n = (numbers(e, "multiplier", "1") for e in (mimic, above))
    a, b = (numbers(e, "offset", "0") for e in (mimic, above))
    if m and n and a and b:
        text += f" with multiplier {m[0] * n[0]:g}, offset {m[0] * b[0] + a[0]:g}"
    return text


def _end(joint: ET.Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.get("link", "")


def axis_fault(axis: ET.Element) -> str | None:
    """Why an <axis> is no direction; None if it is."""
    xyz = numbers(axis, "xyz")
    if xyz is not None and len(xyz) == 3 and 0 < sum(x * x for x in xyz) < float("inf"):
        return None
    return f"expected 3 finite numbers, not all 0, for 'xyz'; got '{axis.get('xyz')}'"
