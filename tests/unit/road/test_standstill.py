"""Standing, stopping and rolling back: rest on a slope of every tyre law, and motion through it.

At rest all rates vanish but for those of places along the slope, which nothing moves; all other
motions decay. So a car that has come to rest creeps by nothing, however long it stands.
"""

import numpy as np
import pytest
from scipy.optimize import least_squares
from test_contact_patch import PATCH
from test_tyres import EXAMPLES, tyre
from test_wheel import GRAVITY, LOADED, MASS, RADIUS, RELAXED, SPIN_INERTIA, STIFFNESS, Rig

from vehicledyn.road.surfaces.plane import Plane
from vehicledyn.road.tyres.linear import Linear
from vehicledyn.road.tyres.tyre import RelaxationLengths
from vehicledyn.road.wheel.relaxation import Relaxation, transient_slip
from vehicledyn.road.wheel.slip import WheelMotion

pytestmark = pytest.mark.long

STEP = 1e-6
SLOPE, SPEED = 0.1, 0.8
CASES = [(kind, RELAXED) for kind in sorted(EXAMPLES)]
CASES += [(kind, PATCH) for kind in ("brush", "file", "tmeasy")]


def _at_rest(rig):
    """Return the state in which height and deflections hold the wheel, and its largest rate."""
    free = [k for k, name in enumerate(rig.names) if name == "z" or ".tyre." in name]
    start = rig.state(z=LOADED)

    def rates(values):
        state = start.copy()
        state[free] = values
        return rig.rate(state)

    found = least_squares(
        rates, start[free], x_scale=0.01, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=200
    )
    state = start.copy()
    state[free] = found.x
    return state, np.abs(rates(found.x)).max()


@pytest.mark.parametrize(("kind", "relaxation"), CASES)
def test_locked_wheels_rest_on_a_20_percent_slope_without_creep(kind, relaxation):
    law = tyre(kind)
    slopes = (0.2, 0.05) if law.pulls_along else (0.0, 0.2)
    road = Plane(slope_x=slopes[0], slope_y=slopes[1])
    rig = Rig(
        locked=True, turning=False, surface=road, relaxation=relaxation, tyre=law, damping=3e3
    )
    state, largest = _at_rest(rig)
    assert largest < 1e-8
    slope = np.empty((len(state), len(state)))
    for k in range(len(state)):
        change = np.zeros(len(state))
        change[k] = STEP
        slope[:, k] = (rig.rate(state + change) - rig.rate(state - change)) / (2.0 * STEP)
    rates = sorted(np.linalg.eigvals(slope), key=abs)
    unheld = 2 if law.pulls_along else 4  # places; without force along, motion and deflection too
    assert all(abs(rate) < 1e-3 for rate in rates[:unheld])
    assert max(rate.real for rate in rates[unheld:]) < -0.1


@pytest.mark.parametrize("relaxation", [RELAXED, PATCH, None], ids=["first_order", "patch", "none"])
@pytest.mark.parametrize("kind", ["brush", "tmeasy"])
def test_a_wheel_rolls_up_a_slope_stops_and_rolls_back(kind, relaxation):
    """v = v_0 - g sin θ t m/(m + I/r²), through rest and into reverse, without a jump."""
    rig = Rig(
        turning=False,
        surface=Plane(slope_x=SLOPE, slope_y=0.0),
        relaxation=relaxation,
        tyre=tyre(kind),
        damping=3e3,
    )
    cosine = 1.0 / np.sqrt(1.0 + SLOPE**2)
    rolling = RADIUS - MASS * GRAVITY * cosine / STIFFNESS
    state = rig.state(
        z=rolling / cosine,
        x_rate=SPEED * cosine,
        z_rate=SPEED * SLOPE * cosine,
        spin_rate=SPEED / rolling,
    )
    falling = GRAVITY * SLOPE * cosine * MASS / (MASS + SPIN_INERTIA / rolling**2)
    for _ in range(8):
        state = rig.run(state, 0.25)
        assert np.isfinite(state).all()
    wanted = SPEED - 2.0 * falling
    assert wanted < -1.0
    assert state[rig["x_rate"]] / cosine == pytest.approx(wanted, abs=0.02)
    assert state[rig["spin_rate"]] * rolling == pytest.approx(wanted, abs=0.02)


@pytest.mark.parametrize("speed", [0.2, 1.0, -1.0, 2.0])
def test_slip_in_steady_rolling_is_exact_at_low_speed(speed):
    """The damper feels the rate of the deflection only: κ' = -v_sx/|v_x|, tan α' = v_y/|v_x|."""
    motion = WheelMotion(speed, 0.03 * abs(speed), 1.04 * speed / RADIUS, RADIUS)
    slip, tangent = -motion.sliding / abs(speed), 0.03
    bent = slip * RELAXED.longitudinal, tangent * RELAXED.lateral
    found = transient_slip(motion, RELAXED, *bent)
    assert found.longitudinal_rate == pytest.approx(0.0, abs=1e-14)
    assert found.longitudinal_slip == pytest.approx(slip, rel=1e-12)
    assert np.tan(found.slip_angle) == pytest.approx(tangent, rel=1e-12)


def test_a_carcass_takes_up_energy_at_any_speed():
    """Power on the patch less that which the spring stores is never negative; F = C κ'."""
    drawn = np.random.default_rng(4)
    for _ in range(500):
        length, speed = drawn.uniform(0.05, 1.0), drawn.uniform(-4.0, 4.0)
        motion = WheelMotion(speed, 0.0, drawn.uniform(-20.0, 20.0), RADIUS)
        deflection = drawn.uniform(-0.3, 0.3) * length
        found = transient_slip(motion, RelaxationLengths(length, length), deflection, 0.0)
        power = -found.longitudinal_slip * motion.sliding
        stored = deflection * found.longitudinal_rate / length
        assert float(power - stored) > -1e-12


@pytest.mark.parametrize("length", [0.1, 0.6])
def test_a_car_that_has_stopped_rocks_twice_at_most(length):
    """Locked wheels of 400 kg and 100 kN of slip stiffness: of 0.1 m/s 1 mm/s is left after 1 s."""
    law = Linear(
        nominal_load=4e3, longitudinal_stiffness=1e5, cornering_stiffness=5e4, friction=0.9
    )
    relaxation = Relaxation(longitudinal=length, lateral=0.4)
    rig = Rig(locked=True, turning=False, relaxation=relaxation, tyre=law, damping=3e3)
    state = rig.run(rig.state(z=LOADED, x_rate=0.1), 1.0)
    assert abs(state[rig["x_rate"]]) < 1e-3
