"""Grasps in scene files: one section for each family, or the name of a file."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import BeforeValidator, Discriminator, Tag

from mmplan.files.free_grasp_sections import (
    AntipodalSection,
    FileSection,
    HandleSection,
    PosesSection,
    TsrSection,
)
from mmplan.files.section import FileName, Section, fault, fault_at
from mmplan.files.shape_grasp_sections import (
    AxisSection,
    BoxFacesSection,
    CylinderSideSection,
    CylinderTopSection,
    RimSection,
    SphereGraspsSection,
)
from mmplan.files.suggestions import listed, unknown

AnyGrasp: TypeAlias = (
    AxisSection
    | CylinderSideSection
    | CylinderTopSection
    | RimSection
    | BoxFacesSection
    | SphereGraspsSection
    | HandleSection
    | PosesSection
    | TsrSection
    | AntipodalSection
    | FileSection
)
FAMILIES: dict[str, type[AnyGrasp]] = {
    "axis": AxisSection,
    "cylinder_side": CylinderSideSection,
    "cylinder_top": CylinderTopSection,
    "rim": RimSection,
    "box_faces": BoxFacesSection,
    "sphere": SphereGraspsSection,
    "handle": HandleSection,
    "poses": PosesSection,
    "tsr": TsrSection,
    "antipodal": AntipodalSection,
    "file": FileSection,
}


def _known_family(value: object) -> object:
    """The grasp as written, once its family is known."""
    if isinstance(value, str):
        return value
    if not isinstance(value, dict):
        raise fault("expected {family: ..., ...} or the name of a file of grasps")
    family = value.get("family")
    if "family" not in value:
        raise fault(f"missing key 'family'; known: {listed(FAMILIES)}")
    if not isinstance(family, str) or family not in FAMILIES:
        raise fault_at(("family",), unknown("family", str(family), FAMILIES))
    return value


def _section(value: str | dict[str, str] | AnyGrasp) -> str:
    """The tag of a grasp: the name of its section's class, or that of a file."""
    if isinstance(value, str):
        return "file name"
    if isinstance(value, Section):
        return type(value).__name__
    return FAMILIES[value["family"]].__name__


GraspSection: TypeAlias = Annotated[
    Annotated[AxisSection, Tag("AxisSection")]
    | Annotated[CylinderSideSection, Tag("CylinderSideSection")]
    | Annotated[CylinderTopSection, Tag("CylinderTopSection")]
    | Annotated[RimSection, Tag("RimSection")]
    | Annotated[BoxFacesSection, Tag("BoxFacesSection")]
    | Annotated[SphereGraspsSection, Tag("SphereGraspsSection")]
    | Annotated[HandleSection, Tag("HandleSection")]
    | Annotated[PosesSection, Tag("PosesSection")]
    | Annotated[TsrSection, Tag("TsrSection")]
    | Annotated[AntipodalSection, Tag("AntipodalSection")]
    | Annotated[FileSection, Tag("FileSection")]
    | Annotated[FileName, Tag("file name")],
    Discriminator(_section),
    BeforeValidator(_known_family),
]
