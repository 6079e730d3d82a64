"""XML elements that remember their places in the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET
from xml.parsers import expat

from mmplan.exceptions import Diagnostic, InputError
from mmplan.files.document import Place, located


@dataclass(frozen=True, eq=False)
class LocatedXml:
    """A parsed XML file. `path` is the file as the user named it."""

    path: Path
    lines: tuple[str, ...]
    root: ET.Element
    places: Mapping[ET.Element, Place]

    def diagnostic(self, element: ET.Element, message: str) -> Diagnostic:
        """The fault `message` of an element, with its place in the file."""
        return located(self.path, self.lines, self.places.get(element), message)


def read_xml(path: Path) -> LocatedXml:
    """Read an XML file.

    Raises:
        InputError: It cannot be read or is not XML.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        message = f"cannot be read: {error.strerror}"
        raise InputError(Diagnostic(message, str(path))) from None
    lines = tuple(content.decode(errors="replace").splitlines())
    builder, places = ET.TreeBuilder(), dict[ET.Element, Place]()
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def start(tag: str, attributes: dict[str, str]) -> None:
        place = Place(parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)
        places[builder.start(tag, attributes)] = place

    parser.StartElementHandler = start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        message = f"is not XML: {expat.errors.messages[error.code]}"
        place = Place(error.lineno, error.offset + 1)
        raise InputError(located(path, lines, place, message)) from None
    return LocatedXml(path, lines, builder.close(), places)
