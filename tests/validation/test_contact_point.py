"""Contact points of disc and torus against an independent solution on three roads."""

import numpy as np
import pytest
from reference_cases.contact_points import (
    BAND,
    CROWN,
    RADIUS,
    ROADS,
    deviations,
    deviations_of_torus,
    pose,
    rows,
)

from vehicledyn.road.wheel.contact import contact_on_plane
from vehicledyn.symbolic import ops

ROWS = rows()
OF_TORUS = rows("torus")

pytestmark = pytest.mark.validation


@pytest.mark.parametrize("row", ROWS, ids=[f"{r['road']}-{r['yaw_deg']}" for r in ROWS])
def test_disc(row):
    found = deviations(row)
    assert len(found) == 7
    assert max(found.values()) <= BAND, found


@pytest.mark.parametrize("row", ROWS, ids=[f"{r['road']}-{r['yaw_deg']}" for r in ROWS])
def test_closed_form_is_the_contact_with_the_tangent_plane_at_the_foot(row):
    centre, axis = pose(row)
    contact = contact_on_plane(ROADS[row["road"]], ops.vector(*centre), ops.vector(*axis), RADIUS)
    found = [float(contact.position[k]) for k in range(3)]
    expected = [float(row[f"tangent1_P{k}"]) for k in "xyz"]
    assert np.array(found) == pytest.approx(expected, abs=BAND)
    assert float(contact.deflection) == pytest.approx(float(row["tangent1_defl"]), abs=BAND)


@pytest.mark.parametrize("row", OF_TORUS, ids=[f"{r['road']}-{r['yaw_deg']}" for r in OF_TORUS])
def test_torus(row):
    assert max(deviations_of_torus(row).values()) <= BAND


def test_torus_on_a_plane_in_closed_form():
    """What the search finds on one plane is the foot of the circle's nearest point."""
    for row in OF_TORUS:
        if row["road"] == "wavy":
            continue
        centre, axis = pose(row)
        found = contact_on_plane(
            ROADS[row["road"]], ops.vector(*centre), ops.vector(*axis), RADIUS, crown=CROWN
        )
        wanted = [float(row[f"torus_P{k}"]) for k in "xyz"]
        assert [float(found.position[k]) for k in range(3)] == pytest.approx(wanted, abs=BAND)
        assert float(found.deflection) == pytest.approx(float(row["torus_pen"]), abs=BAND)


@pytest.mark.parametrize("camber", [0.0, 0.2, -0.6])
def test_torus_that_leans_on_level_ground(camber):
    """P lies (R - c) sin γ beside the centre; the overlap is c + (R - c) cos γ - h."""
    axis = ops.vector(0.0, np.cos(camber), np.sin(camber))
    centre = ops.vector(0.0, 0.0, 0.3)
    found = contact_on_plane(ROADS["flat"], centre, axis, RADIUS, crown=CROWN)
    assert float(found.position[1]) == pytest.approx((RADIUS - CROWN) * np.sin(camber), abs=1e-15)
    overlap = CROWN + (RADIUS - CROWN) * np.cos(camber) - 0.3
    assert float(found.deflection) == pytest.approx(overlap, abs=1e-15)
    assert float(found.camber) == pytest.approx(camber, abs=1e-15)
