"""Changes of scenarios and models as Python gives them, as the texts that files are changed by."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import describe

Settings = Mapping[str, Any]


def override_texts(changes: Settings | None, keywords: Settings) -> list[str]:
    """Return the changes ``key=value`` that a mapping with dotted keys and keywords ask for.

    Keywords are the fields of the scenario, or groups of the model's parameters.

    Raises
    ------
    InputError
        If a value is nothing that a file could hold.
    """
    if changes is not None and not isinstance(changes, Mapping):
        raise InputError(
            f"set: expected a mapping such as {{'solver.step': '1 ms'}}, found {describe(changes)}"
        )
    return [f"{key}={_text(key, value)}" for key, value in {**(changes or {}), **keywords}.items()]


def _text(key: str, value: Any) -> str:
    """Return a value as YAML, which JSON is."""
    try:
        return json.dumps(_plain(value), ensure_ascii=False, allow_nan=False)
    except (TypeError, ValueError):
        words = f"expected numbers, texts, lists or mappings, found {value!r:.80}"
        raise InputError(f"{key}: {words}") from None


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, PurePath):
        return str(value)
    return _plain(value.tolist()) if hasattr(value, "tolist") else value
