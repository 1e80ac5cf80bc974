"""Cars whose wheels only just touch the ground at the start stand on all of them."""

from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.linear.equilibrium import find_equilibrium
from vehicledyn.files.scenario.load import load_scenario

pytestmark = pytest.mark.long

CAR = Path(__file__).parents[3] / "scenarios" / "systems" / "small_car.yaml"
GRAVITY, BODY, AXLE = 9.81, 900.0, 50.0
FRONT, REAR = 1.1, -1.4


@pytest.mark.parametrize("level", ["0 cm", "5 cm"])
def test_wheels_carry_what_the_lever_law_says(level):
    """At 5 cm rounding leaves the front wheels touching and the rear wheels off the ground."""
    road = f"road={{kind: plane, slope_x: 0, slope_y: 0, level: {level}}}"
    report = find_equilibrium(
        load_scenario(CAR, [road]), speed=0.0, backend="auto", progress=lambda *_: None
    )
    forces = {row.name: row.equilibrium for row in report.forces}
    weight = GRAVITY * (BODY + 2.0 * AXLE)
    moment = GRAVITY * AXLE * (FRONT + REAR)
    front = (moment - REAR * weight) / (FRONT - REAR)
    for side in ("left", "right"):
        # Pitching by 0.1 degrees moves the body's weight by a millimetre.
        assert forces[f"front_{side}.tyre.normal_force"] == pytest.approx(front / 2.0, rel=1e-3)
        assert forces[f"rear_{side}.tyre.normal_force"] == pytest.approx(
            (weight - front) / 2.0, rel=1e-3
        )
