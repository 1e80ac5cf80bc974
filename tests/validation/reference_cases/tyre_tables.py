"""Tyre laws against tables computed from the published coefficients."""

from __future__ import annotations

from reference_cases.comparison import Group, deviation
from reference_cases.tables import read_rows
from vehicledyn.road.tyres import magic_formula
from vehicledyn.road.tyres.magic_formula_1987 import MagicFormula1987

UNITS = {
    "Fx": ("longitudinal force", "N"),
    "Fy": ("lateral force", "N"),
    "Mz": ("aligning moment", "N m"),
}


def rows(quantity):
    """Return load [kN], slip [% or deg], camber [deg] and value of a quantity's rows."""
    return [
        tuple(float(row[k]) for k in ("Fz_kN", "x", "gamma_deg", "value"))
        for row in read_rows("magic_formula_1987.csv")
        if row["quantity"] == quantity
    ]


def curve(quantity, load, x, camber):
    """Return a curve of the standard tyre, in the signs of the paper."""
    tyre = MagicFormula1987()
    if quantity == "Fx":
        return magic_formula.longitudinal_force(load, x, tyre.longitudinal)
    if quantity == "Fy":
        return magic_formula.lateral_force(load, x, camber, tyre.lateral)
    return magic_formula.aligning_moment(load, x, camber, tyre.aligning)


def compare():
    """Return the comparisons, over all rows of the table."""
    found = []
    for quantity, (words, unit) in UNITS.items():
        table = rows(quantity)
        values = [value for *_, value in table]
        found.append(
            deviation(
                "Bakker, Nyborg, Pacejka 1987",
                words,
                reference=f"{len(table)} points, {min(values):.6g} ... {max(values):.6g} {unit}",
                largest=max(abs(float(curve(quantity, *row[:3])) - row[3]) for row in table),
                band=1e-3,
                unit=unit,
            )
        )
    return Group("Road: Magic Formula of 1987", "Band: as asked of the program.", tuple(found))
