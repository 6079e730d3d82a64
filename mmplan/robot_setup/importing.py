"""A robot.yaml for a URDF: what the URDF leaves open is guessed, and said."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mmplan import assets
from mmplan.exceptions import InputError, MmplanError
from mmplan.files.located_xml import LocatedXml
from mmplan.files.robot_sources import pieces_folder
from mmplan.files.srdf import disabled_pairs as srdf_pairs
from mmplan.files.urdf import UrdfError, urdf_facts
from mmplan.files.urdf_composition import BASE_JOINTS
from mmplan.robot import Robot
from mmplan.robot_setup import draft as drafts
from mmplan.robot_setup.disabled_pairs import disabled_pairs
from mmplan.robot_setup.draft import Draft
from mmplan.robot_setup.evidence import SAMPLES, gather
from mmplan.robot_setup.groups import Groups, guess_groups
from mmplan.robot_setup.hand_guess import guess_hand, rpy
from mmplan.robot_setup.link_meshes import link_meshes
from mmplan.robot_setup.pieces import TIGHT, choose, obj_text
from mmplan.robot_setup.rest import resting_places
from mmplan.robot_setup.score_scales import score_scales
from mmplan.robot_setup.self_collisions import SelfCollisions
from mmplan.robot_setup.sources import beside, in_wheel, read_urdf, take_over

# A base that is not wider than this is taken for the foot of a bare arm, m.
_FOOT = 0.25
# What such an arm is put on: radius and height of a cylinder, m.
PEDESTAL = (0.3, 0.4)


@dataclass(frozen=True)
class Wishes:
    """What the user says of a robot that is imported.

    `hand` are names of joints, or the path of a hand's URDF that is fixed to the tip.
    `pedestal` is the radius and height (m) of a cylinder that the URDF's root stands
    on; None: as it seems right.
    """

    base: str
    tip: str
    name: str
    arm: tuple[str, ...] = ()
    hand: tuple[str, ...] | Path = ()
    srdf: Path | None = None
    package_dirs: tuple[Path, ...] = ()
    pedestal: tuple[float, float] | None = None
    tight: float = TIGHT
    samples: int = SAMPLES


@dataclass(frozen=True)
class Imported:
    """The robot.yaml that was written, and what to check in it."""

    path: Path
    notes: tuple[str, ...]


def import_robot(
    urdf: Path,
    wishes: Wishes,
    folder: Path,
    progress: Callable[[str], None] = lambda _: None,
) -> Imported:
    """Write a folder with a robot.yaml for a URDF, whole or not at all.

    Raises:
        InputError: The URDF is faulty, does not have what was asked for, or `folder`
            is there already.
        NoPlanError: No configuration is free of collision.
    """
    if folder.exists():
        raise InputError(f"{folder}: is there already; give another folder with -o")
    package_dirs = (*wishes.package_dirs, *filter(None, [assets.example_robots()]))
    xml = read_urdf(urdf, package_dirs)
    folder.absolute().parent.mkdir(parents=True, exist_ok=True)
    scratch = Path(tempfile.mkdtemp(dir=folder.absolute().parent, prefix=".import_"))
    try:
        draft = _started(xml, wishes, scratch, package_dirs)
        _finished(draft, wishes, _srdf(urdf, wishes), progress)
        draft.write(_comment(urdf, draft.notes))
        scratch.chmod(0o755)
        scratch.replace(folder)
    except MmplanError as error:
        text = str(error).replace(str(scratch), str(folder))
        raise type(error)(text) from error
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return Imported(folder / assets.ROBOT_FILE, tuple(draft.notes))


def _comment(urdf: Path, notes: Sequence[str]) -> str:
    lines = [f"Made of {urdf.name} by `mmplan robot import`. To be checked:"]
    return "\n".join([*lines, *(f"- {note}" for note in notes)])


def _srdf(urdf: Path, wishes: Wishes) -> Path | None:
    return wishes.srdf if wishes.srdf is not None else beside(urdf)


def _started(
    xml: LocatedXml, wishes: Wishes, folder: Path, package_dirs: Sequence[Path]
) -> Draft:
    """A robot that can be loaded: all groups, but nothing measured yet."""
    named = () if isinstance(wishes.hand, Path) else wishes.hand
    groups = guess_groups(xml.root, wishes.tip, wishes.arm, named)
    notes = list(groups.notes)
    wheel = in_wheel(xml.path)
    if wheel is not None:
        source: Any = {"example_robot_data": str(wheel)}
    else:
        source, lacking = take_over(xml, folder, package_dirs)
        notes += lacking
    hand, hand_xml = _hand(groups, wishes, folder, package_dirs, notes)
    base_joints = BASE_JOINTS[wishes.base]
    roots = [xml.root] if hand_xml is None else [xml.root, hand_xml.root]
    velocity, acceleration, guesses = drafts.speeds(
        roots, (*groups.arm, *hand["joints"]), base_joints
    )
    data: dict[str, Any] = {
        "mmplan_robot": 1,
        "name": wishes.name,
        "description": f"{xml.root.get('name', wishes.name)} as imported",
        "urdf": source,
        "base": drafts.base_section(wishes.base),
        "arm": {"joints": list(groups.arm)},
        "hand": hand,
        "tool": wishes.tip,
        "ik": {"solver": "auto"},
        **({"velocity": velocity} if velocity else {}),
        "acceleration": acceleration,
        "configurations": {},
        "score_scales": {"manipulability": 1.0, "clutter": 1.0},
        "disabled_pairs": [],
    }
    return Draft(folder, data, [*notes, *guesses])


def _hand(
    groups: Groups,
    wishes: Wishes,
    folder: Path,
    package_dirs: Sequence[Path],
    notes: list[str],
) -> tuple[dict[str, Any], LocatedXml | None]:
    """The section of the hand, and its URDF where it has one of its own."""
    if groups.hand and not isinstance(wishes.hand, Path):
        zeros = [0.0] * len(groups.hand)
        return {"joints": list(groups.hand), "open": zeros, "closed": zeros}, None
    path = wishes.hand if isinstance(wishes.hand, Path) else _own_hand()
    xml = read_urdf(path, package_dirs)
    name, lacking = take_over(xml, folder, package_dirs)
    facts = urdf_facts(xml.root, {})
    joints = [n for n, j in facts.joints.items() if j.mimic is None]
    notes += lacking
    notes.append(
        f"hand: {path.name} is fixed to '{wishes.tip}' with its root's z along that "
        "link's z; turn it with hand.at"
    )
    section = {"urdf": name, "link": wishes.tip, "joints": joints}
    zeros = [0.0] * len(joints)
    return {**section, "open": zeros, "closed": zeros}, xml


def _own_hand() -> Path:
    return assets.robots_folder() / "two_finger_hand" / "two_finger_hand.urdf"


def _finished(
    draft: Draft, wishes: Wishes, srdf: Path | None, progress: Callable[[str], None]
) -> None:
    """Measure what is left, from the pose of the hand to the score scales."""
    progress("hand and tool frame")
    _guess_hand(draft, wishes)
    _guess_pedestal(draft, wishes)
    progress("collision bodies")
    _choose_bodies(draft, wishes)
    progress("pairs of links")
    robot, links = _disable_pairs(draft, wishes, srdf)
    progress("resting places")
    checked = {frozenset(pair[:2]) for pair in draft.data["disabled_pairs"]}
    places = resting_places(
        robot, links, [p for p in links.pairs if frozenset(p) not in checked]
    )
    draft.data["configurations"] = {n: _rounded(q, 3) for n, q in places.items()}
    scales = score_scales(robot, places["home"])
    draft.data["score_scales"] = {
        "manipulability": _significant(scales.manipulability),
        "clutter": _significant(scales.clutter),
    }
    draft.notes.append("configurations: found by search, free of collision")
    draft.load()


def _guess_hand(draft: Draft, wishes: Wishes) -> None:
    """Which end of the fingers' range is open, and the tool frame between them."""
    robot, _ = draft.load()
    guess = guess_hand(robot)
    draft.data["hand"] |= {
        "open": _rounded(guess.open, 4),
        "closed": _rounded(guess.closed, 4),
    }
    draft.notes.append("hand: which end of each joint's range is open")
    if np.allclose(guess.T_tip_tool, np.eye(4), atol=1e-3):
        return
    draft.data["tool"] = {
        "link": wishes.tip,
        "xyz": _rounded(guess.T_tip_tool[:3, 3], 4),
        "rpy": _rounded(rpy(guess.T_tip_tool), 6),
    }
    draft.notes.append("tool frame: between the fingertips; z approaches, y closes")


def _guess_pedestal(draft: Draft, wishes: Wishes) -> None:
    """Put a bare arm on a cylinder."""
    robot, _ = draft.load()
    if wishes.base != "fixed":
        size = wishes.pedestal
        if size is None and robot.base_radius <= _FOOT:
            size = PEDESTAL
            draft.notes.append(
                f"base: the URDF seems to be a bare arm; it stands on a cylinder of "
                f"radius {size[0]:g} m and height {size[1]:g} m (see --pedestal)"
            )
        if size is not None and min(size) > 0.0:
            body = {"cylinder": {"radius": size[0], "length": size[1]}}
            at = {"xyz": [0.0, 0.0, size[1] / 2]}
            draft.data["base"] |= {
                "mount": {"xyz": [0.0, 0.0, size[1]]},
                "bodies": {"pedestal": {**body, "at": at}},
            }
            robot, _ = draft.load()
        draft.data["base"]["radius"] = _significant(robot.base_radius)
    draft.data["reach"] = _significant(robot.reach)
    draft.notes.append(
        f"base radius {robot.base_radius:.3g} m, reach {robot.reach:.3g} m"
    )


def _choose_bodies(draft: Draft, wishes: Wishes) -> None:
    """Cut the meshes of links whose hulls are not tight, and keep the pieces."""
    robot, description = draft.load()
    fingers = {
        robot.link_of(body)
        for body in robot.geometry.geometryObjects
        if robot.kind_of(body) == "finger" or body.parentJoint == robot.tool_joint
    }
    collision = {}
    for choice in choose(link_meshes(description), fingers, wishes.tight):
        largest = f"{1e3 * choice.hulls.largest:.0f} mm"
        if choice.reason:
            why = f"its hull stands off by up to {largest}, {choice.reason}"
            draft.notes.append(f"body of {choice.link}: {why}")
        if choice.pieces:
            folder = pieces_folder(draft.path, choice.link)
            folder.mkdir(parents=True)
            for i, piece in enumerate(choice.pieces):
                (folder / f"{i:02d}.obj").write_text(obj_text(piece), encoding="utf-8")
            collision[choice.link] = "decomposed"
            draft.notes.append(
                f"body of {choice.link}: {len(choice.pieces)} pieces, as its hull "
                f"stands off by up to {largest}"
            )
    if collision:
        draft.data["collision"] = collision


def _disable_pairs(
    draft: Draft, wishes: Wishes, srdf: Path | None
) -> tuple[Robot, SelfCollisions]:
    robot, _ = draft.load()
    links = SelfCollisions(robot)
    evidence = gather(robot, links, wishes.samples)
    given = () if srdf is None else _given(srdf)
    found = disabled_pairs(robot, links, evidence, given)
    draft.data["disabled_pairs"] = [list(pair) for pair in found]
    of_srdf = sum(pair.reason.startswith("SRDF") for pair in found)
    source = f", {of_srdf} of them by {srdf.name}" if srdf and of_srdf else ""
    draft.notes.append(
        f"pairs of links: {len(found)} of {len(links.pairs)} are not checked{source}"
    )
    return robot, links


def _given(srdf: Path) -> tuple[tuple[str, str, str], ...]:
    try:
        return srdf_pairs(srdf)
    except (UrdfError, OSError) as error:
        raise InputError(f"{srdf}: {error}") from error


def _rounded(values: Sequence[float] | np.ndarray, digits: int) -> list[float]:
    return [round(float(x), digits) + 0.0 for x in values]


def _significant(value: float) -> float:
    return float(f"{value:.3g}")
