"""Notes on what two compared runs do not share: model, equations, parameters, settings."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import shown
from vehicledyn.results.compare.comparison import LISTED
from vehicledyn.results.store.reader import Result

_TOLD_ELSEWHERE = ("title", "description", "model", "parameters", "overrides")
_LONGEST_VALUE = 40  # characters of a value in a note


def setting_notes(result: Result, reference: Result) -> list[str]:
    """Return by what two runs differ before they begin, one sentence each."""
    notes = []
    if result.model != reference.model:
        notes.append(f"model is {result.model}, in the reference {reference.model}")
    elif result.model_hash != reference.model_hash:
        notes.append(_other_model(result, reference))
    settings = _other_settings(result, reference)
    return [*notes, settings] if settings else notes


def _other_model(result: Result, reference: Result) -> str:
    """Return by what a model of the same name differs, its equations or parameters."""
    (ours, values), (theirs, wanted) = result.equations, reference.equations
    if not (ours and theirs):
        return f"model {result.model} has other equations or parameters than in the reference"
    if ours != theirs:
        return f"model {result.model} has other equations than in the reference"
    changed = [name for name in wanted if values.get(name) != wanted[name]]
    listed = ", ".join(
        f"{name} = {shown(*values[name])} (reference {shown(*wanted[name])})"
        for name in changed[:LISTED]
        if name in values
    )
    more = f" and {len(changed) - LISTED} more" if len(changed) > LISTED else ""
    return f"model {result.model} has other parameters than in the reference: {listed}{more}"


def _other_settings(result: Result, reference: Result) -> str:
    """Return what the scenarios or the models' files set differently, in SI; empty if nothing."""
    try:
        ours, theirs = (dict(_leaves(file.configuration)) for file in (result, reference))
    except InputError:  # files of versions that kept no configuration
        return ""
    changed = [key for key in {**theirs, **ours} if ours.get(key) != theirs.get(key)]
    pairs = [(key, *_apart(ours.get(key), theirs.get(key))) for key in changed[:LISTED]]
    listed = ", ".join(f"{key} = {_short(a)} (reference {_short(b)})" for key, a, b in pairs)
    more = f" and {len(changed) - LISTED} more" if len(changed) > LISTED else ""
    return f"set differently, in SI: {listed}{more}" if changed else ""


def _leaves(settings: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the values of nested mappings and lists by their keys, joined by dots."""
    if isinstance(settings, dict | list) and settings:
        items = settings.items() if isinstance(settings, dict) else enumerate(settings)
        for key, value in items:
            if place or key not in _TOLD_ELSEWHERE:
                yield from _leaves(value, f"{place}.{key}" if place else str(key))
    else:
        yield place, settings


def _apart(ours: Any, theirs: Any) -> tuple[Any, Any]:
    """Return two values, of texts of several lines the first lines that differ."""
    if not (isinstance(ours, str) and isinstance(theirs, str) and "\n" in ours + theirs):
        return ours, theirs
    lines = zip_longest(ours.splitlines(), theirs.splitlines(), fillvalue="")
    return next(((a.strip(), b.strip()) for a, b in lines if a != b), (ours, theirs))


def _short(value: Any) -> str:
    text = "nothing" if value in (None, "", {}, []) else str(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 1]}…"
