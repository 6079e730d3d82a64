"""JSON schemas of scenes and robots, by which editors complete keys and show help."""

from __future__ import annotations

from typing import Any

from mmplan import assets
from mmplan.files.robot_sections import ROBOT_VERSION, RobotSection
from mmplan.files.scene_sections import SCENE_VERSION, SceneSection
from mmplan.files.shape_sections import SHAPES

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def scene_schema() -> dict[str, Any]:
    """The JSON schema of scene files; it lists the robots that are shipped."""
    schema = SceneSection.model_json_schema()
    robot = schema["$defs"]["RobotSection"]["properties"]["model"]
    robot["anyOf"] = [{"enum": list(assets.robot_names())}, {"type": robot.pop("type")}]
    start = schema["$defs"]["StartSection"]["properties"]
    start["hand"]["anyOf"] = _examples(start["hand"].pop("oneOf"), ["open", "closed"])
    for name in ("ObstacleSection", "ObjectSection"):
        section = schema["$defs"][name]
        shapes = [s for s in SHAPES if s in section["properties"]]
        section["oneOf"] = [{"required": [s]} for s in shapes]
    return _titled(schema, f"mmplan scene, version {SCENE_VERSION}")


def robot_schema() -> dict[str, Any]:
    """The JSON schema of robot files."""
    schema = RobotSection.model_json_schema()
    body = schema["$defs"]["BodySection"]
    shapes = [key for key in body["properties"] if key != "at"]
    body["oneOf"] = [{"required": [s]} for s in shapes]
    return _titled(schema, f"mmplan robot, version {ROBOT_VERSION}")


def _titled(schema: dict[str, Any], title: str) -> dict[str, Any]:
    simplified: dict[str, Any] = _simplified(schema)
    return {"$schema": DIALECT, **simplified, "title": title}


def _examples(forms: list[dict[str, Any]], names: list[str]) -> list[dict[str, Any]]:
    return [{"enum": names}, *(f for f in forms if f.get("type") != "string")]


def _simplified(node: Any) -> Any:
    """The schema without titles, which repeat names, and without null.

    Pydantic allows null where a key may be left out; in a file it is refused, as are
    names that do not match their pattern.
    """
    if isinstance(node, list):
        return [_simplified(item) for item in node]
    if not isinstance(node, dict):
        return node
    kept = {k: v for k, v in node.items() if not _is_noise(k, v)}
    forms = [f for f in kept.get("anyOf", []) if f != {"type": "null"}]
    if len(forms) == 1:
        del kept["anyOf"]
        kept = {**forms[0], **kept}
    elif forms:
        kept["anyOf"] = forms
    if "patternProperties" in kept:
        kept["additionalProperties"] = False
    return {k: _simplified(v) for k, v in kept.items()}


def _is_noise(key: str, value: Any) -> bool:
    """A title (not a property of that name), or the default of a whole section."""
    return (key == "title" and isinstance(value, str)) or (
        key == "default" and (value is None or isinstance(value, dict))
    )
