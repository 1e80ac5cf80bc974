"""The JSON schema of system files, for editors that complete and check while one types."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema, models_json_schema

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import find, kinds
from vehicledyn.files.scenario.schema import (
    DIALECT,
    Schema,
    catalogue_definitions,
    families_of,
    reachable,
    rewrite,
)
from vehicledyn.files.system.assemblies.repeat import SECTIONS
from vehicledyn.files.system.assembly_sets import ConnectedPlace
from vehicledyn.files.system.kinds import load_kinds
from vehicledyn.files.system.places import Place
from vehicledyn.files.system.sets import SystemFile

_OWN = ("cut", "constraint", "sensor", "element", "shape")
_FACTS = ("measure", "nature", "variables", "least", "above", "most", "names", "expressions",
          "no_ground", "turns_with", "is_file", "written")  # fmt: skip
_INDEX = {
    "anyOf": [{"type": "array", "items": {"type": ["integer", "string"]}}, {"type": "object"}]
}
_PLACEHOLDER = {"type": "string", "pattern": r"\{.+\}"}


class _Generator(GenerateJsonSchema):
    """Leaves expressions that are defaults out of the schema."""

    ignored_warning_kinds = {"skipped-choice", "non-serializable-default"}  # noqa: RUF012


def system_schema() -> Schema:
    """Return the JSON schema (draft 2020-12) of system files for the present catalogues."""
    load_kinds()
    sections = {family: [find(family, kind) for kind in kinds(family)] for family in _OWN}
    roots: list[type[ParameterSet]] = [SystemFile, *(e for s in sections.values() for e in s)]
    families = {**families_of(roots), **sections}
    wanted = list(dict.fromkeys([*roots, *(e for s in families.values() for e in s)]))
    references, combined = models_json_schema(
        [(entry, "validation") for entry in wanted], schema_generator=_Generator
    )
    definitions = {name: rewrite(_sections(d)) for name, d in combined["$defs"].items()}
    definitions |= catalogue_definitions(definitions, references, families)
    _allow_short_forms(definitions)
    _allow_repetition(definitions)
    definitions = {name: _with_placeholders(d) for name, d in definitions.items()}
    root = definitions.pop(SystemFile.__name__)
    return {
        "$schema": DIALECT,
        "title": "vehicledyn system",
        **{key: root[key] for key in ("description", "type", "additionalProperties")},
        "properties": root["properties"],
        "required": root["required"],
        "$defs": reachable(definitions, [root["properties"]]),
    }


def _sections(schema: Any) -> Any:
    """Return a schema with sections as mappings to kinds, and units in the descriptions."""
    if isinstance(schema, list):
        return [_sections(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    if isinstance(schema.get("section"), str):  # A field of that name holds a mapping.
        family, kind = schema["section"], schema.get("section_kind")
        inner = {"$ref": f"#/$defs/{find(family, kind).__name__ if kind else family}"}
        described = {"description": schema["description"], "type": "object"}
        return {**described, "additionalProperties": inner}
    unit = schema.get("measure")
    kept = {k: _sections(v) for k, v in schema.items() if k not in _FACTS or isinstance(v, dict)}
    if isinstance(unit, str) and unit:
        kept["description"] = f"{schema.get('description', '')} [{unit}]"
    return kept


def _with_placeholders(schema: Any) -> Any:
    """Return a schema whose choices may be left to the index of a repetition, as "{axle}"."""
    if isinstance(schema, list):
        return [_with_placeholders(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    changed = {name: _with_placeholders(item) for name, item in schema.items()}
    items = schema.get("items")
    if isinstance(items, dict) and isinstance(items.get("enum"), list):
        changed["items"] = {"anyOf": [items, _PLACEHOLDER]}
    if isinstance(schema.get("enum"), list) and "description" in schema:
        choice = {name: changed.pop(name) for name in ("enum", "type") if name in changed}
        changed["anyOf"] = [choice, _PLACEHOLDER]
    return changed


def _allow_short_forms(definitions: dict[str, Schema]) -> None:
    """Let joints and places be texts, inertias be three or six, and starts be nested."""
    joints = definitions["BodySet"]["properties"]["joints"]
    joints["items"] = {"anyOf": [{"type": "string"}, joints["items"]]}
    for holder in (SystemFile.__name__, "MirrorSet"):
        starts = definitions[holder]["properties"]["initial"]
        starts["additionalProperties"] = {"type": ["number", "string", "object"]}
    for named in (Place, ConnectedPlace):
        place = definitions[named.__name__]
        definitions[named.__name__] = {"anyOf": [{"type": "string"}, place]}


def _allow_repetition(definitions: dict[str, Schema]) -> None:
    """Add ``repeat`` to the file and its mirror groups."""
    root, group = definitions[SystemFile.__name__], definitions["MirrorSet"]
    inner = {k: v for k, v in root["properties"].items() if k in (*SECTIONS, "mirror")}
    indices = {"type": "object", "description": "Indices", "additionalProperties": _INDEX}
    repeat = {
        "description": "Groups that are made once for each value of their indices",
        "type": "array",
        "items": {"$ref": "#/$defs/repeat"},
    }
    definitions["repeat"] = {
        "type": "object",
        "description": "A group for repetition",
        "properties": {"for": indices, **inner, "repeat": repeat},
        "required": ["for"],
        "additionalProperties": False,
    }
    root["properties"]["repeat"] = repeat
    group["properties"]["repeat"] = repeat
