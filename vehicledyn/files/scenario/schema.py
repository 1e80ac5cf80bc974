"""The JSON schema of scenario files, for editors that complete and check while one types."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic.json_schema import models_json_schema

from vehicledyn.base.parameters import ParameterSet, field_family
from vehicledyn.base.registry import find, kinds
from vehicledyn.base.units import is_pure
from vehicledyn.files.scenario.model_names import known_models
from vehicledyn.files.scenario.partial import partial_definitions
from vehicledyn.files.scenario.sets import Scenario, Tyres
from vehicledyn.files.scenario.system_models import needs_of

Schema = dict[str, Any]

DIALECT = "https://json-schema.org/draft/2020-12/schema"
FILE_NAME = r"\.[yY][aA]?[mM][lL]$"
"""Pattern of the names of system files."""

_NUMBER = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*$"
_ZERO = r"[+-]?(0+\.?0*|\.0+)\s*$"
_NEEDS_UNIT = rf"^\s*(?={_ZERO}|(?!{_NUMBER}))"
"""Begins the pattern of quantities that have a dimension: zero, or no number alone."""

_NUMBER_WITH_UNIT = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?(\s*[^\s\d.].*)?\s*$"


def scenario_schema() -> Schema:
    """Return the JSON schema (draft 2020-12) of scenario files for the present catalogues.

    A part is one of its family's kinds, a quantity a number in SI or a text with a unit, and
    the parameters are those of the model that the file names.
    """
    families = _families()
    models = {name: find("model", name).parameter_class for name in kinds("model")}
    definitions = _definitions(families, models)
    root = definitions.pop(Scenario.__name__)
    properties = root["properties"]
    named = [{"enum": list(known_models())}, {"type": "string", "pattern": FILE_NAME}]
    properties["model"] = {"description": properties["model"]["description"], "anyOf": named}
    properties["tyres"] = _tyre_choice(properties["tyres"]["description"])
    properties["parameters"] = {"description": properties["parameters"]["description"]}
    choices = []
    for name, parameters in models.items():
        reference, changes = partial_definitions(parameters.__name__, definitions, f"{name}.")
        definitions |= changes
        choices.append(_when_model(name, reference))
    return {
        "$schema": DIALECT,
        "title": "vehicledyn scenario",
        **{key: root[key] for key in ("description", "type", "additionalProperties")},
        "properties": properties,
        "required": root["required"],
        "allOf": choices,
        "$defs": reachable(definitions, [properties, choices]),
    }


def _families() -> dict[str, list[type[ParameterSet]]]:
    """Return every catalogue that a scenario reaches, with its sets."""
    models = [find("model", name).parameter_class for name in kinds("model")]
    return families_of([Scenario, Tyres, *models])


def families_of(roots: Sequence[type[ParameterSet]]) -> dict[str, list[type[ParameterSet]]]:
    """Return every catalogue that some sets reach through their parts, with its sets."""
    families: dict[str, list[type[ParameterSet]]] = {}
    waiting = list(roots)
    seen: set[type[ParameterSet]] = set()
    while waiting:
        parameters = waiting.pop()
        if parameters in seen:
            continue
        seen.add(parameters)
        waiting += _inner_sets(parameters)
        for name in parameters.model_fields:
            family = field_family(parameters, name)
            if family is not None and family not in families:
                families[family] = [find(family, kind) for kind in kinds(family)]
                waiting += families[family]
    return families


def _inner_sets(annotated: Any) -> list[type[ParameterSet]]:
    """Return the sets in the fields' annotations of a set, or in an annotation."""
    if isinstance(annotated, type) and issubclass(annotated, ParameterSet):
        annotations = [field.annotation for field in annotated.model_fields.values()]
    else:
        annotations = list(getattr(annotated, "__args__", ()))
    found: list[type[ParameterSet]] = []
    for annotation in annotations:
        if isinstance(annotation, type) and issubclass(annotation, ParameterSet):
            found.append(annotation)
        else:
            found += _inner_sets(annotation)
    return found


def _definitions(
    families: dict[str, list[type[ParameterSet]]], models: dict[str, type[ParameterSet]]
) -> dict[str, Schema]:
    """Return the definitions of all sets, and of each part with its ``kind`` as family.kind."""
    sets = [entry for entries in families.values() for entry in entries]
    wanted: list[type[ParameterSet]] = [Scenario, Tyres, *sets, *models.values()]
    references, combined = models_json_schema([(entry, "validation") for entry in wanted])
    definitions: dict[str, Schema] = combined["$defs"]
    definitions = {name: rewrite(item, bare=False) for name, item in definitions.items()}
    return definitions | catalogue_definitions(definitions, references, families)


def catalogue_definitions(
    definitions: dict[str, Schema],
    references: Mapping[Any, Schema],
    families: dict[str, list[type[ParameterSet]]],
) -> dict[str, Schema]:
    """Return the definitions of each part with its ``kind`` as family.kind, and of families.

    Parameters
    ----------
    definitions
        Definitions of all sets by name.
    references
        Reference to each set's definition, as pydantic gives them.
    families
        Sets of each family.
    """
    made: dict[str, Schema] = {}
    for family, entries in families.items():
        for entry in entries:
            name = references[entry, "validation"]["$ref"].rpartition("/")[2]
            made[f"{family}.{entry.kind}"] = _with_kind(definitions[name], entry.kind)
            if getattr(entry, "versions", ()):  # a file tells its kind
                made[f"{family}.of_file"] = definitions[name]
        choices = [{"$ref": f"#/$defs/{name}"} for name in made if name.startswith(f"{family}.")]
        made[family] = {"oneOf": choices} if choices else {"not": {}}
    return made


def _with_kind(schema: Schema, kind: str) -> Schema:
    properties = {"kind": {"const": kind}, **schema.get("properties", {})}
    required = ["kind", *schema.get("required", [])]
    return {**schema, "properties": properties, "required": required}


def _tyre_choice(description: str) -> Schema:
    choices = [{"$ref": "#/$defs/tyre"}, {"$ref": f"#/$defs/{Tyres.__name__}"}, {"type": "null"}]
    return {"description": description, "anyOf": choices}


def _when_model(name: str, reference: Schema) -> Schema:
    chosen = {"properties": {"model": {"const": name}}, "required": ["model"]}
    changes = {
        "properties": {"parameters": {"anyOf": [reference, {"type": "null"}]}, "initial": False},
        "required": ["manoeuvre", "speed", *needs_of(name)],
    }
    return {"if": chosen, "then": changes}


def rewrite(schema: Any, *, bare: bool = True) -> Any:
    """Return a schema with quantities and parts as files write them, at any depth.

    ``bare`` says whether numbers without a unit are in SI; else only zero may stand alone.
    """
    if isinstance(schema, list):
        return [rewrite(item, bare=bare) for item in schema]
    if not isinstance(schema, dict):
        return schema
    if "unit" in schema:
        return _quantity(schema, bare=bare or is_pure(schema["unit"]))
    if "family" in schema:
        return _part(schema)
    rewritten = {k: rewrite(item, bare=bare) for k, item in schema.items() if k != "title"}
    if "properties" in schema:
        inner = schema["properties"].items()
        rewritten["properties"] = {name: rewrite(item, bare=bare) for name, item in inner}
    return rewritten


def _quantity(schema: Schema, *, bare: bool) -> Schema:
    described = f"{schema.get('description', '')} [{schema['unit']}]".strip()
    kept = {k: v for k, v in schema.items() if k not in ("unit", "title", "description")}
    return {"description": described, **_accept_text(kept, bare=bare)}


def _accept_text(schema: Any, *, bare: bool) -> Any:
    if isinstance(schema, list):
        return [_accept_text(item, bare=bare) for item in schema]
    if not isinstance(schema, dict):
        return schema
    if schema.get("type") == "number":
        outer = {key: schema[key] for key in ("default",) if key in schema}
        number = {key: item for key, item in schema.items() if key != "default"}
        pattern = _NUMBER_WITH_UNIT
        if not bare:
            number, pattern = {**number, "const": 0}, _NEEDS_UNIT + pattern[1:]
        return {**outer, "anyOf": [number, {"type": "string", "pattern": pattern}]}
    return {key: _accept_text(item, bare=bare) for key, item in schema.items()}


def _part(schema: Schema) -> Schema:
    """Return the reference to a family in place of the reference to any set."""
    reference = {"$ref": f"#/$defs/{schema['family']}"}
    kept: Schema = {key: schema[key] for key in ("description", "default") if key in schema}
    if schema.get("type") == "array":
        return {**kept, "type": "array", "items": reference}
    choices = schema.get("anyOf", [])
    if {"type": "null"} in choices:
        is_list = any(choice.get("type") == "array" for choice in choices)
        some = {"type": "array", "items": reference} if is_list else reference
        return {**kept, "anyOf": [some, {"type": "null"}]}
    return {**kept, **reference}


def reachable(definitions: dict[str, Schema], roots: Any) -> dict[str, Schema]:
    """Return the definitions that are used, directly or by others."""
    used: dict[str, Schema] = {}
    waiting = _references(roots)
    while waiting:
        name = waiting.pop()
        if name not in used:
            used[name] = definitions[name]
            waiting += _references(definitions[name])
    return dict(sorted(used.items()))


def _references(schema: Any) -> list[str]:
    if isinstance(schema, list):
        return [name for item in schema for name in _references(item)]
    if not isinstance(schema, dict):
        return []
    own = schema.get("$ref")
    names = [own.removeprefix("#/$defs/")] if isinstance(own, str) else []
    return names + [name for item in schema.values() for name in _references(item)]
