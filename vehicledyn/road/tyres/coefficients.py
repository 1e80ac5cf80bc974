"""Named coefficient sets of published tyres, data files beside the tyre laws."""

from __future__ import annotations

from importlib.resources import files
from typing import Any


def read_coefficients(name: str) -> dict[str, Any]:
    """Return the coefficients in the data file ``road/tyres/<name>.yaml``, texts with units."""
    from ruamel.yaml import YAML

    text = files("vehicledyn.road.tyres").joinpath(f"{name}.yaml").read_text(encoding="utf-8")
    coefficients: dict[str, Any] = YAML(typ="safe", pure=True).load(text)
    return coefficients
