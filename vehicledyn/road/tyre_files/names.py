"""Coefficients that tyre property files name: section, dimension, default and meaning of each.

The list is the file ``coefficients.csv``: names and meanings of MF-Tyre 5.2, 6.1 and 6.2 and of
PAC2002. ``default`` is a number, ``required``, or ``none`` where the law does without it.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

ALIASES = {
    "LFZ0": "LFZO",
    "QRE0": "Q_RE0",
    "LMUX*": "LMUX",
    "NOM_PRES": "NOMPRES",
    "TIRE_MASS": "MASS",
    "LKXK": "LKX",
    "LKYA": "LKY",
}
"""Names that some programs write for a coefficient."""


@dataclass(frozen=True)
class Coefficient:
    """One coefficient: its section, dimension, default (a number or a word) and meaning."""

    name: str
    section: str
    dimension: str
    default: str
    meaning: str


@cache
def coefficients() -> dict[str, Coefficient]:
    """Return all coefficients by name."""
    text = files("vehicledyn.road.tyre_files").joinpath("coefficients.csv")
    rows = csv.DictReader(text.read_text(encoding="utf-8").splitlines())
    return {row["name"]: Coefficient(**row) for row in rows}
