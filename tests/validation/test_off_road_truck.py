"""The off-road truck on a slope and in sand against statics, power balance and a closed form."""

import math
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

SCENARIOS = Path(__file__).parents[2] / "scenarios" / "systems"
CORNERS = [(axle, side) for axle in ("front", "rear") for side in ("left", "right")]
WHEELS = [f"truck.{axle}_axle.wheel_{side}" for axle, side in CORNERS]
SHAFTS = [f"truck.{axle}_axle.{side}_wheel" for axle, side in CORNERS]
RADIUS, WIDTH, SLOPE = 0.4699, 0.3, 0.6


def last(run, channels):
    return np.array([np.asarray(run[name])[-1] for name in channels])


@pytest.fixture(scope="module")
def slope():
    return SCENARIOS / "off_road_truck_slope.yaml"


@pytest.fixture(scope="module")
def climb(slope):
    """Climb until the speed is steady."""
    return vd.simulate(slope, set={"duration": "6 s"})


def test_forces_on_the_slope_carry_the_truck(climb):
    """Along and across the slope, Σ F_x cos δ - F_y sin δ over Σ N is tan θ, whatever the mass."""
    loads, pulls, sides = (
        last(climb, [f"{wheel}.tyre.{force}_force" for wheel in WHEELS])
        for force in ("normal", "longitudinal", "lateral")
    )
    toe = last(climb, [f"{shaft}_angles.steer_angle" for shaft in SHAFTS])
    along = pulls * np.cos(toe) - sides * np.sin(toe)
    assert along.sum() / loads.sum() == pytest.approx(SLOPE, rel=2e-3)


def test_the_slope_shifts_load_to_the_rear_axle(climb, slope):
    """N_r L = m g (a cos θ + h sin θ), mass, place a and height h of its centre as on the level."""
    flat = vd.simulate(slope, set={"road.slope_x": 0, "duration": "10 ms"})
    loads = np.asarray([np.asarray(flat[f"{wheel}.tyre.normal_force"])[0] for wheel in WHEELS])
    weight = loads.sum()
    height = np.asarray(flat["energy.gravity"])[0] / weight
    found = last(climb, [f"{wheel}.tyre.normal_force" for wheel in WHEELS])
    cosine = 1.0 / math.hypot(1.0, SLOPE)
    wheelbase = 1.632965 + 1.744965 - 0.076  # of the wheels' centres
    rear = (loads[2:].sum() + weight * SLOPE * height / wheelbase) * cosine
    assert found.sum() == pytest.approx(weight * cosine, rel=2e-3)
    assert found[2:].sum() == pytest.approx(rear, rel=2e-2)


def test_power_of_the_driveline_reaches_the_wheels(climb):
    """T ω of the input shaft lifts the truck, slips the tyres and turns them against resistance."""
    torque, turn = last(climb, ["drive.torque", "transfer.input.angle_rate"])
    pulls = last(climb, [f"{wheel}.tyre.longitudinal_force" for wheel in WHEELS])
    arms = RADIUS - last(climb, [f"{wheel}.tyre.deflection" for wheel in WHEELS])
    turns = last(climb, [f"{shaft}.spin_rate" for shaft in SHAFTS])
    assert torque * turn == pytest.approx((turns * pulls * arms).sum(), rel=5e-3)


def test_sinkage_in_soil_without_strength_has_a_closed_form():
    """Smooth sand with n = 1 carries N = b k R²/2 (θ - sin θ cos θ) at a sinkage R (1 - cos θ).

    The pressure k z then is largest at the lowest point and no shear stress acts.
    """
    soil = {"cohesion": 0, "friction_angle": 0, "exponent": 1, "front_share": 1e-6}
    changes = {f"road.soil.{name}": value for name, value in soil.items()}
    run = vd.simulate(
        SCENARIOS / "off_road_truck_sand.yaml",
        set={**changes, "start": "static", "duration": "10 ms"},
    )
    modulus = 0.99e3 / WIDTH + 1528.43e3
    for wheel in WHEELS:
        load, depth, felt = last(
            run, [f"{wheel}.tyre.normal_force", f"{wheel}.sinkage", f"{wheel}.tyre.deflection"]
        )
        rim = RADIUS - (felt - depth)
        entry = math.acos(1.0 - depth / rim)
        wanted = 0.5 * WIDTH * modulus * rim**2 * (entry - math.sin(entry) * math.cos(entry))
        assert load == pytest.approx(wanted, rel=2e-3)
