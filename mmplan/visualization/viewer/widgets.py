"""What viser's types do not say of its widgets."""

from __future__ import annotations

from typing import TypeVar

from viser import GuiInputHandle

T = TypeVar("T")


def set_value(widget: GuiInputHandle[T], value: T) -> None:
    """Change the value of a widget, as a person would."""
    # mypy does not see the setter of this property.
    widget.value = value  # type: ignore[misc]
