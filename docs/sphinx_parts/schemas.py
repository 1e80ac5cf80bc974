"""Pages of the YAML files, from their JSON schemas."""

from __future__ import annotations

import re
from typing import Any

from sphinx_parts.tables import plain, table

Schema = dict[str, Any]


def pages() -> dict[str, tuple[str, str]]:
    """Return a page each for scenario, system and study files."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.files.scenario import scenario_schema
    from vehicledyn.files.system.schema import system_schema
    from vehicledyn.studies import study_schema

    made = {
        "scenario_files": ("Scenario files", "scenario", scenario_schema()),
        "system_files": ("System files", "system", system_schema()),
        "study_files": ("Study files", "study", study_schema()),
    }
    return {
        name: (_page(title, of, schema), f"every field of a {of} file.")
        for name, (title, of, schema) in made.items()
    }


def _page(title: str, of: str, schema: Schema) -> str:
    head = (
        f"# {title}\n\n{plain(schema.get('description', ''))}\n\n"
        f"The same as JSON schema, for editors: `vehicledyn schema --of {of} -o {of}.schema.json`. "
        "A quantity is a number in SI units or a text with a unit, such as `72 km/h`."
    )
    parts = [head, "## Top level", _fields(schema)]
    for name, inner in schema.get("$defs", {}).items():
        parts += [f"({_anchor(of, name)})=\n## {plain(name)}", *_definition(of, inner)]
    return "\n\n".join(part for part in parts if part).replace("#/$defs/", f"#{of}-") + "\n"


def _definition(of: str, schema: Schema) -> list[str]:
    described = plain(schema.get("description", ""))
    if "properties" in schema:
        return [described, _fields(schema)]
    return [described, f"One of: {_type(schema)}."]


def _fields(schema: Schema) -> str:
    required = schema.get("required", ())
    rows = [
        (
            f"`{name}`" + (" (required)" if name in required else ""),
            _type(field),
            _meaning(field),
        )
        for name, field in schema.get("properties", {}).items()
    ]
    return table(("field", "value", "meaning"), rows) if rows else ""


def _meaning(field: Schema) -> str:
    if field is False or not isinstance(field, dict):
        return "not allowed"
    text = str(field.get("description", ""))
    default = field.get("default")
    return text + (f" (default `{default}`)" if default not in (None, "", [], {}) else "")


def _type(field: Any) -> str:
    if not isinstance(field, dict) or not field:
        return "any"
    if "$ref" in field:
        name = field["$ref"].removeprefix("#/$defs/")
        return f"[{name}](#/$defs/{_slug(name)})"
    for key in ("anyOf", "oneOf"):
        if key in field:
            kinds = dict.fromkeys(_type(each) for each in field[key])
            return " or ".join(_without_text_of_quantities(list(kinds)))
    if "const" in field:
        return f"`{field['const']}`"
    if "enum" in field:
        return ", ".join(f"`{each}`" for each in field["enum"])
    return _typed(field)


def _typed(field: Schema) -> str:
    kind = field.get("type", "any")
    if kind == "array":
        if "prefixItems" in field:
            return "list of " + ", ".join(_type(each) for each in field["prefixItems"])
        return f"list of {_type(field.get('items'))}"
    if kind == "object":
        inner = field.get("additionalProperties")
        return f"names with {_type(inner)}" if isinstance(inner, dict) else "mapping"
    if kind == "string" and "pattern" in field:
        return (
            "text with unit" if "[+-]?" in field["pattern"] else f"text like `{field['pattern']}`"
        )
    bounds = [f"{sign} {field[key]:g}" for key, sign in _BOUNDS.items() if key in field]
    words = [_WORDS[each] for each in ([kind] if isinstance(kind, str) else kind)]
    return " ".join([" or ".join(words), " and ".join(bounds)]).strip()


_BOUNDS = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
_WORDS = {
    "number": "number",
    "integer": "whole number",
    "string": "text",
    "boolean": "true or false",
    "null": "nothing",
    "object": "mapping",
    "array": "list",
    "any": "any",
}


def _without_text_of_quantities(kinds: list[str]) -> list[str]:
    """Leave out what every quantity may be, and that a field may be absent."""
    left = [kind for kind in kinds if kind not in ("text with unit", "nothing")]
    return left or kinds


def _slug(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", name.lower())


def _anchor(of: str, name: str) -> str:
    return f"{of}-{_slug(name)}"
