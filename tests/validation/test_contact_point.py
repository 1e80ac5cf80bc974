"""Contact points of the disc against an independent solution on three roads."""

import numpy as np
import pytest
from reference_cases.contact_points import BAND, RADIUS, ROADS, deviations, pose, rows

from vehicledyn.road.wheel.contact import contact_on_plane
from vehicledyn.symbolic import ops

ROWS = rows()

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
