"""The part of an SRDF that mmplan reads: the pairs of links that need no check."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan.files.urdf import UrdfError


def disabled_pairs(path: Path) -> tuple[tuple[str, str, str], ...]:
    """Two links and the reason why they are not checked, as often as there are.

    Raises:
        UrdfError: The file is no SRDF.
    """
    try:
        root = ET.parse(path).getroot()
    except ET.ParseError as error:
        raise UrdfError(f"'{path.name}' is not XML: {error}") from None
    if root.tag != "robot":
        raise UrdfError(f"'{path.name}' is no SRDF: its root is <{root.tag}>")
    return tuple(
        (pair.get("link1", ""), pair.get("link2", ""), pair.get("reason", "SRDF"))
        for pair in root.iter("disable_collisions")
    )
