"""robot.yaml -> `RobotDescription`, with every fault of the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from mmplan import assets
from mmplan.files.document import Document, Fault
from mmplan.files.faults import validate
from mmplan.files.robot_checks import robot_faults
from mmplan.files.robot_sections import RobotSection
from mmplan.files.urdf import UrdfError, read_urdf
from mmplan.files.yaml_reader import read_document


@dataclass(frozen=True)
class RobotDescription:
    """What a robot.yaml says, checked by itself but not yet against the URDF.

    Angles are in radians, lengths in metres. `package_dirs` are the folders in which
    `package://` paths of the URDF are looked up.
    """

    path: Path  # the robot.yaml
    name: str
    description: str
    urdf: Path
    package_dirs: tuple[Path, ...]
    base_type: str  # "xy"
    base_joints: tuple[str, ...]
    base_radius: float
    arm_joints: tuple[str, ...]
    hand_joints: tuple[str, ...]
    hand_open: tuple[float, ...]
    hand_closed: tuple[float, ...]
    tool: str
    reach: float
    ik_solver: str
    ik_settings: Mapping[str, float]
    acceleration: Mapping[str, float]  # by joint
    configurations: Mapping[str, tuple[float, ...]]  # arm joints
    manipulability_scale: float
    clutter_scale: float
    disabled_pairs: tuple[tuple[str, str, str], ...]  # two links and the reason


def load_robot_description(path: Path) -> RobotDescription:
    """Read a robot.yaml.

    Raises:
        InputError: The file or its URDF is faulty; every fault is named.
    """
    document = read_document(path)
    section, faults = validate(RobotSection, document)
    location = _urdf_location(document)
    if isinstance(location, Fault):
        faults = (*faults, location)
    elif location is not None:
        faults = (*faults, *_faults_of_urdf(document, *location))
    if faults or section is None or location is None or isinstance(location, Fault):
        raise document.error(faults)
    return _description(section, path, *location)


def _urdf_location(
    document: Document,
) -> tuple[Path, tuple[Path, ...]] | Fault | None:
    """The URDF and the folders of its packages; None where the key itself is faulty."""
    here = document.path.parent.resolve()
    name = document.get("urdf")
    example = document.get("urdf", "example_robot_data")
    if isinstance(name, str) and assets.is_file(here / name):
        return here / name, (here, here.parent)
    if isinstance(example, str):
        return _example_location(example)
    return None


def _example_location(name: str) -> tuple[Path, tuple[Path, ...]] | Fault:
    path = ("urdf", "example_robot_data")
    share = assets.example_robots()
    if share is None:
        message = "needs example-robot-data: pip install 'mmplan[robots]'"
        return Fault(path, message)
    urdf = share / "example-robot-data" / "robots" / name
    if not assets.is_file(urdf):
        return Fault(path, f"no such file in {urdf.parent.parent}: '{name}'")
    return urdf, (share,)


def _faults_of_urdf(
    document: Document, urdf: Path, package_dirs: tuple[Path, ...]
) -> tuple[Fault, ...]:
    try:
        return tuple(robot_faults(document, read_urdf(urdf, package_dirs)))
    except UrdfError as error:
        return (Fault(("urdf",), str(error)),)


def _description(
    section: RobotSection, path: Path, urdf: Path, package_dirs: tuple[Path, ...]
) -> RobotDescription:
    return RobotDescription(
        path=path,
        name=section.name,
        description=section.description,
        urdf=urdf,
        package_dirs=package_dirs,
        base_type=section.base.type,
        base_joints=section.base.joints,
        base_radius=section.base.radius,
        arm_joints=section.arm.joints,
        hand_joints=section.hand.joints,
        hand_open=section.hand.open,
        hand_closed=section.hand.closed,
        tool=section.tool,
        reach=section.reach,
        ik_solver=section.ik.solver,
        ik_settings=dict(section.ik.__pydantic_extra__),
        acceleration=section.acceleration,
        configurations=section.configurations,
        manipulability_scale=section.score_scales.manipulability,
        clutter_scale=section.score_scales.clutter,
        disabled_pairs=section.disabled_pairs,
    )
