"""Which joints of a URDF are the arm, which the hand, guessed from its tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as ET

from mmplan.exceptions import InputError
from mmplan.files.suggestions import unknown
from mmplan.files.urdf import UrdfJoint, urdf_facts
from mmplan.files.urdf_edit import joint_link, root_link

# An arm has no more turning joints; those nearer to the root are held still.
_MOST = 7


@dataclass(frozen=True)
class Groups:
    """Names of joints, in the order from the root to the tip; `notes` are guesses."""

    arm: tuple[str, ...]
    hand: tuple[str, ...]  # without those that mimic others
    trunk: frozenset[str]  # links that are fixed to the root
    notes: tuple[str, ...]


def guess_groups(
    root: ET.Element, tip: str, arm: Sequence[str] = (), hand: Sequence[str] = ()
) -> Groups:
    """The arm is the chain down to `tip`, the hand what moves below its last joint.

    Joints that are named in `arm` and `hand` are taken instead.

    Raises:
        InputError: There is no such link or joint, or nothing moves the tip.
    """
    facts = urdf_facts(root, {})
    if tip not in facts.links:
        raise InputError(f"--tip: {unknown('link', tip, facts.links)}")
    for option, names in (("--arm", arm), ("--hand", hand)):
        for name in names:
            if name not in facts.joints:
                raise InputError(f"{option}: {unknown('joint', name, facts.joints)}")
    way = _way(root, tip)
    names = [joint.get("name", "") for joint in way]
    moving = [n for n in names if n in facts.joints and _moves(facts.joints[n])]
    lifts = [j.get("name", "") for j in way if j.get("type") == "prismatic"]
    chosen = tuple(arm) or _last(moving, lifts)
    if not chosen:
        raise InputError(f"--tip: no joint that moves is above link '{tip}'")
    held = tuple(n for n in moving if n not in chosen)
    below = {j.get("name", "") for j in _below(root, _child(root, chosen[-1]))}
    free = [n for n, joint in facts.joints.items() if n in below and _moves(joint)]
    fingers = tuple(hand) or tuple(n for n in free if n not in chosen)
    notes = tuple(_notes(chosen, held, fingers))
    return Groups(chosen, fingers, _trunk(root), notes)


def _notes(arm: Sequence[str], held: Sequence[str], hand: Sequence[str]) -> list[str]:
    notes = [f"arm: {', '.join(arm)}", f"hand: {', '.join(hand) or 'none'}"]
    if held:
        notes.append(f"held still above the arm: {', '.join(held)}")
    if len(arm) < 6:
        few = f"{len(arm)} joints cannot bring the tool to every pose"
        notes.append(f"the arm's {few}: few grasps will be in reach")
    return notes


def _moves(joint: UrdfJoint) -> bool:
    return joint.mimic is None and joint.lower < joint.upper


def _last(moving: Sequence[str], lifts: Sequence[str]) -> tuple[str, ...]:
    """The last joints of a chain: seven at most, and a lift right above them."""
    start = max(0, len(moving) - _MOST)
    if start > 0 and moving[start - 1] in lifts:
        start -= 1
    return tuple(moving[start:])


def _way(root: ET.Element, tip: str) -> list[ET.Element]:
    """The joints from the root down to a link."""
    above = {joint_link(j, "child"): j for j in root.findall("joint")}
    way = []
    while tip in above:
        way.append(above[tip])
        tip = joint_link(above[tip], "parent")
    return way[::-1]


def _trunk(root: ET.Element) -> frozenset[str]:
    """The root link and all that fixed joints hold to it."""
    trunk = {root_link(root)}
    fixed = [j for j in root.findall("joint") if j.get("type") == "fixed"]
    while (
        new := {
            joint_link(j, "child") for j in fixed if joint_link(j, "parent") in trunk
        }
        - trunk
    ):
        trunk |= new
    return frozenset(trunk)


def _below(root: ET.Element, link: str) -> list[ET.Element]:
    """All joints below a link."""
    found = []
    for joint in root.findall("joint"):
        if joint_link(joint, "parent") == link:
            found += [joint, *_below(root, joint_link(joint, "child"))]
    return found


def _child(root: ET.Element, name: str) -> str:
    joint = next(j for j in root.findall("joint") if j.get("name") == name)
    return joint_link(joint, "child")
