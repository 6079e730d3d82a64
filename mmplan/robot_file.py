"""robot.yaml -> `RobotDescription`, with every fault of the file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan.exceptions import InputError
from mmplan.files.document import Fault
from mmplan.files.faults import validate
from mmplan.files.robot_checks import joined_facts, robot_faults
from mmplan.files.robot_composition import composed, mimics_of
from mmplan.files.robot_sections import RobotSection
from mmplan.files.robot_sources import robot_sources
from mmplan.files.srdf import disabled_pairs
from mmplan.files.urdf import Mimic, Urdf, UrdfError, urdf_facts
from mmplan.files.urdf_composition import BASE_JOINTS, TOOL_LINK
from mmplan.files.yaml_reader import read_document


@dataclass(frozen=True, eq=False)
class RobotDescription:
    """What a robot.yaml and its URDFs say, before any model is built.

    `urdf` is one URDF of the whole robot, with the joints of base, arm and hand and no
    others, whose meshes are named by their paths; `facts` says what is in it. The
    joints of the hand are those of robot.yaml, then those that mimic them. Angles are
    in radians, lengths in metres.
    """

    path: Path  # the robot.yaml
    name: str
    description: str
    urdf: str
    facts: Urdf
    files: Mapping[str, Path]  # that the robot is made of, by role
    base_type: str
    base_joints: tuple[str, ...]
    base_radius: float | None  # None: to be computed
    turning_radius: float  # 0: turns on the spot
    arm_joints: tuple[str, ...]
    hand_joints: tuple[str, ...]
    hand_open: tuple[float, ...]
    hand_closed: tuple[float, ...]
    mimics: Mapping[str, Mimic]  # joints of the hand that follow others
    tool: str
    reach: float | None  # None: to be computed
    ik_solver: str
    ik_settings: Mapping[str, float]
    acceleration: Mapping[str, float]  # by joint
    configurations: Mapping[str, tuple[float, ...]]  # arm joints
    manipulability_scale: float
    clutter_scale: float
    collision: Mapping[str, str]  # link -> hull, mesh or decomposed; others: hull
    disabled_pairs: tuple[tuple[str, str, str], ...]  # two links and the reason

    @property
    def hand_leaders(self) -> tuple[str, ...]:
        """The joints of the hand that follow no others."""
        return tuple(name for name in self.hand_joints if name not in self.mimics)


def load_robot_description(path: Path) -> RobotDescription:
    """Read a robot.yaml.

    Raises:
        InputError: The file or its URDF is faulty; every fault is named.
    """
    document = read_document(path)
    section, faults = validate(RobotSection, document)
    sources, missing = robot_sources(document)
    facts = joined_facts(document, sources.facts)
    against = robot_faults(document, facts) if sources.urdf is not None else ()
    faults = (*faults, *missing, *against)
    if faults or sources.faults or section is None or sources.urdf is None:
        raise InputError(*document.error(faults).diagnostics, *sources.faults)
    try:
        urdf = composed(section, sources.urdf, sources.hand, sources.pieces)
    except UrdfError as error:
        raise document.error([Fault(("urdf",), str(error))]) from None
    try:
        pairs = disabled_pairs(sources.srdf) if sources.srdf is not None else ()
    except UrdfError as error:
        raise document.error([Fault(("srdf",), str(error))]) from None
    facts = urdf_facts(urdf, {})
    known = ((a, b, why) for a, b, why in pairs if {a, b} <= set(facts.links))
    pairs = (*section.disabled_pairs, *known)
    files = dict(sources.files())
    return _description(section, path, urdf, files, pairs)


def _description(
    section: RobotSection,
    path: Path,
    urdf: ET.Element,
    files: Mapping[str, Path],
    disabled_pairs: tuple[tuple[str, str, str], ...],
) -> RobotDescription:
    facts = urdf_facts(urdf, {})
    base, hand, scales = section.base, section.hand, section.score_scales
    mimics = mimics_of(hand.joints, facts.joints)
    return RobotDescription(
        path=path,
        name=section.name,
        description=section.description,
        urdf=ET.tostring(urdf, encoding="unicode"),
        facts=facts,
        files=files,
        base_type=base.type,
        base_joints=base.joints or BASE_JOINTS[base.type],
        base_radius=base.radius,
        turning_radius=base.turning_radius or 0.0,
        arm_joints=section.arm.joints,
        hand_joints=(*hand.joints, *mimics),
        hand_open=_followed(hand.joints, hand.open, mimics),
        hand_closed=_followed(hand.joints, hand.closed, mimics),
        mimics=mimics,
        tool=section.tool if isinstance(section.tool, str) else TOOL_LINK,
        reach=section.reach,
        ik_solver=section.ik.solver,
        ik_settings=dict(section.ik.__pydantic_extra__),
        acceleration=_accelerations(section.acceleration, mimics),
        configurations=section.configurations,
        manipulability_scale=scales.manipulability,
        clutter_scale=scales.clutter,
        collision={
            link: kind
            for link, kind in section.collision.items()
            if isinstance(kind, str)
        },
        disabled_pairs=disabled_pairs,
    )


def _followed(
    leaders: Sequence[str], values: Sequence[float], mimics: Mapping[str, Mimic]
) -> tuple[float, ...]:
    """The values of the leaders, then those of the joints that mimic them."""
    of = dict(zip(leaders, values, strict=True))
    return (*values, *(mimic.position(of[mimic.leader]) for mimic in mimics.values()))


def _accelerations(
    given: Mapping[str, float], mimics: Mapping[str, Mimic]
) -> dict[str, float]:
    """The limits given, and for joints that mimic others what these mean for them."""
    followed = {
        name: abs(mimic.multiplier) * given[mimic.leader]
        for name, mimic in mimics.items()
    }
    return {**followed, **given}
