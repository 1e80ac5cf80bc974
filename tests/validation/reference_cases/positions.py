"""Nominal position and static equilibrium of the Iltis against published figures."""

from __future__ import annotations

import math

from reference_cases.comparison import Group, figure
from reference_cases.motions import quiet
from reference_cases.tables import read_figures
from vehicledyn.analyses import find_equilibrium
from vehicledyn.files.scenario import load_model

FACTORS = {"N": 1.0, "mm": 1000.0, "deg": 180.0 / math.pi}


def compare(*overrides):
    """Return the comparisons; ``overrides`` change the model."""
    published = read_figures("iltis_positions.yaml")
    report = find_equilibrium(
        load_model("iltis", overrides), speed=None, backend="auto", progress=quiet
    )
    rows = {row.name: row for row in (*report.forces, *report.coordinates)}
    found = []
    for position in ("nominal", "equilibrium"):
        for item in published[position]["values"]:
            row = rows[item["channel"]]
            value = getattr(row, position) - (row.nominal if item.get("is_change") else 0.0)
            found.append(
                figure(
                    published[position]["source"],
                    f"{item['name']}, {position}",
                    reference=item["value"],
                    computed=item.get("sign", 1) * FACTORS[item["unit"]] * value,
                    band=item["band"],
                    unit=item["unit"],
                    digits=item["digits"],
                )
            )
    note = "Bands: as asked of the program; the published figures have one to three decimals."
    return Group("Iltis: nominal position and static equilibrium", note, tuple(found))
