"""YAML text -> a tree of nodes with places, built from the events of the parser.

Building it here rather than by PyYAML's composer bounds the depth, leaves tags out and
tells a cyclic alias from one that is merely used twice.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import yaml

from mmplan.files.document import Place
from mmplan.files.suggestions import listed

if TYPE_CHECKING:
    from yaml._yaml import Mark as CMark

DEEPEST = 30  # levels of nesting


class TreeError(Exception):
    """The text is not a tree that mmplan reads; caught by the reader."""

    def __init__(self, message: str, place: Place) -> None:
        """Keep the place for the reader, which knows the file."""
        self.message = message
        self.place = place
        super().__init__(message)


@dataclass(eq=False)
class Node:
    """A scalar, a sequence of `items`, or a mapping of alternate keys and values.

    An alias is the same node as its anchor, met a second time.
    """

    kind: str  # "scalar", "sequence" or "mapping"
    place: Place
    text: str = ""
    quoted: bool = False
    fault: str | None = None
    items: list[Node] = field(default_factory=list)


def build_tree(text: str) -> Node | None:
    """The root of the only document in `text`; None where there is none."""
    builder = _Builder()
    try:
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            builder.take(event)
    except yaml.MarkedYAMLError as error:
        raise _syntax_error(error) from None
    return builder.root


class _Builder:
    """Takes the parser's events and grows the tree."""

    def __init__(self) -> None:
        self.root: Node | None = None
        self._open: list[Node] = []
        self._anchors: dict[str, Node] = {}

    def take(self, event: yaml.Event) -> None:
        """Grow the tree by one event."""
        if isinstance(event, yaml.DocumentStartEvent):
            self._start_document(event)
        elif isinstance(event, yaml.CollectionEndEvent):
            self._open.pop()
        elif isinstance(event, yaml.AliasEvent):
            self._attach(self._aliased(event))
        elif isinstance(event, yaml.NodeEvent):
            self._start_node(event)

    def _start_document(self, event: yaml.DocumentStartEvent) -> None:
        if self.root is not None:
            raise TreeError("expected one YAML document, got another", _place(event))

    def _start_node(self, event: yaml.NodeEvent) -> None:
        node = _node(event)
        self._attach(node)
        if event.anchor is not None:
            self._anchors[event.anchor] = node
        if isinstance(event, yaml.CollectionStartEvent):
            self._open.append(node)
            if len(self._open) > DEEPEST:
                message = f"is nested more than {DEEPEST} levels deep"
                raise TreeError(message, node.place)

    def _aliased(self, event: yaml.AliasEvent) -> Node:
        """The node that an alias stands for."""
        node = self._anchors.get(str(event.anchor))
        if node is None:
            known = listed(self._anchors)
            message = f"unknown alias '*{event.anchor}'; anchors before it: {known}"
            raise TreeError(message, _place(event))
        if any(node is above for above in self._open):
            message = f"cyclic reference: '*{event.anchor}' stands inside itself"
            raise TreeError(message, _place(event))
        return node

    def _attach(self, node: Node) -> None:
        if self._open:
            self._open[-1].items.append(node)
        else:
            self.root = node


def _node(event: yaml.NodeEvent) -> Node:
    """The node that begins with `event`."""
    fault = None
    tag = getattr(event, "tag", None)
    if tag is not None:
        tag = tag.replace("tag:yaml.org,2002:", "!!")
        fault = f"tags are not read; leave out '{tag}'"
    if isinstance(event, yaml.ScalarEvent):
        quoted = event.style is not None
        return Node("scalar", _place(event), event.value, quoted, fault)
    is_mapping = isinstance(event, yaml.MappingStartEvent)
    return Node("mapping" if is_mapping else "sequence", _place(event), fault=fault)


def _place(event: yaml.Event) -> Place:
    """Where an event begins."""
    return _marked(event.start_mark)


def _marked(mark: yaml.error.Mark | CMark | None) -> Place:
    """The place of a mark, which PyYAML counts from 0."""
    return Place(mark.line + 1, mark.column + 1) if mark else Place(1, 1)


def _syntax_error(error: yaml.MarkedYAMLError) -> TreeError:
    """PyYAML's complaint as one sentence."""
    place = _marked(error.problem_mark or error.context_mark)
    problem = str(error.problem or error.context)
    if "'\\t'" in problem:
        return TreeError("a tab cannot indent YAML; use spaces", place)
    message = f"not YAML: {problem}"
    if error.context and error.context_mark:
        began = _marked(error.context_mark)
        message += f" ({error.context} that begins in line {began.line})"
    return TreeError(message, place)
