"""Which catalogue parts a scenario uses, what they do and which sources they follow."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from typing import Any

from vehicledyn.base.nested import leaves
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.files.scenario.target import Target

_REFERENCES = re.compile(r"^References\n-+\n(.*?)(?=\n\n\S|\Z)", re.MULTILINE | re.DOTALL)
_SOURCE = re.compile(r"^#\s*source:\s*(.*(?:\n#\s{3,}.*)*)", re.MULTILINE | re.IGNORECASE)
_COMMENT = re.compile(r"(?:#.*\n)+")
_SCHEMA_LINE = re.compile(r"^#\s*yaml-language-server:.*\n", re.MULTILINE)
_ROLE = re.compile(r":\w+:`~?([^`]*)`")
ELEMENTARY = ("T1", "T2", "T3", "R1", "R2", "R3")
"""Joints that need no explanation."""


def sources_of(loaded: LoadedScenario) -> list[dict[str, str]]:
    """Return the parts a scenario uses, each once: "part", what it "does", and its "source".

    The source is the section "References" of the part's description or of its module, or what
    the file of its parameters names; it is empty where there is none.
    """
    written, name = loaded.written, loaded.scenario.model
    used: dict[tuple[str, str], type[Any]] = {}
    found: list[dict[str, str]] = []
    roots: list[ParameterSet] = [loaded.scenario]
    if written.file is not None:
        roots.append(written.file)
        found.append(_record("model", name, written.title, _source_of_file(written.text)))
    for entry in written.classes:
        used["model", name] = entry
    for root in roots:
        for part in _parts(root):
            if not (part.family == "joint" and part.kind in ELEMENTARY):
                used.setdefault((part.family, part.kind), type(part))
    for (family, kind), entry in used.items():
        does = inspect.cleandoc(entry.__doc__ or "").partition("\n")[0]
        found.append(_record(family, kind, _ROLE.sub(r"\1", does), _source(entry)))
    return found


def laws_that_bend(target: Target) -> list[str]:
    """Return the laws of a target whose forces are not linear in small motions, and why."""
    written = target.written
    scenario = target.choices
    roots: list[ParameterSet] = [] if scenario is None else [scenario]
    if written.file is not None and (scenario is None or scenario.creep is None):
        roots.append(written.file)
    found = [
        f"{part.family} '{part.kind}': {part.bends_at_rest}"
        for root in roots
        for part in _parts(root)
        if getattr(part, "bends_at_rest", "")
    ]
    return list(dict.fromkeys(found))


def _record(family: str, kind: str, does: str, source: str) -> dict[str, str]:
    return {"part": f"{family.replace('_', ' ')} {kind}", "does": does, "source": source}


def _parts(value: Any) -> Iterator[Any]:
    """Yield the parts of catalogues in a value, from whole to part."""
    for item in leaves(value):
        if not isinstance(item, ParameterSet):
            continue
        if getattr(item, "family", "") and getattr(item, "kind", ""):
            yield item
        for name in type(item).model_fields:
            yield from _parts(getattr(item, name))


def _source(entry: type[Any]) -> str:
    module = sys.modules[entry.__module__]
    for text in (entry.__doc__, module.__doc__):
        found = _REFERENCES.search(inspect.cleandoc(text or ""))
        if found:
            return " ".join(found[1].split())
    file = getattr(entry, "parameter_file", None)
    return "" if file is None else _source_of_file(file.read_text(encoding="utf-8"))


def _source_of_file(text: str) -> str:
    """Return what the comment a file begins with names as its source, or else says at all."""
    comment = _COMMENT.match(text)
    if comment is None:
        return ""
    named = _SOURCE.search(comment[0])
    citation = named[1] if named else _SCHEMA_LINE.sub("", comment[0])
    return " ".join(citation.replace("#", " ").split())
