"""A standing car stays where it is."""

from __future__ import annotations

import numpy as np

from reference_cases.comparison import Group, deviation
from reference_cases.motions import drive, drive_text

FLAT = """title: Iltis standing on a flat road with steady slip
model: iltis
tyres: {kind: magic_formula_1987}
road: {kind: flat}
wheel_spin: free
speed: 0 m/s
start: static
manoeuvre: {kind: straight}
duration: 5 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
BAND = 1e-6  # m, in the last second: under a tenth of a millimetre a minute


def drift(run):
    """Return how far the chassis moves in the last second [m]."""
    late = run.time >= run.time[-1] - 1.0
    return max(np.ptp(run[f"chassis.{k}"][late]) for k in "xyz")


def compare():
    """Return the comparisons."""
    cases = {
        "flat road, steady slip, free wheels": drive_text(FLAT),
        "slope of 5 % and 10 %, transient slip, locked wheels": drive("iltis_standstill"),
    }
    rows = [
        deviation(
            "standstill",
            f"{words}: motion of the chassis in the last second",
            reference="0 m",
            largest=drift(run),
            band=BAND,
            unit="m",
        )
        for words, run in cases.items()
    ]
    return Group("Iltis: standing still", "Band: 0.06 mm a minute.", tuple(rows))
