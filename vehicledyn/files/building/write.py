"""Write systems back as system files."""

from __future__ import annotations

import io
from typing import Any

from ruamel.yaml import YAML

from vehicledyn.base.parameters import ParameterSet, as_plain
from vehicledyn.base.schema_line import schema_line, schema_name
from vehicledyn.files.expressions.expressions import Expression
from vehicledyn.files.expressions.fields import SystemSet, fact
from vehicledyn.files.expressions.parameters import Parameters
from vehicledyn.files.system.read import SystemModel

SCHEMA_LINE = schema_line(schema_name("system"))
_WIDTH = 100


def model_as_yaml(model: SystemModel) -> str:
    """Return a system file that makes the same equations, its groups and images written out."""
    plain = _set(model.file)
    parameters = _parameters(model.parameters)
    head: dict[str, Any] = {key: plain.pop(key) for key in ("title", "description") if key in plain}
    plain.pop("parameters", None)
    data = {**head, **({"parameters": parameters} if parameters else {}), **plain}
    return SCHEMA_LINE + dump(data)


def dump(data: dict[str, Any]) -> str:
    """Return plain data as YAML text, lists and innermost mappings in one line."""
    writer = YAML()
    writer.default_flow_style = None
    writer.width = _WIDTH
    stream = io.StringIO()
    writer.dump(data, stream)
    return stream.getvalue()


def _set(item: ParameterSet) -> dict[str, Any]:
    """Return a set as plain data, without what the file need not say."""
    if not isinstance(item, SystemSet):
        plain: dict[str, Any] = as_plain(item)
        return {key: value for key, value in plain.items() if value is not None}
    fields = type(item).model_fields
    given = {
        name: getattr(item, name)
        for name, field in fields.items()
        if field.is_required()
        or getattr(item, name) != field.get_default(call_default_factory=True)
    }
    head = {"kind": item.kind} if item.kind else {}
    written = {name: _value(value) for name, value in given.items()}
    for name, value in written.items():
        for entry in value.values() if fact(type(item), name, "section_kind") else ():
            del entry["kind"]
    return head | written


def _value(value: Any) -> Any:
    if isinstance(value, Expression):
        return value.plain
    if isinstance(value, ParameterSet):
        return _set(value)
    if isinstance(value, dict):
        return {name: _value(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_value(item) for item in value]
    return value


def _parameters(parameters: Parameters) -> dict[str, Any]:
    """Return all parameters, nested as their dotted names say."""
    nested: dict[str, Any] = {}
    for entry in parameters.entries:
        *groups, name = entry.name.split(".")
        holder = nested
        for group in groups:
            holder = holder.setdefault(group, {})
        usual = name.replace("_", " ").capitalize()
        value = entry.expression.plain
        long = {"value": value, "description": entry.description}
        holder[name] = value if entry.description == usual else long
    return nested
