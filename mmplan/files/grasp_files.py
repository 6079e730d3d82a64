"""Files of grasps made elsewhere: isaac_grasp 1.0 and task space regions, as YAML.

Both speak of a hand frame of their own; `mmplan.grasp_exchange` says how it relates to
the robot's tool frame.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, NamedTuple, TypeAlias, TypeVar

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, model_validator
from typing_extensions import Self

from mmplan.exceptions import InputError
from mmplan.files.document import Document, Fault
from mmplan.files.faults import validate
from mmplan.files.section import Interval, Metres, Section, fault
from mmplan.files.yaml_reader import read_document
from mmplan.files.yaml_writer import Plain, yaml_text
from mmplan.shapes import Array

_ROTATION_TOLERANCE, _NORM_TOLERANCE = 1e-4, 1e-3
_DIGITS = 9

_S = TypeVar("_S", bound=Section)
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Row: TypeAlias = tuple[float, float, float, float]
Displacement: TypeAlias = Annotated[
    tuple[Interval, ...], Field(min_length=6, max_length=6)
]


class ListedGrasps(NamedTuple):
    """Grasps one by one, as the hand frame of their file."""

    T_object_hand: Array  # (n, 4, 4)
    qualities: Array  # (n,), the confidences of the file
    names: tuple[str, ...]
    hand_frame: str  # as the file calls it, empty where it does not


class Region(NamedTuple):
    """A task space region with the hand frame of its file."""

    name: str
    T_object_w: Array  # (4, 4)
    T_w_hand: Array  # (4, 4)
    bounds: Array  # (6, 2)


class _Lenient(Section):
    """A mapping of a file of others, which may hold more than mmplan reads."""

    model_config = ConfigDict(extra="ignore")


class _Turn(_Lenient):
    w: float
    xyz: tuple[float, float, float]

    @model_validator(mode="after")
    def _is_unit(self) -> Self:
        norm = math.hypot(self.w, *self.xyz)
        if abs(norm - 1.0) > _NORM_TOLERANCE:
            raise fault(f"a unit quaternion has norm 1, this one {norm:.4g}")
        return self


class _IsaacGrasp(_Lenient):
    confidence: Share = 1.0
    position: tuple[Metres, Metres, Metres]
    orientation: _Turn


class _IsaacFile(_Lenient):
    format: Literal["isaac_grasp"]
    format_version: float | str
    gripper_frame: str = ""
    gripper_frame_link: str = ""
    grasps: Annotated[dict[str, _IsaacGrasp], Field(min_length=1)]


def _pose(rows: tuple[Row, ...]) -> tuple[Row, ...]:
    T = np.array(rows)
    R = T[:3, :3]
    rigid = np.allclose(R @ R.T, np.eye(3), atol=_ROTATION_TOLERANCE)
    if not rigid or np.linalg.det(R) < 0.0 or not np.array_equal(T[3], [0, 0, 0, 1]):
        raise fault("expected a rigid transform, 4 rows of 4 numbers")
    return rows


Matrix: TypeAlias = Annotated[
    tuple[Row, ...], Field(min_length=4, max_length=4), AfterValidator(_pose)
]


class _Template(_Lenient):
    name: str = "region"
    T_ref_tsr: Matrix
    Tw_e: Matrix
    Bw: Displacement


class _TemplateFile(_Lenient):
    templates: Annotated[tuple[_Template, ...], Field(min_length=1)]


def read_grasp_file(path: Path) -> ListedGrasps | tuple[Region, ...]:
    """The grasps of a file, in its own hand frame.

    Raises:
        InputError: The file is of neither format, or faulty; with every fault of it.
    """
    document = read_document(path)
    if document.get("format") is not None:
        return _listed(document)
    if document.get("templates") is not None:
        file = _checked(_TemplateFile, document)
        return tuple(_region(template) for template in file.templates)
    if document.get("T_ref_tsr") is not None:
        return (_region(_checked(_Template, document)),)
    raise InputError(
        f"{path}: no file of grasps: expected 'format: isaac_grasp', a task space "
        "region with T_ref_tsr, Tw_e and Bw, or 'templates' with several"
    )


def isaac_text(grasps: ListedGrasps, opened: Sequence[dict[str, float]]) -> str:
    """The grasps as isaac_grasp 1.0; `opened` is the hand before closing, by joint."""
    entries: dict[str, Plain] = {
        name: {
            "confidence": round(float(quality), _DIGITS),
            "position": _numbers(T[:3, 3]),
            "orientation": _turn(T[:3, :3]),
            "pregrasp_cspace_position": {
                joint: round(value, _DIGITS) for joint, value in hand.items()
            },
        }
        for name, T, quality, hand in zip(
            grasps.names, grasps.T_object_hand, grasps.qualities, opened, strict=True
        )
    }
    head: dict[str, Plain] = {"format": "isaac_grasp", "format_version": 1.0}
    if grasps.hand_frame:
        head["gripper_frame"] = grasps.hand_frame
    return yaml_text({**head, "grasps": entries})


def regions_text(regions: Sequence[Region]) -> str:
    """Task space regions as YAML templates."""
    templates: list[Plain] = [
        {
            "name": region.name,
            "T_ref_tsr": [_numbers(row) for row in region.T_object_w],
            "Tw_e": [_numbers(row) for row in region.T_w_hand],
            "Bw": [_numbers(row) for row in region.bounds],
        }
        for region in regions
    ]
    return yaml_text({"templates": templates})


def _listed(document: Document) -> ListedGrasps:
    file = _checked(_IsaacFile, document)
    if float(file.format_version) != 1.0:
        message = f"version 1.0 is read, got {file.format_version}"
        raise document.error([Fault(("format_version",), message)])
    poses = [_pose_of(grasp) for grasp in file.grasps.values()]
    return ListedGrasps(
        T_object_hand=np.array(poses),
        qualities=np.array([g.confidence for g in file.grasps.values()]),
        names=tuple(file.grasps),
        hand_frame=file.gripper_frame or file.gripper_frame_link,
    )


def _pose_of(grasp: _IsaacGrasp) -> Array:
    w, (x, y, z) = grasp.orientation.w, grasp.orientation.xyz
    q = np.array([w, x, y, z]) / math.hypot(w, x, y, z)
    T = np.eye(4)
    T[:3, :3] = _rotation(*q)
    T[:3, 3] = grasp.position
    return T


def _rotation(w: float, x: float, y: float, z: float) -> Array:
    """The rotation matrix (3, 3) of a unit quaternion."""
    v, s = np.array([x, y, z]), np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    R: Array = (w * w - v @ v) * np.eye(3) + 2.0 * np.outer(v, v) + 2.0 * w * s
    return R


def _turn(R: Array) -> dict[str, Plain]:
    """The unit quaternion of a rotation matrix, by its largest component."""
    products = np.empty((4, 4))  # 4 times the products of the components w, x, y, z
    products[0, 0] = 1.0 + np.trace(R)
    products[1:, 1:] = R + R.T + (1.0 - np.trace(R)) * np.eye(3)
    products[0, 1:] = [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    products[1:, 0] = products[0, 1:]
    row = products[np.argmax(np.diag(products))]
    w, *xyz = _numbers(row / np.linalg.norm(row))
    return {"w": w, "xyz": xyz}


def _region(template: _Template) -> Region:
    return Region(
        name=template.name,
        T_object_w=np.array(template.T_ref_tsr),
        T_w_hand=np.array(template.Tw_e),
        bounds=np.array(template.Bw),
    )


def _numbers(values: Array) -> list[float]:
    return [round(float(value), _DIGITS) + 0.0 for value in values]


def _checked(model: type[_S], document: Document) -> _S:
    section, faults = validate(model, document)
    if faults or section is None:
        raise document.error(faults)
    return section
