"""What the sections of all files have in common: strictness, units, poses of files."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, TypeAlias, TypedDict

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

from mmplan.assets import is_file

LONGEST = 1e4  # m: nothing in a scene is farther or larger
FULL_TURN = 2 * math.pi + 0.01  # rad, with room for rounding
_NAME = r"^[A-Za-z][A-Za-z0-9_-]*$"
_LINE = r"^[^\r\n]+$"
PATTERNS = {
    _NAME: "a name (a letter, then letters, digits, _ or -)",
    _LINE: "one line of text",
}


class Section(BaseModel):
    """A mapping of a file: strict types, no keys but those listed."""

    model_config = ConfigDict(
        extra="forbid",
        strict=True,
        frozen=True,
        defer_build=True,  # all sections at once, which is quicker
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )


def fault(message: str) -> PydanticCustomError:
    """A fault whose message reaches the user as it stands."""
    return PydanticCustomError("fault", "{message}", {"message": message})


def fault_at(path: tuple[str | int, ...], message: str) -> ValidationError:
    """A fault of what stands at `path` in the mapping that is being validated."""
    detail = InitErrorDetails(type=fault(message), loc=path, input=None)
    return ValidationError.from_exception_data("fault", [detail])


class UnionMessages(TypedDict):
    """Arguments of `pydantic.Discriminator` for a value that fits no alternative."""

    custom_error_type: str
    custom_error_message: str


def messages(message: str) -> UnionMessages:
    """The message of a union for a value that fits no alternative."""
    return {"custom_error_type": "fault", "custom_error_message": message}


def _in_metres(value: float) -> float:
    if abs(value) > LONGEST:
        raise fault(
            f"{value:g} m is out of range: lengths are in metres, "
            f"at most {LONGEST:,.0f} m"
        )
    return value


def _in_radians(value: float) -> float:
    if abs(value) > FULL_TURN:
        raise fault(
            f"{value:g} rad is more than a full turn: angles are in radians; "
            f"{value:g} degrees are {math.radians(value):.5g} rad"
        )
    return value


def _above_zero(value: float) -> float:
    if value <= 0:
        raise fault(f"must be greater than 0, got {value:g}")
    return value


def _not_negative(value: float) -> float:
    if value < 0:
        raise fault(f"must not be negative, got {value:g}")
    return value


def _schema(**limits: float) -> Any:
    return Field(json_schema_extra=dict(limits))


def version(format_name: str, supported: int) -> BeforeValidator:
    """Accepts the one version of a format that is read."""

    def check(value: object) -> object:
        if value == supported and type(value) is int:
            return value
        raise fault(
            f"this mmplan reads version {supported} of the {format_name} format, "
            f"got {value!r}"
        )

    return BeforeValidator(check)


def _existing_file(value: str, info: ValidationInfo) -> str:
    """The path as written, once a file is found there (`folder` in the context)."""
    folder = (info.context or {}).get("folder")
    if folder is None:
        return value
    if "://" in value:
        raise fault(f"'{value}' is an address; download it and name the file")
    path = Path(folder) / value
    if not is_file(path):
        raise fault(f"no such file: '{value}', sought at {path}")
    return value


def _interval(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise fault(f"expected [lower, upper], got {value[0]:g} above {value[1]:g}")
    return value


Name: TypeAlias = Annotated[str, Field(pattern=_NAME, max_length=100)]
Line: TypeAlias = Annotated[str, Field(pattern=_LINE, max_length=200)]
Metres: TypeAlias = Annotated[
    float, AfterValidator(_in_metres), _schema(minimum=-LONGEST, maximum=LONGEST)
]
Size: TypeAlias = Annotated[
    float,
    AfterValidator(_above_zero),
    AfterValidator(_in_metres),
    _schema(exclusiveMinimum=0, maximum=LONGEST),
]
Distance: TypeAlias = Annotated[
    float,
    AfterValidator(_not_negative),
    AfterValidator(_in_metres),
    _schema(minimum=0, maximum=LONGEST),
]
Radians: TypeAlias = Annotated[
    float, AfterValidator(_in_radians), _schema(minimum=-FULL_TURN, maximum=FULL_TURN)
]
Positive: TypeAlias = Annotated[
    float, AfterValidator(_above_zero), _schema(exclusiveMinimum=0)
]
FileName: TypeAlias = Annotated[str, AfterValidator(_existing_file)]
Interval: TypeAlias = Annotated[tuple[Metres, Metres], AfterValidator(_interval)]
JointInterval: TypeAlias = Annotated[tuple[float, float], AfterValidator(_interval)]
