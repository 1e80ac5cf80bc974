"""The JSON schema of study files, for editors that complete and check while one types."""

from __future__ import annotations

from pydantic.json_schema import GenerateJsonSchema, models_json_schema

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import find, kinds
from vehicledyn.files.scenario.schema import (
    DIALECT,
    Schema,
    catalogue_definitions,
    reachable,
    rewrite,
)
from vehicledyn.studies.sets import Study, StudyOutput


class _Generator(GenerateJsonSchema):
    """Leaves sets that are defaults out of the schema."""

    ignored_warning_kinds = {"skipped-choice", "non-serializable-default"}  # noqa: RUF012


def study_schema() -> Schema:
    """Return the JSON schema (draft 2020-12) of study files."""
    families: dict[str, list[type[ParameterSet]]] = {
        "cases": [find("cases", kind) for kind in kinds("cases")]
    }
    wanted: list[type[ParameterSet]] = [Study, StudyOutput, *families["cases"]]
    references, combined = models_json_schema(
        [(entry, "validation") for entry in wanted], schema_generator=_Generator
    )
    definitions = {name: rewrite(schema) for name, schema in combined["$defs"].items()}
    definitions |= catalogue_definitions(definitions, references, families)
    root = definitions.pop(Study.__name__)
    return {
        "$schema": DIALECT,
        "title": "vehicledyn study",
        **{key: root[key] for key in ("description", "type", "additionalProperties")},
        "properties": root["properties"],
        "required": root["required"],
        "$defs": reachable(definitions, [root["properties"]]),
    }
