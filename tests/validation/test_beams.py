"""Beams in large and in fast motion against independent solutions."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
import yaml

from vehicledyn.base.errors import NumericalError
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.methods.dop853 import DormandPrince853
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, TimeLaw, derive
from vehicledyn.multibody.elements.external_wrenches import ExternalWrench
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes, Stiffness
from vehicledyn.multibody.elements.flexible.foundation import Foundation
from vehicledyn.multibody.elements.flexible.moving_load import MovingLoad
from vehicledyn.multibody.elements.point_sensors import PointSensor

pytestmark = pytest.mark.validation

ROOT = Path(__file__).parents[2]
REFERENCE = yaml.safe_load((Path(__file__).parent / "data" / "beams.yaml").read_text())


def run(system, solver, stop, interval):
    """Return the times and the channels by name of a motion."""
    equations = derive(system)
    kernel, samples = compile_kernel(equations), []
    simulate(
        kernel, solver, start=0.0, stop=stop, state=np.array([s.start for s in equations.states]),
        unknowns=np.zeros(0), interval=interval,
        sink=lambda t, x, z, y: samples.append((t.copy(), y.copy())),
    )  # fmt: skip
    values = np.vstack([y for _, y in samples])
    names = [channel.name for channel in equations.channels]
    return np.concatenate([t for t, _ in samples]), {n: values[:, k] for k, n in enumerate(names)}


def spin_up(**settings):
    """The beam on a hub of no radius that comes up to speed in 15 s."""
    given = REFERENCE["spin_up"]
    rise, speed = given["rise"], given["speed"]

    def angle(t):
        slow = t**2 / 2 + (rise / 2 / np.pi) ** 2 * (ca.cos(2 * np.pi * t / rise) - 1)
        return ca.if_else(t < rise, speed / rise * slow, speed * (t - rise / 2))

    stiffness = Stiffness(
        mass_per_length=given["mass_per_length"], y=given["bending_stiffness"],
        stretch=given["axial_stiffness"],
    )  # fmt: skip
    hub = Body("hub", GROUND, joints=(Joint("R3", "turn", role="driven"),))
    beam = Beam("beam", body="hub", length=given["length"], stiffness=stiffness, **settings)
    parts = (beam, TimeLaw("spin", "turn", angle))
    return System("spin-up", ParameterTable(), (hub,), parts=parts, gravity=(0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("settings", "step", "tolerance"),
    [
        ({"modes": Modes(y=4, stretch=1)}, 2e-3, 5e-4),
        ({"model": "exact", "modes": Modes(y=4, stretch=1)}, 2e-3, 5e-4),
        ({"model": "segments", "segments": 32, "modes": Modes(y=1)}, 1e-4, 1e-3),
    ],
)
def test_spin_up(settings, step, tolerance):
    """Deflections of the end over the peak, case A."""
    time, seen = run(spin_up(**settings), RungeKutta4(step=step), 20.0, 0.25)
    given = REFERENCE["spin_up"]
    for t, u, v in given["tip"]:
        at = np.argmin(np.abs(time - t))
        for axis, expected in (("x", u), ("y", v)):
            found = seen[f"beam.tip_{axis}"][at]
            assert abs(found - expected) < tolerance * given["peak"]


def test_spin_up_without_stiffening_fails():
    """First-order displacements lose the beam where the speed exceeds its first frequency."""
    system = spin_up(modes=Modes(y=3, stretch=1), stiffening="none")
    with pytest.raises(NumericalError, match="diverges"):
        run(system, RungeKutta4(step=2e-3), 20.0, 0.25)


def settled(system, count=5):
    """Return the channels of the equilibrium under loads that grow with time up to one."""
    equations = derive(system)
    kernel, n = compile_kernel(equations, backend="interpreted"), len(equations.states) // 2
    q, rest, size = np.zeros(n), np.zeros(n), 1e-6

    def push(t, place):
        return kernel.rates(t, np.concatenate([place, rest]), np.zeros(0))[n:]

    for load in np.linspace(1.0 / count, 1.0, count):
        for _ in range(7):
            slopes = [
                (push(load, q + d) - push(load, q - d)) / (2 * size) for d in size * np.eye(n)
            ]
            q = q - np.linalg.solve(np.array(slopes).T, push(load, q))
    found = kernel.outputs(1.0, np.concatenate([q, rest]), np.zeros(0))
    return dict(zip((c.name for c in equations.channels), found, strict=True))


def held(length, stiffness, modes, force, model="exact"):
    """A clamped beam under a dead force at its end."""
    parts = (
        Beam("beam", body=GROUND, length=length, stiffness=stiffness, modes=modes, model=model),
        ExternalWrench("load", body="beam.tip", force=lambda t: [t * f for f in force]),
    )
    return System("held", ParameterTable(), (), parts=parts, gravity=(0.0, 0.0, 0.0))


@pytest.mark.parametrize("row", REFERENCE["elastica"]["rows"])
def test_elastica(row):
    """Up to 87 deg of the end, with eight modes."""
    load, deflection, place = row
    stiffness = Stiffness(mass_per_length=1.0, y=1.0)
    seen = settled(held(1.0, stiffness, Modes(y=8), (0.0, load, 0.0)))
    assert seen["beam.tip_y"] == pytest.approx(deflection, rel=1e-6)
    assert 1.0 + seen["beam.tip_x"] == pytest.approx(place, rel=1e-6)


@pytest.mark.parametrize(
    ("modes", "force"),
    [
        (Modes(y=4), (0.0, 0.5, 0.0)),
        (Modes(y=4, z=4), (0.0, 0.3, 0.4)),
        pytest.param(Modes(y=4, z=4, twist=2), (0.0, 0.4, -0.3), marks=pytest.mark.long),
    ],
)
def test_elastica_by_assumed_modes(modes, force):
    """A round bar bends by a sixth of its length, in any plane; linear curvatures are 2.8 % off."""
    stiffness = Stiffness(mass_per_length=1.0, polar=0.1, y=1.0, z=1.0, twist=0.8)
    seen = settled(held(1.0, stiffness, modes, force, model="modes"))
    along, *aside = (seen[f"beam.tip_{axis}"] for axis in "xyz")
    assert np.hypot(*aside) == pytest.approx(0.162143575658369605, rel=1e-4)
    assert along == pytest.approx(-0.0159189624708374966, rel=1e-3)
    assert aside == pytest.approx(np.hypot(*aside) * np.array(force[1:]) / 0.5, abs=1e-9)


def test_princeton():
    """A narrow strip under an oblique force bends in both planes and twists."""
    p = REFERENCE["princeton"]
    height, width = p["height"], p["width"]
    shear = p["young"] / 2.0 / (1.0 + p["poisson"])
    orders = np.arange(1, 40, 2)
    series = np.sum(np.tanh(orders * np.pi * height / 2.0 / width) / orders**5.0)
    torsion = height * width**3 * (1.0 / 3.0 - 64.0 / np.pi**5 * width / height * series)
    area = height * width
    stiffness = Stiffness(
        mass_per_length=1.0, polar=1e-3, twist=shear * torsion, stretch=p["young"] * area,
        y=p["young"] * width * height**3 / 12.0, z=p["young"] * height * width**3 / 12.0,
        shear_y=5.0 / 6.0 * shear * area, shear_z=5.0 / 6.0 * shear * area,
    )  # fmt: skip
    angle = np.radians(p["angle"])
    force = (0.0, -p["force"] * np.cos(angle), p["force"] * np.sin(angle))
    modes = Modes(y=4, z=4, twist=4, stretch=1, shear_y=1, shear_z=1)
    seen = settled(held(p["length"], stiffness, modes, force))
    found = [seen[f"beam.tip_{axis}"] for axis in "xyz"]
    assert found == pytest.approx(p["end"], rel=1e-4)


def test_spaghetti():
    """A free beam tumbles: places, and the balances of energy and of angular momentum."""
    stiffness = Stiffness(mass_per_length=1.0, y=500.0, stretch=1e4, shear_y=1e4, rotary_y=10.0)
    joints = (
        Joint("T1", "root.x", start=6.0),
        Joint("T2", "root.y"),
        Joint("R3", "root.turn", start=float(np.arctan2(8.0, -6.0))),
    )

    def pulse(t):
        return ca.if_else(t <= 2.5, 1 - ca.cos(2 * ca.pi * t / 2.5), 0)

    parts = (
        Beam("beam", body="root", length=10.0, stiffness=stiffness, model="exact", frames=(0.5,),
             modes=Modes(y=5, stretch=2, shear_y=2)),
        ExternalWrench("load", body="root", force=lambda t: (8 * pulse(t), 0.0, 0.0),
                       torque=lambda t: (0.0, 0.0, -80 * pulse(t))),
        PointSensor("a", body="root"),
        PointSensor("m", body="beam.frame_1", shows=("position",)),
        PointSensor("b", body="beam.tip", shows=("position",)),
    )  # fmt: skip
    system = System(
        "spaghetti", ParameterTable(), (Body("root", GROUND, joints=joints),), parts=parts,
        gravity=(0.0, 0.0, 0.0),
    )  # fmt: skip
    solver = DormandPrince853(relative_tolerance=1e-8, absolute_tolerance=1e-8)
    time, seen = run(system, solver, 5.0, 0.01)
    for row in REFERENCE["spaghetti"]["rows"]:
        at = np.argmin(np.abs(time - row[0]))
        names = [f"{point}.{axis}" for point in "amb" for axis in "xy"]
        found = [seen[name][at] for name in names]
        assert found == pytest.approx(row[1:7], abs=0.005 * 10.0)
        assert seen["energy.kinetic"][at] == pytest.approx(row[7], abs=1.0)
    # Work of the load: its force times the velocity of A, its moment times the turn there.
    push = np.where(time <= 2.5, 1.0 - np.cos(2.0 * np.pi * time / 2.5), 0.0)
    power = push * (8.0 * seen["a.velocity_x"] - 80.0 * seen["root.turn_rate"])
    work = np.trapezoid(power, time)
    total = seen["energy.kinetic"][-1] + seen["beam.strain_energy"][-1]
    assert total == pytest.approx(work, rel=1e-4)
    assert work == pytest.approx(sum(REFERENCE["spaghetti"]["rows"][1][7:9]), rel=2e-3)


def test_moving_force_on_a_foundation():
    """Fryba (1999), chapter 1 with a foundation: the series of a hinged beam, 200 terms."""
    length, bending, line, bed, speed = 2.0, 30.0, 3.0, 500.0, 4.0
    parts = (
        Beam("beam", body=GROUND, length=length, modes=Modes(z=9), basis="sines", frames=(0.5,),
             stiffness=Stiffness(mass_per_length=line, z=bending),
             foundation=Foundation(stiffness=(0.0, 0.0, bed))),
        MovingLoad("load", "beam", place=lambda t: speed * t, force=lambda t: (0.0, 0.0, -1.0)),
        PointSensor("middle", body="beam.frame_1", shows=("position",)),
    )  # fmt: skip
    system = System("bridge", ParameterTable(), (), parts=parts, gravity=(0.0, 0.0, 0.0))
    passage = length / speed
    time, seen = run(system, RungeKutta4(step=passage / 2000), passage, passage / 8)
    n = np.arange(1, 201)[:, None]
    passing = n * np.pi * speed / length
    own = np.sqrt(bending / line * (n * np.pi / length) ** 4 + bed / line)
    swing = (np.sin(passing * time) - passing / own * np.sin(own * time)) / (own**2 - passing**2)
    exact = (2.0 / (line * length) * swing * np.sin(0.5 * n * np.pi)).sum(axis=0)
    assert -seen["middle.z"] == pytest.approx(exact, abs=1e-3 * np.abs(exact).max())


@pytest.mark.parametrize(
    ("alpha", "expected"),
    [(0.25, REFERENCE["moving_force"]["slow"]), (1.0, REFERENCE["moving_force"]["critical"])],
)
def test_moving_force(alpha, expected):
    """Deflection of the middle of a hinged beam over P L³/48 E I, at quarters of the passage."""
    length, bending, line = 2.0, 30.0, 3.0
    period = length / (alpha * np.pi / length * np.sqrt(bending / line))
    parts = (
        Beam("beam", body=GROUND, length=length, modes=Modes(z=9), basis="sines", frames=(0.5,),
             stiffness=Stiffness(mass_per_length=line, z=bending)),
        MovingLoad("load", "beam", place=lambda t: length * t / period,
                   force=lambda t: (0.0, 0.0, -1.0)),
        PointSensor("middle", body="beam.frame_1", shows=("position",)),
    )  # fmt: skip
    system = System("bridge", ParameterTable(), (), parts=parts, gravity=(0.0, 0.0, 0.0))
    _, seen = run(system, RungeKutta4(step=period / 2000), period, period / 4)
    found = -seen["middle.z"][1:] / (length**3 / (48.0 * bending))
    assert found == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize(
    ("case", "stiffening"), [("linear", "none"), ("nonlinear_stiffness", "axial_force")]
)
def test_flexible_slider_crank(tmp_path, case, stiffening):
    """The Test Set's values at 0.1 s: rigid part 1e-6, elastic coordinates 1 %."""
    from reference_cases.motions import record

    model = (ROOT / "systems" / "slider_crank_flexible.yaml").read_text(encoding="utf-8")
    (tmp_path / "model.yaml").write_text(
        model.replace("stiffening: none", f"stiffening: {stiffening}"), encoding="utf-8"
    )
    scenario = (ROOT / "scenarios" / "systems" / "slider_crank_flexible.yaml").read_text()
    path = tmp_path / "scenario.yaml"
    path.write_text(scenario.replace("../../systems/slider_crank_flexible", "model"))
    seen = record(load_scenario(path))
    found = [seen[name][-1] for name in REFERENCE["slider_crank"]["channels"]]
    expected = REFERENCE["slider_crank"][case]
    assert found[:3] == pytest.approx(expected[:3], rel=1e-6)
    assert found[3:] == pytest.approx(expected[3:], rel=1e-2)
