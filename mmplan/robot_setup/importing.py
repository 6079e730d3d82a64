"""A robot.yaml for a URDF: what the URDF leaves open is guessed, and said."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mmplan import assets
from mmplan.exceptions import InputError, MmplanError
from mmplan.files.located_xml import LocatedXml
from mmplan.files.urdf import urdf_facts
from mmplan.files.urdf_composition import BASE_JOINTS
from mmplan.robot_setup import draft as drafts
from mmplan.robot_setup.draft import Draft
from mmplan.robot_setup.finishing import finish
from mmplan.robot_setup.groups import Groups, guess_groups
from mmplan.robot_setup.sources import beside, in_wheel, read_urdf, take_over
from mmplan.robot_setup.wishes import Wishes


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
        finish(draft, wishes, _srdf(urdf, wishes), progress)
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
    return Draft(folder, data, groups.trunk, [*notes, *guesses])


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
