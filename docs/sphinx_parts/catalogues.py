"""Page of the catalogues, from the registries: every part that a file may name."""

from __future__ import annotations

from typing import Any

from sphinx_parts.docstrings import render
from sphinx_parts.schemas import _meaning, _type
from sphinx_parts.tables import table

TITLES = {
    "solver": ("Solvers", "Methods of integration: `solver` of a scenario."),
    "tyre": ("Tyres", "Tyre laws: `tyres` of a scenario, `law` of a wheel in a system file."),
    "relaxation": ("Relaxation of tyres", "How slip follows its steady value."),
    "road": ("Roads", "Surfaces: `road` of a scenario."),
    "creep": ("Creep laws", "Tangential forces between wheel and rail."),
    "rail_contact": ("Contact of wheels and rails", "How wheels touch rails: `rail_contact`."),
    "track": ("Tracks", "Railway tracks: `track` of a scenario."),
    "segment": ("Segments of tracks", "What a track is laid out of."),
    "irregularity": ("Irregularities of tracks", "Deviations of the rails from their places."),
    "manoeuvre": ("Manoeuvres", "What a vehicle does: `manoeuvre` of a scenario."),
    "driver": ("Drivers", "Who steers in a manoeuvre."),
    "joint": ("Joints", "How a body hangs on its parent in a system file."),
    "cut": ("Cuts", "How loops are closed in a system file."),
    "constraint": ("Constraints", "Further conditions in a system file."),
    "element": ("Elements", "What acts on bodies and coordinates: `elements` of a system file."),
    "force_law": ("Force laws", "Laws of links and of coordinates in a system file."),
    "time_law": ("Time laws", "Laws of drives in a system file."),
    "cases": ("Cases of studies", "Which cases a study runs: `cases` of a study."),
    "sensor": ("Sensors", "What a system file shows beyond its coordinates."),
    "shape": ("Shapes", "What bodies of a system file look like in animations and pictures."),
}
_LEFT_OUT = ("model", "model_file", "joint_type", "element_type", "sensor_type", "constraint_type")


def pages() -> dict[str, tuple[str, str]]:
    """Return a page for each catalogue."""
    import vehicledyn.catalogue
    from vehicledyn.base.registry import families, kinds

    vehicledyn.catalogue.counts()
    found = [family for family in families() if family not in _LEFT_OUT]
    order = [f for f in TITLES if f in found] + [f for f in found if f not in TITLES]
    return {f"catalogue_{f}": (_page(f, kinds(f)), _told(f, kinds(f))) for f in order}


def _title(family: str) -> tuple[str, str]:
    named = family.replace("_", " ").capitalize()
    return TITLES.get(family, (f"Catalogue: {named}", f"Entries of the family `{family}`."))


def _told(family: str, names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names) + "."


def _page(family: str, names: tuple[str, ...]) -> str:
    from vehicledyn.base.registry import find

    title, note = _title(family)
    parts = [f"# {title}\n\n{note}"]
    for name in names:
        entry = find(family, name)
        parts += [f"## {name}", _docstring(entry), _fields(entry)]
    return "\n\n".join(part for part in parts if part) + "\n"


def _docstring(entry: type[Any]) -> str:
    import inspect

    text = inspect.cleandoc(entry.__doc__ or "")
    return "```{eval-rst}\n" + render(text).rstrip() + "\n```" if text else ""


def _fields(entry: type[Any]) -> str:
    fields = getattr(entry, "model_fields", {})
    if not fields:
        return ""
    schema = entry.model_json_schema(mode="validation", ref_template="{model}")
    required = schema.get("required", ())
    rows = []
    for name, field in schema.get("properties", {}).items():
        unit = field.get("unit", "")
        family = field.get("family")
        value = f"a {family.replace('_', ' ')}" if family else _value(field)
        label = f"`{name}`" + ("" if name in required else " (optional)")
        rows.append((label, unit if isinstance(unit, str) else "", value, _meaning(field)))
    return table(("field", "unit", "value", "meaning"), rows)


def _value(field: dict[str, Any]) -> str:
    return "text, number or mapping" if "$ref" in str(field) else _type(field)
