"""Tyre laws against published tables and independently stated figures."""

import math

import pytest
from reference_cases.tables import read_figures
from reference_cases.tyre_tables import curve, rows

from vehicledyn.road.tyres.calspan import Calspan
from vehicledyn.road.tyres.magic_formula_1987 import MagicFormula1987
from vehicledyn.road.tyres.tyre import TyreInput

CALSPAN = read_figures("calspan_iltis.yaml")
TABLE_TOLERANCE = 1e-6  # N, N m: one unit of the last printed digit

pytestmark = pytest.mark.validation


@pytest.mark.parametrize("quantity", ["Fx", "Fy", "Mz"])
def test_magic_formula_curves(quantity):
    table = rows(quantity)
    assert len(table) > 100
    for load, x, camber, value in table:
        found = curve(quantity, load, x, camber)
        assert found == pytest.approx(value, abs=TABLE_TOLERANCE)


@pytest.mark.parametrize("quantity", ["Fx", "Fy", "Mz"])
def test_magic_formula_tyre_at_pure_slip(quantity):
    """In ISO signs side force and moment turn over; combined slip reduces to the curves."""
    tyre = MagicFormula1987()
    for load, x, camber, value in rows(quantity):
        slip, angle = (0.01 * x, 0.0) if quantity == "Fx" else (0.0, math.radians(x))
        forces = tyre.forces(TyreInput(1000.0 * load, slip, angle, math.radians(camber)))
        found = {
            "Fx": forces.longitudinal_force,
            "Fy": -forces.lateral_force,
            "Mz": -forces.aligning_moment,
        }[quantity]
        assert found == pytest.approx(value, abs=TABLE_TOLERANCE)


@pytest.mark.parametrize("axle", ["front", "rear"])
def test_calspan_linear_values(axle):
    """The stated trail gives the load, at which the slopes must be the stated ones."""
    published, tyre = CALSPAN[axle], Calspan()
    load = published["trail"]["value"] / -tyre.af1
    load_band = published["trail"]["half_digit"] / -tyre.af1
    for name, felt in {
        "cornering_stiffness": lambda x, load: TyreInput(load, 0.0, x, 0.0),
        "camber_stiffness": lambda x, load: TyreInput(load, 0.0, 0.0, x),
    }.items():

        def slope(load, felt=felt):
            step = 1e-8
            ends = [tyre.forces(felt(x, load)).lateral_force for x in (-step, step)]
            return (ends[0] - ends[1]) / (2.0 * step)

        sensitivity = abs(slope(load + load_band) - slope(load - load_band)) / 2.0
        band = published[name]["half_digit"] + sensitivity
        assert slope(load) == pytest.approx(published[name]["value"], abs=band)
