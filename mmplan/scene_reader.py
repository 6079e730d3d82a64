"""A scene file, read and checked as far as that goes without any geometry.

Nothing in here imports Pinocchio, coal or OMPL, so that a faulty scene is reported at
once, with every fault of the scene and of the files that it names.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mmplan import assets
from mmplan.exceptions import Diagnostic, InputError
from mmplan.files.document import Document, Fault
from mmplan.files.faults import validate
from mmplan.files.fingerprint import fingerprint
from mmplan.files.scene_checks import (
    RobotFacts,
    package_folders,
    scene_faults,
    start_faults,
)
from mmplan.files.scene_sections import SCENE_VERSION, SceneSection
from mmplan.files.suggestions import listed, suggestion, unknown
from mmplan.files.urdf import read_urdf
from mmplan.files.yaml_reader import read_document
from mmplan.robot_file import RobotDescription, load_robot_description


@dataclass(frozen=True, eq=False)
class SceneFile:
    """A scene file that is well formed, with the robot that it names."""

    document: Document
    section: SceneSection
    robot: RobotDescription

    @property
    def folder(self) -> Path:
        """Where the file names of the scene begin."""
        return self.document.path.parent

    def fingerprint(self) -> str:
        """SHA-256 over the contents of the scene and of every file that it uses."""
        return fingerprint(dict(self._files()))

    def _files(self) -> Iterator[tuple[str, Path]]:
        """The files by the roles that they play."""
        robot = self.robot
        yield "scene", self.document.path
        yield "robot", robot.path
        yield from robot.files.items()
        sections = [*self.section.obstacles.items(), *self.section.objects.items()]
        for name, section in sections:
            if section.mesh is not None:
                yield f"{name} mesh", self.folder / section.mesh
        for name, item in self.section.objects.items():
            for grasp, file in item.grasp_files():
                yield f"{name} grasp {grasp}", self.folder / file
        for name, obstacle in self.section.obstacles.items():
            if obstacle.urdf is not None:
                urdf = self.folder / obstacle.urdf
                yield from _urdf_files(f"{name} urdf", urdf, package_folders(urdf))


def read_scene(name: str | Path) -> SceneFile:
    """Read and check a scene file.

    Args:
        name: The path of a scene file, or the bare name of a scene that is shipped.

    Raises:
        InputError: With every fault of the scene and of its robot's file.
    """
    document = _document(name)
    found = document.get("mmplan")
    if isinstance(found, int) and found != SCENE_VERSION:
        message = f"this mmplan reads version {SCENE_VERSION} of the scene format"
        raise document.error([Fault(("mmplan",), f"{message}, got {found}")])
    section, faults = validate(SceneSection, document)
    robot, robot_faults, robot_errors = _robot(document)
    every = [*faults, *scene_faults(document), *robot_faults]
    if every or robot_errors or section is None or robot is None:
        diagnostics = document.error(every).diagnostics
        raise InputError(*diagnostics, *robot_errors)
    return SceneFile(document, section, robot)


def _document(name: str | Path) -> Document:
    path = assets.find_scene(name)
    if _is_missing(path):
        shipped = assets.scene_names()
        guess = suggestion(path.stem, shipped) or ";"
        message = f"no such file{guess} scenes that are shipped: {listed(shipped)}"
        raise InputError(Diagnostic(message, file=str(path)))
    return read_document(path)


def _is_missing(path: Path) -> bool:
    """Whether nothing is there; where the system refuses to look, reading says why."""
    try:
        return not path.exists()
    except OSError:
        return False


def _robot(
    document: Document,
) -> tuple[RobotDescription | None, tuple[Fault, ...], tuple[Diagnostic, ...]]:
    """The scene's robot, the faults of what the scene says of it, those of its file."""
    name = document.get("robot", "model")
    if not isinstance(name, str):
        return None, (), ()
    path = assets.find_robot(name, document.path.parent)
    if path is None:
        message = unknown("robot", name, assets.robot_names())
        if "/" in name or name.endswith(".yaml"):
            message = f"no such file: '{name}', sought in {document.path.parent}"
        return None, (Fault(("robot", "model"), message),), ()
    try:
        robot = load_robot_description(path)
    except InputError as error:
        return None, (), error.diagnostics
    return robot, tuple(start_faults(document, _facts(robot))), ()


def _facts(robot: RobotDescription) -> RobotFacts:
    return RobotFacts(
        urdf=robot.facts,
        base=robot.base_joints,
        arm=robot.arm_joints,
        hand=robot.hand_leaders,
        configurations=robot.configurations,
    )


def _urdf_files(
    role: str, urdf: Path, package_dirs: tuple[Path, ...]
) -> Iterator[tuple[str, Path]]:
    yield role, urdf
    for name, path in read_urdf(urdf, package_dirs).meshes.items():
        yield f"{role} {name}", path
