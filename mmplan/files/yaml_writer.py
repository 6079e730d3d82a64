"""Plain data as YAML text that looks written by hand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias, Union

import yaml

from mmplan.files.yaml_scalars import Scalar, parse_scalar

Plain: TypeAlias = Union[
    str, int, float, bool, "Sequence[Plain]", "Mapping[str, Plain]"
]

_WIDTH = 96  # of what stands in one line, about
_INDENT = 2


def yaml_text(data: Mapping[str, Plain], comment: str = "") -> str:
    """The data as a document: what fits into one line stands in one line.

    Keys keep their order, and the same data give the same text. Each line of
    `comment` becomes one at the head.
    """
    representer = yaml.representer.SafeRepresenter(sort_keys=False)
    root = representer.represent_data(dict(data))
    _lay_out(root, depth=0)
    body = yaml.serialize(root, Dumper=yaml.SafeDumper, width=1000, allow_unicode=True)
    head = "".join(f"# {line}".rstrip() + "\n" for line in comment.splitlines())
    return f"{head}{body}"


def _lay_out(node: yaml.Node, depth: int) -> None:
    """Choose the lines of a node and all below it; sections have an item a line."""
    if isinstance(node, yaml.ScalarNode):
        _quote(node)
    if isinstance(node, yaml.CollectionNode):
        node.flow_style = depth > 1 and depth * _INDENT + _width(node) <= _WIDTH
        for child in _children(node):
            _lay_out(child, depth + 1)


def _quote(node: yaml.ScalarNode) -> None:
    """Put text into quotes that would be read as something else."""
    is_text = node.tag == "tag:yaml.org,2002:str"
    if is_text and parse_scalar(node.value) != Scalar(node.value):
        node.style = "'"


def _width(node: yaml.Node) -> int:
    """The number of characters of a node in one line, about."""
    if isinstance(node, yaml.ScalarNode):
        return len(node.value)
    if isinstance(node, yaml.MappingNode):
        return 2 + sum(_width(k) + _width(v) + 4 for k, v in node.value)
    return 2 + sum(_width(child) + 2 for child in node.value)


def _children(node: yaml.CollectionNode) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        return [value for _, value in node.value]
    return list(node.value)
