"""The road wheel in small systems: loads, rolling, lift-off, standstill, general ground."""

import math
from pathlib import Path

import casadi
import numpy as np
import pytest
from contact_search import find_contact
from scipy.optimize import brentq

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_scenario
from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.system import System
from vehicledyn.road.surfaces.flat import Flat
from vehicledyn.road.surfaces.plane import Plane
from vehicledyn.road.surfaces.sine import Sine
from vehicledyn.road.tyres.linear import Linear
from vehicledyn.road.tyres.magic_formula_1987 import MagicFormula1987
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile
from vehicledyn.road.wheel import relaxation as transient
from vehicledyn.road.wheel.relaxation import Relaxation, TyreRelaxation
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.road.wheel.slip import SlipFloors
from vehicledyn.road.wheel.soft_ground import direction_of_travel, soil_forces
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import ParameterTable

pytestmark = pytest.mark.long

MASS, RADIUS, STIFFNESS, SPIN_INERTIA, GRAVITY = 390.0, 0.364, 460e3, 1.9, 9.81
LOADED = RADIUS - MASS * GRAVITY / STIFFNESS
RELAXED = Relaxation(longitudinal=0.2, lateral=0.4)
TYRE = MagicFormula1987()
LINEAR = Linear(
    nominal_load=4e3, longitudinal_stiffness=80e3, cornering_stiffness=45e3, friction=0.9
)
WAVY = Sine(amplitude_x=0.05, wavelength_x=2.0, amplitude_y=0.03, wavelength_y=3.0)
NAMES = ("x", "y", "z", "yaw", "roll", "spin")


class Rig:
    """A wheel under a block that slides in three directions; its equations as numbers."""

    def __init__(self, *, locked=False, turning=True, **options):
        angle = "auto" if turning else "driven"
        joints = (
            *(Joint(f"T{k}", n) for k, n in enumerate("xyz", start=1)),
            Joint("R3", "yaw", role=angle),
            Joint("R1", "roll", role=angle),
        )
        spin = Joint("R2", "spin", role="driven" if locked else "auto")
        inertia = (1.2, SPIN_INERTIA, 1.2, 0.0, 0.0, 0.0)
        self.wheel = RoadWheel(
            "wheel",
            body="wheel",
            spin="spin",
            **{"tyre": TYRE, "surface": Flat(), "radius": RADIUS, "stiffness": STIFFNESS} | options,
        )
        block = Body("block", "ground", joints=joints, mass=MASS - 57.0, inertia=(9, 9, 9, 0, 0, 0))
        wheel = Body("wheel", "block", joints=(spin,), mass=57.0, inertia=inertia, spins_about=2)
        system = System("rig", ParameterTable(), (block, wheel), parts=(self.wheel,))
        e = self.equations = derive(system)
        inputs = [e.time, e.state, e.algebraic, e.parameter]
        self._rate, self._output = ops.numeric(inputs, e.rate), ops.numeric(inputs, e.output)
        self._error = ops.numeric(inputs, e.residual)
        self._slope = ops.numeric(inputs, ops.jacobian(e.residual, e.algebraic))
        self.values = [p.value for p in e.parameters]
        self.names = [s.name for s in e.states]
        self.algebraic = np.array([u.start for u in e.unknowns])

    def state(self, **values):
        assert set(values) <= set(self.names)
        return np.array([values.get(name, 0.0) for name in self.names])

    def solve(self, state):
        for _ in range(20 if self.algebraic.size else 0):
            error = self._error(0.0, state, self.algebraic, self.values)[:, 0]
            slope = self._slope(0.0, state, self.algebraic, self.values)
            self.algebraic = self.algebraic - np.linalg.solve(slope, error)
        return self.algebraic

    def rate(self, state):
        return self._rate(0.0, state, self.solve(state), self.values)[:, 0]

    def outputs(self, state):
        found = self._output(0.0, state, self.solve(state), self.values)[:, 0]
        return dict(zip([c.name for c in self.equations.channels], found, strict=True))

    def run(self, state, duration, step=1e-3):
        """Return the state after classical Runge-Kutta steps, all in one call."""
        e = self.equations
        assert not self.algebraic.size
        rate = casadi.Function("rate", [e.state, e.time, e.parameter], [e.rate])
        x = casadi.SX.sym("x", len(self.names))
        a = rate(x, 0.0, self.values)
        b = rate(x + 0.5 * step * a, 0.0, self.values)
        c = rate(x + 0.5 * step * b, 0.0, self.values)
        d = rate(x + step * c, 0.0, self.values)
        one = casadi.Function("step", [x], [x + step / 6.0 * (a + 2 * b + 2 * c + d)])
        return one.fold(round(duration / step))(state).full()[:, 0]

    def __getitem__(self, name):
        return self.names.index(name)


def moving(rig, seed):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-3, 3, size=2)
    z = float(rig.wheel.surface.height(x, y)) + rng.uniform(0.30, 0.35)
    yaw, roll = rng.uniform([-3, -0.2], [3, 0.2])
    values = {"x": x, "y": y, "z": z, "yaw": yaw, "roll": roll}
    rates = {f"{n}_rate": rng.normal() for n in ("y", "z", "yaw", "roll")}
    return rig.state(**values, **rates, x_rate=15 * rng.choice([-1, 1]), spin_rate=40.0)


@pytest.fixture(scope="module")
def flat_rig():
    return Rig()


@pytest.fixture(scope="module")
def wavy_rig():
    return Rig(surface=WAVY)


@pytest.fixture(scope="module")
def damped_rig():
    return Rig(damping=3e3, turning=False)


@pytest.mark.parametrize("surface", [Flat(), WAVY], ids=["flat", "wavy"])
def test_a_torus_touches_the_ground_where_it_is_nearest_to_its_circle(surface):
    rig = Rig(surface=surface, crown=0.12)
    for seed in range(3):
        state = moving(rig, seed)
        out = rig.outputs(state)
        x, y, z, yaw, roll = (state[rig[n]] for n in NAMES if n != "spin")
        axis = turn_z(yaw) @ turn_x(roll) @ [0, 1, 0]
        contact = find_contact(surface, [x, y, z], axis, RADIUS, crown=0.12)
        where = [out[f"wheel.contact_{k}"] for k in "xyz"]
        assert where == pytest.approx(list(contact.position), abs=1e-11)
        assert out["wheel.tyre.deflection"] == pytest.approx(contact.deflection, abs=1e-11)
        along = np.linspace(-0.5, 0.5, 801)
        centre_line = [x, y, z] + (RADIUS - 0.12) * (
            np.outer(np.sin(along), turn_z(yaw)[:, 0])
            - np.outer(np.cos(along), turn_z(yaw) @ turn_x(roll) @ [0, 0, 1])
        )
        nearest = np.linalg.norm(centre_line - contact.position, axis=1).min()
        assert nearest == pytest.approx(0.12 - contact.deflection, abs=1e-6)


@pytest.mark.parametrize("road", ["flat_rig", "wavy_rig"])
@pytest.mark.parametrize("seed", range(4))
def test_channels_follow_from_contact_and_law(road, seed, request):
    """Contact, slips and forces recomputed with plain numbers from the state."""
    rig = request.getfixturevalue(road)
    state = moving(rig, seed)
    out = rig.outputs(state)
    q = {n: state[rig[n]] for n in NAMES if n != "spin"}
    v = {n: state[rig[f"{n}_rate"]] for n in NAMES}
    axis = turn_z(q["yaw"]) @ turn_x(q["roll"]) @ [0, 1, 0]
    contact = find_contact(rig.wheel.surface, [q["x"], q["y"], q["z"]], axis, RADIUS)
    where = [out[f"wheel.contact_{k}"] for k in "xyz"]
    assert where == pytest.approx(list(contact.position), abs=1e-11)
    assert out["wheel.tyre.deflection"] == pytest.approx(contact.deflection, abs=1e-11)
    velocity = np.array([v["x"], v["y"], v["z"]])
    along, across = velocity @ contact.longitudinal, velocity @ contact.lateral
    omega = np.array([0, 0, v["yaw"]]) + turn_z(q["yaw"]) @ [v["roll"], 0, 0]
    spin = omega @ axis + v["spin"]
    slip = (spin * min(contact.loaded_radius, RADIUS) - along) / abs(along)
    angle = math.atan(across / abs(along))
    load = STIFFNESS * max(contact.deflection, 0.0)
    forces = TYRE.forces(TyreInput(load, slip, angle, contact.camber))
    assert out["wheel.tyre.normal_force"] == pytest.approx(load, abs=1e-5)
    assert out["wheel.tyre.longitudinal_slip"] == pytest.approx(slip, abs=1e-9)
    assert out["wheel.tyre.slip_angle"] == pytest.approx(angle, abs=1e-9)
    assert out["wheel.tyre.camber"] == pytest.approx(contact.camber, abs=1e-9)
    for name in ("longitudinal_force", "lateral_force", "aligning_moment"):
        assert out[f"wheel.tyre.{name}"] == pytest.approx(getattr(forces, name), abs=1e-4)


@pytest.mark.parametrize("road", ["flat_rig", "wavy_rig"])
@pytest.mark.parametrize("seed", range(4))
def test_wrench_has_the_power_of_the_forces_at_the_contact_point(road, seed, request):
    rig = request.getfixturevalue(road)
    state = moving(rig, seed)
    out = rig.outputs(state)
    q = {n: state[rig[n]] for n in NAMES if n != "spin"}
    v = {n: state[rig[f"{n}_rate"]] for n in NAMES}
    turning = turn_z(q["yaw"]) @ turn_x(q["roll"])
    centre = np.array([q["x"], q["y"], q["z"]])
    c = find_contact(rig.wheel.surface, centre, turning @ [0, 1, 0], RADIUS)
    omega = [0, 0, v["yaw"]] + turn_z(q["yaw"]) @ [v["roll"], 0, 0] + turning @ [0, v["spin"], 0]
    patch = np.array([v["x"], v["y"], v["z"]]) + np.cross(omega, c.position - centre)
    force = (
        out["wheel.tyre.normal_force"] * c.normal
        + out["wheel.tyre.longitudinal_force"] * c.longitudinal
        + out["wheel.tyre.lateral_force"] * c.lateral
    )
    power = force @ patch + out["wheel.tyre.aligning_moment"] * (omega @ c.normal)
    assert out["power.forces"] == pytest.approx(power, rel=1e-8)


def test_lifted_wheel_has_no_force(flat_rig):
    state = flat_rig.state(z=RADIUS + 1e-6, x_rate=10.0, y_rate=2.0, roll=0.0, spin_rate=90.0)
    out = flat_rig.outputs(state)
    for name in ("normal_force", "longitudinal_force", "lateral_force", "aligning_moment"):
        assert out[f"wheel.tyre.{name}"] == 0.0
    assert flat_rig.rate(state)[flat_rig["z_rate"]] == pytest.approx(-GRAVITY, abs=1e-9)


def test_damped_wheel_never_pulls_and_touches_down_gently(damped_rig):
    def load(z, rate):
        return damped_rig.outputs(damped_rig.state(z=z, z_rate=rate))["wheel.tyre.normal_force"]

    assert load(RADIUS - 1e-4, 10.0) == 0.0
    assert load(RADIUS, -10.0) == 0.0
    assert load(RADIUS - 0.01, -1.0) == pytest.approx(4600.0 + 3000.0, rel=1e-12)


def test_free_wheel_is_stable_at_one_millisecond_down_to_standstill():
    """A stiff tyre under a rolling block that is pushed at any speed keeps its spin."""
    rig = Rig(turning=False, tyre=LINEAR)
    for speed in (0.0, 0.5, 3.0, 20.0):
        state = rig.state(z=LOADED, x_rate=speed, spin_rate=speed / LOADED + 20.0)
        end = rig.run(state, 1.0)
        assert end[rig["spin_rate"]] * LOADED == pytest.approx(end[rig["x_rate"]], abs=1e-3)


def test_halving_the_floors_moves_nothing_at_speed():
    ends = []
    for factor in (1.0, 0.5):
        rig = Rig(turning=False, floors=SlipFloors(4.0 * factor, 0.8 * factor))
        state = rig.state(z=LOADED, x_rate=15.0, y_rate=0.5, spin_rate=42.0)
        ends.append(rig.run(state, 0.1))
    assert np.array_equal(*ends)


@pytest.mark.parametrize("slopes", [(0.2, 0.0), (0.0, 0.15), (-0.15, 0.1)])
def test_locked_wheel_stands_on_a_slope_without_creep(slopes):
    road = Plane(slope_x=slopes[0], slope_y=slopes[1])
    rig = Rig(locked=True, turning=False, surface=road, relaxation=RELAXED, damping=3e3)
    state = rig.run(rig.state(z=LOADED), 3.0)
    later = rig.run(state, 1.0)
    for name in "xy":
        assert abs(state[rig[name]]) < 0.03
        assert later[rig[name]] == pytest.approx(state[rig[name]], abs=2e-6)
        assert abs(later[rig[f"{name}_rate"]]) < 1e-5


def test_locked_wheel_slides_to_a_stop_and_stays():
    rig = Rig(locked=True, turning=False, relaxation=RELAXED, damping=3e3)
    state = rig.run(rig.state(z=LOADED, x_rate=3.0), 2.0)
    assert 0.3 < state[rig["x"]] < 0.9
    later = rig.run(state, 0.5)
    assert later[rig["x"]] == pytest.approx(state[rig["x"]], abs=1e-4)


def test_relaxed_slip_becomes_the_steady_slip():
    speed, slide = 10.0, 0.4
    rig = Rig(turning=False, relaxation=RELAXED)
    state = rig.state(z=LOADED, x_rate=speed, y_rate=slide, spin_rate=1.03 * speed / LOADED)
    share = state.copy()
    share[rig["wheel.tyre.longitudinal_deflection"]] = 0.2 * 0.03
    share[rig["wheel.tyre.lateral_deflection"]] = 0.4 * slide / speed
    rate = rig.rate(share)
    assert rate[rig["wheel.tyre.longitudinal_deflection"]] == pytest.approx(0.0, abs=1e-12)
    assert rate[rig["wheel.tyre.lateral_deflection"]] == pytest.approx(0.0, abs=1e-12)
    steady = Rig(turning=False)
    plain = steady.state(**{n: state[rig[n]] for n in steady.names})
    relaxed, expected = rig.outputs(share), steady.outputs(plain)
    for name in ("longitudinal_force", "lateral_force", "aligning_moment"):
        channel = f"wheel.tyre.{name}"
        assert relaxed[channel] == pytest.approx(expected[channel], rel=1e-10)


def test_spinning_at_standstill_does_not_wind_up():
    """36 m/s of sliding for 10 ms on top of 15 % of 0.2 m; without the leak it is metres."""
    rig = Rig(turning=False, relaxation=RELAXED)
    state = rig.state(z=LOADED, spin_rate=100.0)
    for _ in range(10):
        state = rig.run(state, 0.01)
        assert state[rig["wheel.tyre.longitudinal_deflection"]] < 0.4


@pytest.mark.parametrize("name", ["DAMPING_TIME", "LEAK_TIME", "HOLDING_SLIP"])
def test_low_speed_terms_vanish_at_speed(name, monkeypatch):
    def slips():
        motion = transient.WheelMotion(transient.LOW_SPEED, 1.5, 0.0, RADIUS)
        return transient.transient_slip(motion, RELAXED, 0.3, -0.2)

    before = slips()
    monkeypatch.setattr(transient, name, 0.5 * getattr(transient, name))
    assert slips() == before


def turn_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def turn_x(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


FILES = [{"file": "passenger_R0394_mf61.tir"}, {"file": "passenger_235_60R16_pac2002.tir"}]


@pytest.mark.parametrize("settings", FILES)
def test_tyres_of_files_hold_a_locked_wheel_by_their_own_relaxation(settings):
    """On a 20 % slope what is left of the motion decays, by its damping, and nothing creeps."""
    road = Plane(slope_x=0.2, slope_y=0.0)
    tyre = TyreOfFile(**settings)
    rig = Rig(
        locked=True, turning=False, surface=road, relaxation=TyreRelaxation(), tyre=tyre,
        damping=3e3,
    )  # fmt: skip
    state = rig.run(rig.state(z=LOADED), 4.0)
    later = rig.run(state, 1.0)
    assert abs(state[rig["x"]]) < 0.05
    assert abs(later[rig["x"]] - state[rig["x"]]) < 1e-5
    rates = [abs(s[rig["x_rate"]]) for s in (state, later)]
    assert rates[1] < 0.25 * rates[0] or rates[1] < 1e-12


@pytest.mark.parametrize("speed", [12.0, -12.0, 0.3])
def test_turn_slip_is_the_yaw_rate_over_the_speed(speed):
    """Forces are the law's at -ω/max(|v|, floor); a tyre without turn slip feels none."""
    turning = TyreOfFile(file="passenger_R0394_mf61.tir", turn_slip=True)
    rig = Rig(tyre=turning)
    state = rig.state(z=LOADED, x_rate=speed, y_rate=0.2, yaw_rate=0.9, spin_rate=speed / LOADED)
    out = rig.outputs(state)
    curved = -0.9 / max(abs(speed), rig.wheel.floors.lateral)
    assert out["wheel.tyre.turn_slip"] == pytest.approx(curved, rel=1e-12)
    felt = [out[f"wheel.tyre.{n}"] for n in ("normal_force", "longitudinal_slip", "slip_angle")]
    forces = turning.forces(TyreInput(*felt, 0.0, speed, curved))
    plain = turning.forces(TyreInput(*felt, 0.0, speed))
    for name in ("longitudinal_force", "lateral_force", "aligning_moment"):
        assert out[f"wheel.tyre.{name}"] == pytest.approx(float(getattr(forces, name)), abs=1e-8)
    assert abs(float(forces.aligning_moment) - float(plain.aligning_moment)) > 0.5


def test_turn_slip_of_a_file_without_it_is_refused():
    tyre = TyreOfFile(file="passenger_235_60R16_pac2002.tir", turn_slip=True)
    with pytest.raises(InputError, match="turn_slip: the file or its law has none"):
        Rig(tyre=tyre)
    assert any("turn_slip" in line for line in tyre.problems_beside(Path()))


def test_relaxation_of_tyres_without_lengths_is_refused():
    with pytest.raises(InputError, match="'linear' have no relaxation lengths of their own"):
        Rig(relaxation=TyreRelaxation(), tyre=LINEAR)


CONTACT_PATCH = (
    "{kind: contact_patch, mass: 1 kg, half_length: 5 cm, longitudinal_damping: 0 N*s/m, "
    "lateral_damping: 0 N*s/m}"
)


@pytest.mark.parametrize("kind", ["{kind: of_tyre}", CONTACT_PATCH])
def test_reading_a_scenario_refuses_relaxation_that_its_tyres_lack(kind):
    """As in a run: the law of the Iltis has neither lengths nor a carcass."""
    scenario = Path(__file__).parents[3] / "scenarios" / "iltis_slalom.yaml"
    with pytest.raises(InputError, match=r"^relaxation: tyres of the kind 'magic_formula_1987'"):
        load_scenario(scenario, [f"relaxation={kind}"])


SAND = {
    "kind": "bekker",
    "wheel_width": "200 mm",
    "cohesion": "1 kPa",
    "friction_angle": "30 deg",
    "shear_modulus": "25 mm",
    "exponent": 1.1,
    "cohesive_modulus": "1 kN/m",
    "frictional_modulus": "3 MPa",
}


@pytest.fixture(scope="module")
def sand_rig():
    return Rig(surface=Flat(soil=SAND), turning=False, damping=2e3)


def test_a_standing_wheel_sinks_until_the_soil_carries_it(sand_rig):
    """Spring of the tyre and soil carry the same load, one upon the other."""

    def missing(height):
        return (
            sand_rig.outputs(sand_rig.state(z=height))["wheel.tyre.normal_force"] - MASS * GRAVITY
        )

    height = brentq(missing, RADIUS - 0.2, RADIUS - 0.02, xtol=1e-10)
    found = sand_rig.outputs(sand_rig.state(z=height))
    sinkage = found["wheel.sinkage"]
    deflection = RADIUS - height - sinkage
    assert deflection == pytest.approx(MASS * GRAVITY / STIFFNESS, rel=1e-5)
    soil = sand_rig.wheel.surface.soil
    held = soil_forces(soil, RADIUS - deflection, sinkage, slip=0.0, direction=0.0)
    assert held.load == pytest.approx(MASS * GRAVITY, rel=1e-5)
    assert 0.05 < sinkage < 0.15
    assert found["wheel.tyre.longitudinal_force"] == pytest.approx(0.0, abs=1e-9)


def test_motion_in_sand_is_that_of_the_soils_forces(sand_rig):
    state = sand_rig.state(z=RADIUS - 0.06, x_rate=5.0, y_rate=0.4, spin_rate=18.0)
    found, rate = sand_rig.outputs(state), sand_rig.rate(state)
    rolling = RADIUS - (0.06 - found["wheel.sinkage"])
    soil = soil_forces(
        sand_rig.wheel.surface.soil,
        rolling,
        found["wheel.sinkage"],
        slip=18.0 * rolling / 5.0 - 1.0,
        side_slip=0.4 / 5.0,
        direction=direction_of_travel(5.0),
    )
    assert found["wheel.tyre.longitudinal_slip"] == pytest.approx(18.0 * rolling / 5.0 - 1.0)
    assert soil.load == pytest.approx(found["wheel.tyre.normal_force"], rel=1e-9)
    assert rate[sand_rig["spin_rate"]] == pytest.approx(-soil.torque / SPIN_INERTIA, rel=1e-9)
    assert rate[sand_rig["x_rate"]] == pytest.approx(soil.pull / MASS, rel=1e-9)
    assert rate[sand_rig["y_rate"]] == pytest.approx(soil.side / MASS, rel=1e-9)


def test_a_wheel_above_the_sand_feels_nothing(sand_rig):
    state = sand_rig.state(z=RADIUS + 0.1, x_rate=5.0, spin_rate=20.0)
    found = sand_rig.outputs(state)
    assert found["wheel.sinkage"] == 0.0
    assert found["wheel.tyre.normal_force"] == 0.0
    assert found["wheel.tyre.longitudinal_force"] == 0.0
    assert sand_rig.rate(state)[sand_rig["z_rate"]] == pytest.approx(-GRAVITY)
