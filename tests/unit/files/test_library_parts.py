"""Parts of cars in the library, each run by itself: steering, driveline, anti-roll bar."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

SYSTEMS = Path(__file__).parents[3] / "systems"


class Part:
    """A part of the library with its equations."""

    def __init__(self, name, **parameters):
        model, problems = read_system(SYSTEMS / f"{name}.yaml", {"parameters": parameters})
        assert not problems
        self.parameters = model.resolved
        self.equations = derive(build_system(model))
        self.kernel = compile_kernel(self.equations, backend="interpreted")

    def at(self, time=0.0, **states):
        """Return rates and channels by name; dots of states are double underscores."""
        e = self.equations
        given = {name.replace("__", "."): value for name, value in states.items()}
        assert given.keys() <= {s.name for s in e.states}
        x = np.array([given.get(s.name, s.start) for s in e.states])
        z = assemble(self.kernel, time, x, np.array([u.start for u in e.unknowns]))
        rates, outputs = self.kernel.rates(time, x, z), self.kernel.outputs(time, x, z)
        found = {f"d.{s.name}": v for s, v in zip(e.states, rates, strict=True)}
        return found | {c.name: v for c, v in zip(e.channels, outputs, strict=True)}


def test_the_steering_wheel_turns_with_the_rack_and_feels_its_force():
    """x = r φ, and the drive moves rack and column: F = m x'' + (J φ'' + d φ')/r."""
    steering = Part("rack_steering")
    p = steering.parameters
    radius, omega = p["pinion.radius"], 2.0 * np.pi * p["test.frequency"]
    time = 0.3
    move = p["test.amplitude"] * np.exp(1j * omega * time)
    x, rate, acceleration = (move * (1j * omega) ** k for k in range(3))
    found = steering.at(time)
    assert found["rack.displacement"] == pytest.approx(x.imag, rel=1e-12)
    assert found["steering_wheel"] == pytest.approx(x.imag / radius, rel=1e-12)
    torque = p["column.inertia"] * acceleration.imag / radius
    torque += p["column.damping"] * rate.imag / radius
    wanted = p["rack.mass"] * acceleration.imag + torque / radius
    assert found["rack.displacement_force"] == pytest.approx(wanted, rel=1e-10)


def test_the_differential_shares_torque_and_turns_at_the_mean():
    """Torques of both sides are equal, and the drag of the pinion acts on them by the ratio.

    With J of a side, and I = (J_c + i² J_p)/4 of what both turn, the wheels' accelerations are
    J a_l + I (a_l + a_r) = J a_r + I (a_l + a_r) = -i d i (ω_l + ω_r)/4.
    """
    part = Part("open_differential")
    p, rates = part.parameters, (21.0, 35.0)
    found = part.at(left_wheel__spin_rate=rates[0], right_wheel__spin_rate=rates[1])
    assert found["cage.angle_rate"] == pytest.approx(np.mean(rates), rel=1e-12)
    assert found["pinion.angle_rate"] == pytest.approx(p["ratio"] * np.mean(rates), rel=1e-12)
    side = p["flywheel.inertia"] + p["shaft.inertia"]
    both = (p["cage.inertia"] + p["ratio"] ** 2 * p["pinion.inertia"]) / 4.0
    drag = -p["pinion.drag"] * p["ratio"] ** 2 * sum(rates) / 4.0
    wanted = np.linalg.solve([[side + both, both], [both, side + both]], [drag, drag])
    sides = [found[f"d.{name}_wheel.spin_rate"] for name in ("left", "right")]
    assert sides == pytest.approx(wanted, rel=1e-10)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_bar_resists_roll_and_leaves_heave_alone(sign):
    """The bar's force on a hub: its torque times the twist a hub's travel gives, twice over.

    With g the arm's angle over the hub's travel, by differences of the closed link, equal and
    opposite travels twist the bar by 2 g s, so that each hub feels -2 k g² s.
    """
    bar, free = Part("anti_roll_bar"), Part("anti_roll_bar", stiffness="0 N*m/rad")
    travel, step = 1e-5, 1e-4

    def angle(s):
        return bar.at(left__travel=s, right__travel=s)["left_arm.angle"]

    slope = (angle(step) - angle(-step)) / (2.0 * step)
    state = {"left__travel": travel, "right__travel": sign * travel}
    mass = bar.parameters["hub.mass"]
    accelerations = [part.at(**state)["d.left.travel_rate"] for part in (bar, free)]
    difference = accelerations[0] - accelerations[1]
    if sign > 0.0:
        assert difference == pytest.approx(0.0, abs=1e-9)
        return
    p = bar.parameters
    half = 0.5 * np.array([p[f"arm.end.{c}"] - p[f"arm.bearing.{c}"] for c in "xz"])
    inertia = p["arm.inertia"] + p["arm.mass"] * float(half @ half)
    wanted = -2.0 * p["stiffness"] * slope**2 * travel / (mass + inertia * slope**2)
    assert difference == pytest.approx(wanted, rel=1e-3)


def test_the_gearbox_changes_up_and_passes_the_torque_on(tmp_path):
    """In gear the shafts turn by the ratio, and i (T - J_e ω̇_e) accelerates the flywheel."""
    path = tmp_path / "up.yaml"
    path.write_text(
        f"title: Up\nmodel: {SYSTEMS / 'engine_and_gearbox.yaml'}\nduration: 3 s\n"
        "solver: {kind: rk4, step: 1 ms}\noutput: {interval: 10 ms}\n",
        encoding="utf-8",
    )
    run = vd.simulate(path)
    names = ("engine.angle_rate", "propeller.angle_rate", "engine.torque", "selected")
    engine, propeller, torque, gear = (np.asarray(run[name]) for name in names)
    assert gear[-1] == 3.0
    assert (np.diff(gear) >= 0.0).all()
    ratios = 1.0 / np.array([0.265, 0.489, 0.784])
    changes = [0, *(np.flatnonzero(np.diff(gear)) + 1), len(gear)]
    for first, last in pairwise(changes):
        place = (first + 3 * last) // 4  # the clutch has closed long before
        ratio = ratios[int(gear[place]) - 1]
        assert engine[place] == pytest.approx(ratio * propeller[place], rel=2e-3)
        rates = [np.gradient(x, 0.01)[place] for x in (engine, propeller)]
        assert 7.3 * rates[1] == pytest.approx(ratio * (torque[place] - 0.2 * rates[0]), rel=2e-2)


def test_the_transfer_case_shares_alike_and_its_clutch_slows_the_faster_shaft():
    """The input turns at the mean; a sliding clutch of torque T gives J a_f = T = -J a_r."""
    part = Part("transfer_case", clutch={"torque": "60 N*m"})
    found = part.at(front_propeller__angle_rate=30.0, rear_propeller__angle_rate=34.0)
    assert found["input.angle_rate"] == pytest.approx(32.0, rel=1e-12)
    rates = [found[f"d.{name}_propeller.angle_rate"] for name in ("front", "rear")]
    wanted = 60.0 / part.parameters["flywheel.inertia"]
    assert rates == pytest.approx([wanted, -wanted], rel=1e-12)


@pytest.mark.parametrize("travel", [-0.05, 0.0, 0.04])
def test_the_air_spring_carries_its_load_along_a_polytrope(travel):
    """F = A (p (V/(V - A s))^n - p_a) carries F/m - g of the body, s its way down to the axle."""
    part = Part("air_spring_axle")
    p = part.parameters
    found = part.at(chassis__height=0.0, beam__travel=travel)
    area, volume = p["air.area"], p["air.volume"]
    pressure = p["air.load"] / area + p["air.ambient"]
    grown = (volume / (volume - area * travel)) ** p["air.exponent"]
    force = area * (pressure * grown - p["air.ambient"])
    upwards = 2.0 * force / p["sprung.mass"] - 9.81
    assert found["d.chassis.height_rate"] == pytest.approx(upwards, rel=1e-9)


def test_the_trailing_arm_feels_its_wheel_load_by_the_torsion_bar():
    """With the arm level the bar's torque on it is load times length; turned, k more an angle."""
    part = Part("trailing_arm_axle")
    p = part.parameters
    names = ("left_torsion_bar.force", "left_torsion_bar.torque")
    torques = []
    for angle in (0.0, 0.02):
        found = part.at(left_arm__angle=angle)
        torques.append(next(abs(found[name]) for name in names if name in found))
    assert torques[0] == pytest.approx(p["torsion_bar.load"] * p["arm.length"], rel=1e-12)
    assert torques[1] - torques[0] == pytest.approx(p["torsion_bar.stiffness"] * 0.02, rel=1e-9)


def test_the_friction_of_leaf_springs_grows_with_their_load():
    """H = μ (P + k s) with s the travel of the axle below each spring, and F = H z."""
    part = Part("frictional_leaf_spring_axle")
    shares = {"left_leaf_friction__share": 1.0, "right_leaf_friction__share": -0.5}
    found = part.at(axle__beam__travel=0.01, axle__beam__roll=0.02, **shares)
    loads = [32.4e3 + 250e3 * (0.01 + y * 0.02) for y in (0.42, -0.42)]
    forces = [found[f"{side}_leaf_friction.force"] for side in ("left", "right")]
    assert forces == pytest.approx([0.06 * loads[0], -0.03 * loads[1]], rel=1e-12)
