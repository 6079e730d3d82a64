"""What is measured of a robot that is imported, once it can be loaded."""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from pathlib import Path

import numpy as np
import pinocchio as pin

from mmplan.exceptions import InputError
from mmplan.files.robot_sources import pieces_folder
from mmplan.files.srdf import disabled_pairs as srdf_pairs
from mmplan.files.urdf import UrdfError
from mmplan.files.urdf_composition import BASE_LINK
from mmplan.robot import Robot
from mmplan.robot_measures import base_radius
from mmplan.robot_setup.disabled_pairs import disabled_pairs, hand_links
from mmplan.robot_setup.draft import Draft
from mmplan.robot_setup.evidence import gather
from mmplan.robot_setup.hand_guess import guess_hand, rpy
from mmplan.robot_setup.link_meshes import link_meshes
from mmplan.robot_setup.pieces import choose, obj_text
from mmplan.robot_setup.rest import resting_places
from mmplan.robot_setup.score_scales import score_scales
from mmplan.robot_setup.self_collisions import SelfCollisions
from mmplan.robot_setup.wishes import Wishes

# A base that is not wider than this is taken for the foot of a bare arm, m.
_FOOT = 0.25
# A guess this near the tip's own frame is that frame, m.
_SAME = 0.008
# What such an arm is put on: radius and height of a cylinder, m.
PEDESTAL = (0.3, 0.4)


def finish(
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
        "open": guess.open.tolist(),
        "closed": guess.closed.tolist(),
    }
    draft.notes.append("hand: which end of each joint's range is open")
    if np.allclose(guess.T_tip_tool, np.eye(4), atol=_SAME):
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
        if size is None and _radius(robot, draft.trunk) <= _FOOT:
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
        radius = _significant(_radius(robot, draft.trunk))
        draft.data["base"]["radius"] = radius
        draft.notes.append(f"base radius {radius:g} m")
    draft.data["reach"] = _significant(robot.reach)
    draft.notes.append(f"reach {robot.reach:.3g} m")


def _radius(robot: Robot, trunk: Set[str]) -> float:
    """The radius (m) about the base's axis of the trunk's bodies and of an added base.

    Arms and heads that are held still stand out from the base, but are not of it.
    """
    geometry = pin.GeometryModel()
    for body in robot.geometry.geometryObjects:
        if robot.link_of(body) in trunk | {BASE_LINK}:
            geometry.addGeometryObject(body)
    return base_radius(geometry, robot.base_joint)


def _choose_bodies(draft: Draft, wishes: Wishes) -> None:
    """Cut the meshes of links whose hulls are not tight, and keep the pieces."""
    robot, description = draft.load()
    collision = {}
    for choice in choose(link_meshes(description), hand_links(robot), wishes.tight):
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
