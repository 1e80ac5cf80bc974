"""Hertz's contact, Kalker's coefficients and creep laws against tables and exact solutions."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

import vehicledyn.rail.creep  # noqa: F401
from reference_cases.comparison import Group, deviation
from reference_cases.no_slip import no_slip_coefficients
from reference_cases.tables import read_rows
from vehicledyn.base.registry import find
from vehicledyn.rail.creep.creep_law import CreepContact
from vehicledyn.rail.creep.kalker import creep_coefficients
from vehicledyn.rail.geometry.hertz import ContactEllipse
from vehicledyn.rail.geometry.hertz_shape import ellipse_shape

SOURCES = {
    1.0: "exact elliptic contact of half-spaces",
    0.5: "boundary elements on half-spaces",
    2.0: "boundary elements on half-spaces",
}
LOAD, FRICTION, POISSON, SHEAR, HALF = 5e4, 0.3, 0.28, 8.2e10, 5e-3
BETWEEN = (
    (0.15, 0.28),
    (0.35, 0.1),
    (0.55, 0.5),
    (0.95, 0.28),
    (1.6, 0.28),
    (2.9, 0.4),
    (6.5, 0.28),
)
NAMES = ("C11", "C22", "C23", "C33")
LAWS = {
    "fastsim": "FASTSIM, sliding against the rigid slip",
    "fastsim_1982": "FASTSIM as published",
    "polach": "Polach",
    "shen_hedrick_elkins": "Shen, Hedrick, Elkins",
    "johnson_vermeulen": "Vermeulen, Johnson",
}
WITHOUT_SPIN = ("long", "lat", "long+lat")


def compare():
    """Return the comparisons."""
    found = [_hertz(), _kalker_table(), *_kalker_between()]
    for law in ("fastsim", "fastsim_1982"):
        words = f"{LAWS[law]}: force over µN, with and without spin"
        for ratio in SOURCES:
            found.append(_creep(words, ratio, errors(law, ratio).max(), 0.1))
            found.append(_creep(words + ", mean", ratio, errors(law, ratio).mean(), 0.04))
    for law in ("polach", "shen_hedrick_elkins", "johnson_vermeulen"):
        words = f"{LAWS[law]}: force over µN, without spin"
        found += [
            _creep(words, ratio, errors(law, ratio, WITHOUT_SPIN).max(), 0.15) for ratio in SOURCES
        ]
    lost = "; ".join(
        f"{words}, {_worst(law, 'spin'):.2f} and {_worst(law, 'lat+spin'):.2f}"
        for law, words in LAWS.items()
    )
    note = (
        "Bands of Hertz's and Kalker's tables: their digits; between Kalker's nodes and for creep "
        "forces: as asked of the program. With spin the closed forms lose; largest deviation of "
        f"the force over µN, by spin alone and by spin with lateral creep: {lost}."
    )
    return Group("Contact of wheel and rail", note, tuple(found))


def _worst(law, case):
    return max(errors(law, ratio, (case,)).max() for ratio in SOURCES)


def _creep(quantity, ratio, largest, band):
    return deviation(
        SOURCES[ratio],
        quantity,
        reference=f"a/b = {ratio:g}",
        largest=largest,
        band=band,
        unit="(of µN)",
    )


def _hertz():
    worst = 0.0
    for row in read_rows("hertz_factors.csv")[1:]:
        angle = math.radians(float(row["theta_deg"]))
        shape = ellipse_shape((1.0 - math.cos(angle)) / (1.0 + math.cos(angle)))
        for key, value in (
            ("m", shape.semi_axis_x),
            ("n", shape.semi_axis_y),
            ("r_delta", shape.approach),
        ):
            worst = max(worst, abs(float(value) / float(row[key]) - 1.0))
    return deviation(
        "elliptic integrals",
        "Hertz's factors of semi-axes and approach",
        reference="5 to 90 degrees",
        largest=worst,
        band=5e-6,
        unit="(relative)",
    )


def coefficients(axis_ratio, poissons_ratio):
    """Return C11, C22, C23, C33."""
    found = creep_coefficients(axis_ratio, poissons_ratio)
    return np.array([float(value) for value in vars(found).values()])


def _kalker_table():
    worst = 0.0
    for row in read_rows("kalker_coefficients.csv"):
        ratio = float(row["a_over_b"])
        # The table's a > b entries are at b/a = 0.1, 0.2 ..., printed as a/b with six digits.
        ratio = ratio if ratio <= 1.0 else 1.0 / round(1.0 / ratio, 4)
        wanted = np.array([float(row[name]) for name in NAMES])
        found = coefficients(ratio, float(row["nu"]))
        worst = max(worst, np.abs(found / wanted - 1.0).max())
    return deviation(
        "Kalker (1990), table E.3",
        "creep coefficients at all entries",
        reference="57 entries",
        largest=worst,
        band=1e-9,
        unit="(relative)",
    )


def _kalker_between():
    apart = np.array([coefficients(*case) / no_slip_coefficients(*case) - 1.0 for case in BETWEEN])
    for name, column in zip(NAMES, apart.T, strict=True):
        yield deviation(
            "exact rolling without slip, half-spaces",
            f"{name} between the table's entries",
            reference="a/b = 0.15 to 6.5",
            largest=np.abs(column).max(),
            band=0.02,
            unit="(relative)",
        )


@cache
def _curves(ratio):
    rows = read_rows("creep_curves.csv" if ratio == 1.0 else "creep_curves_half_space.csv")
    return [row for row in rows if float(row.get("a_over_b", 1.0)) == ratio]


@cache
def _all_errors(law, ratio):
    found = []
    for row in _curves(ratio):
        contact = CreepContact(
            float(row["xi"]),
            float(row["eta"]),
            1e3 * float(row["phi_per_mm"]),
            LOAD,
            ContactEllipse(HALF * ratio**0.5, HALF / ratio**0.5),
            SHEAR,
            POISSON,
        )
        forces = find("creep", law)(friction=FRICTION).forces(contact)
        x = float(forces.longitudinal) - float(row["FX"])
        y = float(forces.lateral) - float(row["FY"])
        found.append(math.hypot(x, y) / (FRICTION * LOAD))
    return np.array(found)


def errors(law, ratio, cases=None):
    """Return the deviations of a law's force from the exact curves of a/b, over µ N."""
    kept = [cases is None or row["case"] in cases for row in _curves(ratio)]
    return _all_errors(law, ratio)[kept]
