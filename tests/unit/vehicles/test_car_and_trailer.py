"""The trailer's axle and the hitch share its weight as a lever does."""

import pytest

import vehicledyn as vd

pytestmark = pytest.mark.long
GRAVITY, TRAILER, HANGING, AXLE, MASS = 9.81, 500.0, 2 * (8.0 + 12.0), 2.45, 2.3


def test_trailer_weighs_on_its_axle_and_the_hitch_as_a_lever():
    found = vd.equilibrium("car_and_trailer", speed="25 m/s")
    car = [f"car.{end}_{side}" for end in ("front", "rear") for side in ("left", "right")]
    load = {n: float(found[f"{n}.tyre.normal_force"].values) for n in (*car, "left", "right")}
    whole = 900.0 + 4 * (10.0 + 15.0) + TRAILER + HANGING
    assert sum(load.values()) == pytest.approx(whole * GRAVITY, rel=1e-6)
    lever = (TRAILER * MASS / AXLE + HANGING) * GRAVITY
    # The trailer leans by 2 mrad, which moves its weight by a part in some thousands.
    assert load["left"] + load["right"] == pytest.approx(lever, rel=5e-4)
    assert load["left"] == pytest.approx(load["right"], rel=1e-9)
