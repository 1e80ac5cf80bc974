"""Contact points of the disc against an independent solution on three roads."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from vehicledyn.road.contact import contact_on_plane
from vehicledyn.road.contact_search import find_contact
from vehicledyn.road.surfaces.flat import Flat
from vehicledyn.road.surfaces.plane import Plane
from vehicledyn.road.surfaces.sine import Sine
from vehicledyn.symbolic import ops

TABLE = Path(__file__).parent / "data" / "contact_point_disc.csv"
ROWS = list(
    csv.DictReader(line for line in TABLE.read_text().splitlines() if not line.startswith("#"))
)
ROADS = {
    "flat": Flat(),
    "plane": Plane(slope_x=0.05, slope_y=-0.08),
    "wavy": Sine(amplitude_x=0.05, wavelength_x=2.0, amplitude_y=0.03, wavelength_y=3.0),
}
RADIUS = 0.33
LENGTH = 1e-8  # m, the accuracy asked for; the table has ten digits
VECTORS = {"position": "disc_P", "longitudinal": "ex_", "lateral": "elat_", "normal": "n_"}
SCALARS = {"loaded_radius": "disc_r", "deflection": "disc_defl"}

pytestmark = pytest.mark.validation


def pose(row):
    yaw, camber = math.radians(float(row["yaw_deg"])), math.radians(float(row["camber_deg"]))
    axis = [
        -math.sin(yaw) * math.cos(camber),
        math.cos(yaw) * math.cos(camber),
        math.sin(camber),
    ]
    return [float(row[f"C{k}"]) for k in "xyz"], axis


@pytest.mark.parametrize("row", ROWS, ids=[f"{r['road']}-{r['yaw_deg']}" for r in ROWS])
def test_disc(row):
    contact = find_contact(ROADS[row["road"]], *pose(row), RADIUS)
    for name, column in VECTORS.items():
        expected = [float(row[column + k]) for k in "xyz"]
        assert getattr(contact, name) == pytest.approx(expected, abs=LENGTH)
    for name, column in SCALARS.items():
        assert getattr(contact, name) == pytest.approx(float(row[column]), abs=LENGTH)
    assert math.degrees(contact.camber) == pytest.approx(float(row["road_camber_deg"]), abs=LENGTH)


@pytest.mark.parametrize("row", ROWS, ids=[f"{r['road']}-{r['yaw_deg']}" for r in ROWS])
def test_closed_form_is_the_contact_with_the_tangent_plane_at_the_foot(row):
    centre, axis = pose(row)
    contact = contact_on_plane(ROADS[row["road"]], ops.vector(*centre), ops.vector(*axis), RADIUS)
    found = [float(contact.position[k]) for k in range(3)]
    expected = [float(row[f"tangent1_P{k}"]) for k in "xyz"]
    assert np.array(found) == pytest.approx(expected, abs=LENGTH)
    assert float(contact.deflection) == pytest.approx(float(row["tangent1_defl"]), abs=LENGTH)
