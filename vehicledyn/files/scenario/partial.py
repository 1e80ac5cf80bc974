"""Schemas of changes: any part of a set may be given, a vector also by its components."""

from __future__ import annotations

from typing import Any

Schema = dict[str, Any]
_PREFIX = "#/$defs/"
_VECTOR_SIZE = 3


def partial_definitions(
    name: str, definitions: dict[str, Schema], prefix: str
) -> tuple[Schema, dict[str, Schema]]:
    """Return the schema of changes of a set and the definitions it needs.

    Parameters
    ----------
    name
        Name of the set's definition.
    definitions
        Complete definitions by name.
    prefix
        Put before the names of the new definitions.

    Returns
    -------
    dict
        Reference to the set's new definition.
    dict
        New definitions, in which nothing is required.
    """
    made: dict[str, Schema] = {}
    waiting = [name]
    while waiting:
        current = waiting.pop()
        if prefix + current not in made:
            made[prefix + current] = _relax(definitions[current], prefix, waiting)
    return {"$ref": _PREFIX + prefix + name}, made


def _relax(schema: Any, prefix: str, waiting: list[str]) -> Any:
    if isinstance(schema, list):
        return [_relax(item, prefix, waiting) for item in schema]
    if not isinstance(schema, dict):
        return schema
    relaxed = {
        key: _relax(item, prefix, waiting) for key, item in schema.items() if key != "required"
    }
    if "properties" in schema:
        inner = schema["properties"].items()
        relaxed["properties"] = {name: _relax(item, prefix, waiting) for name, item in inner}
    reference = schema.get("$ref")
    if isinstance(reference, str):
        waiting.append(reference.removeprefix(_PREFIX))
        relaxed["$ref"] = _PREFIX + prefix + reference.removeprefix(_PREFIX)
    if "oneOf" in relaxed:
        relaxed["anyOf"] = relaxed.pop("oneOf")
    items = relaxed.get("prefixItems")
    return relaxed if items is None or len(items) > _VECTOR_SIZE else _or_components(relaxed, items)


def _or_components(vector: Schema, items: list[Schema]) -> Schema:
    kept: Schema = {key: vector.pop(key) for key in ("description", "default") if key in vector}
    components = {
        "type": "object",
        "properties": dict(zip(("x", "y", "z"), items, strict=False)),
        "additionalProperties": False,
    }
    return {**kept, "anyOf": [vector, components]}
