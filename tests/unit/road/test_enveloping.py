"""Enveloping of obstacles by cams: closed forms, search, and the road made of them."""

import csv
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from vehicledyn.road.ground.enveloping import EnvelopingCam, Tandem
from vehicledyn.road.surfaces.obstacles import Obstacles

REFERENCE = (
    Path(__file__).parents[4]
    / "shared"
    / "reference"
    / "road"
    / "contact"
    / "obstacle_enveloping.csv"
)
RADIUS = 0.3943
STEP = np.array([-5.0, 0.0, 0.0, 5.0]), np.array([0.0, 0.0, 0.025, 0.025])
ROUGH = np.array([-5.0, -0.2, 0.0, 0.1, 0.1, 0.4, 5.0]), np.array([0, 0, 0.03, 0.02, 0.05, 0.0, 0])
TYRE = {"cam_length": RADIUS, "cam_height": RADIUS}


def test_a_circle_rests_on_the_edge_of_a_step():
    at = np.array([-0.3, -0.1, -0.05, 0.2])
    expected = 0.025 - RADIUS + np.sqrt(RADIUS**2 - at**2)
    expected = np.where(at > 0.0, 0.025, np.maximum(expected, 0.0))
    assert EnvelopingCam(RADIUS, RADIUS, 2.0).lift(*STEP, at) == pytest.approx(expected, abs=1e-14)


def test_a_circle_touches_a_ramp_beside_its_middle():
    """On a slope tan b the lowest point of a circle is R (1 / cos b - 1) above the ramp."""
    ramp = np.array([-50.0, 50.0]), np.array([-10.0, 10.0])
    lifted = 0.2 * 1.3 + RADIUS * (np.hypot(1.0, 0.2) - 1.0)
    assert EnvelopingCam(RADIUS, RADIUS, 2.0).lift(*ramp, 1.3) == pytest.approx([lifted], abs=1e-14)


@pytest.mark.parametrize("order", [1.6, 2.0, 3.0])
def test_the_lift_is_the_highest_of_a_search(order):
    cam, at = EnvelopingCam(0.4, 0.35, order), np.linspace(-0.6, 0.8, 29)
    s = np.linspace(-0.4, 0.4, 80_001)
    found = [(np.interp(x + s, *ROUGH) - cam.outline(s)).max() for x in at]
    assert cam.lift(*ROUGH, at[::-1])[::-1] == pytest.approx(found, abs=1e-5)


def test_two_cams_feel_height_and_slope_between_them():
    cam, at = EnvelopingCam(RADIUS, RADIUS, 1.8), np.array([-0.1, 0.0, 0.07])
    height, slope = Tandem(cam, 0.096).height_and_slope(*STEP, at)
    front, rear = cam.lift(*STEP, at + 0.048), cam.lift(*STEP, at - 0.048)
    assert height == pytest.approx(0.5 * (front + rear), abs=0)
    assert slope == pytest.approx((front - rear) / 0.096, abs=0)


def test_the_road_is_that_of_the_cams():
    road = Obstacles(crest="25 mm", start="3 m", cam_spacing="96 mm", **TYRE)
    for at in (-0.15, -0.05, 0.013, 0.3):
        height, slope = Tandem(EnvelopingCam(RADIUS, RADIUS, 1.8), 0.096).height_and_slope(
            *STEP, at
        )
        assert road.height(3.0 + at, 0.7) == pytest.approx(height[0], abs=1e-8)
        assert road.gradient(3.0 + at, 0.7)[0] == pytest.approx(slope[0], abs=1e-5)
    assert road.height(0.0, 0.0) == 0.0
    assert road.height(50.0, 0.0) == pytest.approx(0.025, abs=1e-15)


@pytest.mark.parametrize(
    "bad",
    [
        {"length": "30 mm", "bevel": "20 mm"},
        {"count": 3, "length": "50 mm"},
        {"count": 3, "length": "50 mm", "spacing": "40 mm"},
        {"cam_order": 1.0},
    ],
)
def test_obstacles_without_sense_are_refused(bad):
    with pytest.raises(ValidationError):
        Obstacles(crest=0.02, start=1.0, **TYRE, **bad)


@pytest.mark.skipif(not REFERENCE.is_file(), reason="the reference data are not there")
def test_lifts_are_those_of_the_reference():
    with REFERENCE.open() as file:
        rows = list(csv.DictReader(file))
    assert rows
    for row in rows:
        crest, at = float(row["h_m"]), float(row["X_centre_m"])
        width = float(row["w_m"] or 5.0)
        x, z = np.array([-5, 0, 0, width, width, 9]), np.array([0, 0, crest, crest, 0, 0])
        cam = EnvelopingCam(RADIUS, RADIUS, 2.0 if row["case"].startswith("circle") else 1.8)
        spacing = 0.096 if "tandem" in row["case"] else 0.0
        height, slope = Tandem(cam, spacing).height_and_slope(x, z, at)
        assert height[0] == pytest.approx(float(row["lift_closed"]), abs=1e-9)
        if spacing:
            assert slope[0] == pytest.approx(float(row["effective_slope_tanbeta"]), abs=1e-7)
