"""A patch with mass between carcass and tread, and a patch that is turned on the spot."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from test_wheel import LINEAR, LOADED, MASS, Rig

from vehicledyn.base.errors import InputError
from vehicledyn.road.surfaces.plane import Plane
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile
from vehicledyn.road.wheel import turning
from vehicledyn.road.wheel.contact_patch import ContactPatch
from vehicledyn.road.wheel.relaxation import Relaxation
from vehicledyn.road.wheel.turning import Turning

pytestmark = pytest.mark.long

C_X, C_Y, K, M, A = 300e3, 150e3, 400.0, 1.5, 0.06
PATCH = ContactPatch(
    mass=M,
    half_length=A,
    longitudinal_stiffness=C_X,
    lateral_stiffness=C_Y,
    longitudinal_damping=K,
    lateral_damping=K,
)
BRISTLES = Turning(half_length=0.06, friction=0.9, stiffness=1600.0)
LIMIT = 0.9 * 4000.0 * 0.06


@pytest.fixture(scope="module")
def patch_rig():
    return Rig(turning=False, tyre=LINEAR, relaxation=PATCH)


def test_in_steady_rolling_the_wheel_feels_the_steady_law(patch_rig):
    speed, slide, slip = 10.0, 0.3, 0.03
    state = patch_rig.state(
        z=LOADED, x_rate=speed, y_rate=slide, spin_rate=(1 + slip) * speed / LOADED
    )
    steady = Rig(turning=False, tyre=LINEAR)
    found = steady.outputs(steady.state(**{n: state[patch_rig[n]] for n in steady.names}))
    forces = [found[f"wheel.tyre.{way}_force"] for way in ("longitudinal", "lateral")]
    deflections = forces[0] / C_X, forces[1] / C_Y
    sliding = (-slip * speed, slide)
    for k, way in enumerate(("longitudinal", "lateral")):
        state[patch_rig[f"wheel.tyre.{way}_deflection"]] = deflections[k]
        state[patch_rig[f"wheel.tyre.{way}_patch_velocity"]] = sliding[k]
    state[patch_rig["wheel.tyre.longitudinal_tread"]] = A * slip
    state[patch_rig["wheel.tyre.lateral_tread"]] = A * slide / speed
    rate = patch_rig.rate(state)
    for name in patch_rig.names:
        if ".tyre." in name:
            assert rate[patch_rig[name]] == pytest.approx(0.0, abs=1e-9), name
    out = patch_rig.outputs(state)
    for way, force in zip(("longitudinal", "lateral"), forces, strict=True):
        assert out[f"wheel.tyre.{way}_force"] == pytest.approx(force, rel=1e-12)


@pytest.mark.parametrize("frequency", [0.5, 10.0, 60.0, 250.0])
def test_response_of_the_side_force_in_closed_form(patch_rig, frequency):
    """F/v_y = -(c/s + k) (m s + G)/(m s + G + c/s + k) with the tread's G = C/(a s + |v_x|)."""
    speed = 20.0
    names = [f"wheel.tyre.lateral_{n}" for n in ("deflection", "patch_velocity", "tread")]
    rest = patch_rig.state(z=LOADED, x_rate=speed, spin_rate=speed / LOADED)
    places = [patch_rig[n] for n in names]
    drive, step = patch_rig["y_rate"], 1e-6

    def look(change):
        state = rest + change
        force = patch_rig.outputs(state)["wheel.tyre.lateral_force"]
        return np.append(patch_rig.rate(state)[places], force)

    slopes = []
    for place in (*places, drive):
        change = np.zeros(len(rest))
        change[place] = step
        slopes.append((look(change) - look(-change)) / (2.0 * step))
    slopes = np.array(slopes).T
    s = 2j * math.pi * frequency
    inner = np.linalg.solve(s * np.eye(3) - slopes[:3, :3], slopes[:3, 3])
    found = slopes[3, :3] @ inner + slopes[3, 3]
    cornering = 45e3 * MASS * 9.81 / 4e3
    tread, carcass = M * s + cornering / (A * s + speed), C_Y / s + K
    assert found == pytest.approx(-carcass * tread / (tread + carcass), rel=1e-6)


def test_patches_of_locked_wheels_hold_on_a_slope():
    """What is left of the motion decays and nothing creeps."""
    rig = Rig(
        locked=True,
        turning=False,
        surface=Plane(slope_x=0.2, slope_y=0.0),
        tyre=TyreOfFile(file="passenger_R0394_mf61.tir"),
        relaxation=PATCH,
        damping=3e3,
    )
    state = rig.run(rig.state(z=LOADED), 2.0)
    later = rig.run(state, 0.5)
    assert abs(state[rig["x"]]) < 0.05
    assert abs(later[rig["x"]] - state[rig["x"]]) < 1e-4
    assert abs(later[rig["x_rate"]]) < 0.5 * abs(state[rig["x_rate"]]) + 1e-12


def test_the_carcass_is_that_of_the_file_or_asked_for():
    plain = PATCH.model_copy(update={"longitudinal_stiffness": None, "lateral_stiffness": None})
    with pytest.raises(InputError, match="'linear' have no stiffness of the carcass"):
        Rig(relaxation=plain, tyre=LINEAR)
    tyre = TyreOfFile(file="passenger_R0394_mf61.tir")
    values = tyre.content.values
    wanted = (values["LONGITUDINAL_STIFFNESS"], values["LATERAL_STIFFNESS"])
    assert tyre.carcass_stiffness() == wanted


def _integrated(twist, load):
    """Return the moment of bristles that stick below friction times the pressure, or slide."""
    tread = 3.0 * BRISTLES.stiffness / (2.0 * BRISTLES.half_length**3)
    a = BRISTLES.half_length

    def shear(x):
        pressure = 0.75 * load / a * (1.0 - (x / a) ** 2)
        return min(tread * x * abs(twist), BRISTLES.friction * pressure) * x

    share = 2.0 * BRISTLES.stiffness * abs(twist) / (BRISTLES.friction * load * a)
    edge = 2.0 * a / (share + math.sqrt(share**2 + 4.0))
    total = quad(shear, 0.0, edge, epsabs=1e-12)[0] + quad(shear, edge, a, epsabs=1e-12)[0]
    return -2.0 * math.copysign(total, twist)


@pytest.mark.parametrize("twist", [1e-4, -0.02, 0.1, 0.5, 3.0])
def test_moment_of_a_twisted_patch_is_that_of_its_bristles(twist):
    assert float(BRISTLES.moment(twist, 4000.0)) == pytest.approx(_integrated(twist, 4e3), rel=1e-9)


def test_the_moment_of_a_patch_has_its_limits():
    assert float(BRISTLES.moment(1e-6, 4e3)) == pytest.approx(-1.6e-3, rel=1e-4)
    assert float(BRISTLES.moment(1e3, 4e3)) == pytest.approx(-0.375 * LIMIT, rel=1e-6)
    assert float(BRISTLES.moment(0.3, 0.0)) == 0.0


def test_steering_at_rest_winds_the_patch_and_holding_keeps_it():
    """The moment follows the bristles' up to the largest twist, stays, and turns back at once."""
    relaxation = Relaxation(longitudinal=0.2, lateral=0.4, turning=BRISTLES)
    rig = Rig(relaxation=relaxation, damping=3e3, locked=True)
    twist, load = rig["wheel.tyre.twist"], MASS * 9.81
    state = rig.state(z=LOADED, yaw_rate=0.5)
    assert rig.rate(state)[twist] == pytest.approx(0.5, rel=1e-12)
    state[twist] = 0.2
    moment = rig.outputs(state)["wheel.tyre.aligning_moment"]
    assert moment == pytest.approx(_integrated(0.2, load), rel=1e-9)
    state[rig["yaw_rate"]] = 0.0
    assert rig.rate(state)[twist] == 0.0
    state[rig["yaw_rate"]] = -0.5
    assert rig.rate(state)[twist] == pytest.approx(-0.5, rel=1e-12)
    largest = turning.LARGEST_TWIST * 0.9 * load * 0.06 / 3200.0
    state[twist] = 1.01 * largest
    state[rig["yaw_rate"]] = 0.5
    assert rig.rate(state)[twist] < 0.0
    assert float(BRISTLES.moment(largest, load)) == pytest.approx(
        -0.375 * 0.9 * load * 0.06, rel=5e-3
    )


def test_a_rolling_wheel_loses_its_twist_within_its_patch():
    relaxation = Relaxation(longitudinal=0.2, lateral=0.4, turning=BRISTLES)
    rig = Rig(relaxation=relaxation)
    state = rig.state(z=LOADED, x_rate=3.0, spin_rate=3.0 / LOADED)
    state[rig["wheel.tyre.twist"]] = 0.1
    assert rig.rate(state)[rig["wheel.tyre.twist"]] == pytest.approx(-3.0 * 0.1 / 0.06, rel=1e-12)


def test_a_patch_without_load_is_slow_enough_for_steps_of_a_millisecond():
    """-2785 is the end of stability of rk4; the damping at low speed alone moved it by -2875."""
    tyre = TyreOfFile(file="passenger_R0394_mf61.tir")
    patch = ContactPatch(mass=1.5, half_length=A, longitudinal_damping=K, lateral_damping=K)
    rig = Rig(turning=False, tyre=tyre, relaxation=patch, locked=True)
    state = rig.state(z=0.4)  # in the air
    place = rig["wheel.tyre.longitudinal_patch_velocity"]
    step = np.zeros(len(state))
    step[place] = 1e-3
    slope = (rig.rate(state + step) - rig.rate(state - step))[place] / 2e-3
    assert -2000.0 < slope < -1000.0
