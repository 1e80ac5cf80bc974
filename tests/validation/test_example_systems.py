"""The example systems against closed forms that know nothing of this program's equations."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyse.linearise import linearise
from vehicledyn.analyses.preparation.prepare import equilibrium_point, nominal_point, prepare
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import TimeLaw, derive

ROOT = Path(__file__).parents[2]
G = 9.81
ALGEBRA = 1e-11
# Central differences of the closed forms with a step of 1e-4: h²/6 f''' and 1e-16/h².
DIFFERENCES = 2e-7
_STEP = 1e-4

pytestmark = pytest.mark.validation


def ready(name, *overrides):
    target = load_model(str(ROOT / "systems" / f"{name}.yaml"), overrides)
    return prepare(target, backend="auto", progress=lambda *_: None)


def seen(prepared, state, time=0.0):
    """Rates of the states and all channels at a state, by name."""
    kernel, e = prepared.kernel, prepared.equations
    unknowns = kernel.solve_unknowns(time, state, np.array([u.start for u in e.unknowns]))
    rates = dict(zip((s.name for s in e.states), kernel.rates(time, state, unknowns), strict=True))
    outputs = kernel.outputs(time, state, unknowns)
    return rates, dict(zip((c.name for c in e.channels), outputs, strict=True))


@pytest.mark.parametrize("seed", range(5))
def test_double_pendulum_has_the_textbook_accelerations(seed):
    """(1/3 + 1) a'' + ... with angles of the rods to the vertical, Lagrange's equations."""
    prepared = ready("double_pendulum", "length=0.7 m", "mass=2.5 kg")
    rng, length = np.random.default_rng(seed), 0.7
    first, relative, rate, relative_rate = rng.normal(size=4)
    rates, _ = seen(prepared, np.array([first, relative, rate, relative_rate]))
    second, second_rate = first + relative, rate + relative_rate
    coupling = 0.5 * np.cos(first - second)
    mass = np.array([[4.0 / 3.0, coupling], [coupling, 1.0 / 3.0]])
    swing = 0.5 * np.sin(first - second)
    force = np.array(
        [
            -swing * second_rate**2 - 1.5 * G / length * np.sin(first),
            swing * rate**2 - 0.5 * G / length * np.sin(second),
        ]
    )
    wanted = np.linalg.solve(mass, force)
    assert rates["upper.angle_rate"] == pytest.approx(wanted[0], rel=ALGEBRA)
    assert rates["lower.angle_rate"] == pytest.approx(wanted[1] - wanted[0], rel=ALGEBRA)


def slope(function, x):
    return (function(x + _STEP) - function(x - _STEP)) / (2.0 * _STEP)


def acceleration(inertia, potential, force, angle, rate):
    """J q'' + ½ J' q'² + V' = Q, the equation of any mechanism of one freedom."""
    return (
        force(angle, rate) - slope(potential, angle) - 0.5 * slope(inertia, angle) * rate**2
    ) / inertia(angle)


@pytest.mark.parametrize("angle", [0.3, 1.9, -2.2])
def test_slider_crank_has_its_reduced_inertia(angle):
    prepared = ready("slider_crank")
    p = {q.name: q.value for q in prepared.equations.parameters}
    r, rod = p["radius"], p["rod"]

    def sliding(a):
        return r * np.cos(a) + np.sqrt(rod**2 - (r * np.sin(a)) ** 2)

    def tilt(a):
        return -np.arcsin(r * np.sin(a) / rod)

    def centre(a):
        return np.array([0.5 * (r * np.cos(a) + sliding(a)), -0.5 * r * np.sin(a)])

    def inertia(a):
        rod_mass = p["coupler.mass"]
        speed = slope(centre, a)
        return (
            p["crank.inertia"]
            + rod_mass * (speed @ speed + rod**2 / 12.0 * slope(tilt, a) ** 2)
            + p["slider.mass"] * slope(sliding, a) ** 2
        )

    def potential(a):
        gas = 0.5 * p["gas.stiffness"] * (sliding(a) - p["gas.free"]) ** 2
        return gas + p["coupler.mass"] * G * centre(a)[1]

    (state,) = [s.name for s in prepared.equations.states if s.name.endswith("_rate")]
    assert state == "crank.angle_rate"
    start = nominal_point(prepared, 0.0)
    kernel = prepared.kernel
    # Follow the loop from its start to the angle.
    unknowns = start.unknowns
    for a in np.linspace(start.state[0], angle, 60):
        unknowns = kernel.solve_unknowns(0.0, np.array([a, 7.0]), unknowns)
    rates = kernel.rates(0.0, np.array([angle, 7.0]), unknowns)
    outputs = dict(
        zip(
            (c.name for c in prepared.equations.channels),
            kernel.outputs(0.0, np.array([angle, 7.0]), unknowns),
            strict=True,
        )
    )
    assert outputs["slider.position"] == pytest.approx(sliding(angle), rel=ALGEBRA)
    wanted = acceleration(inertia, potential, lambda *_: 0.0, angle, 7.0)
    assert rates[1] == pytest.approx(wanted, rel=DIFFERENCES)


def test_four_bar_closes_as_its_triangles_say_and_loses_what_the_damper_takes():
    prepared = ready("four_bar")
    p = {q.name: q.value for q in prepared.equations.parameters}
    names = [c.name for c in prepared.equations.channels]
    rows = []
    start = nominal_point(prepared, 0.0)
    loaded = load_scenario(ROOT / "scenarios" / "systems" / "four_bar.yaml")
    simulate(
        prepared.kernel,
        loaded.scenario.solver,
        start=0.0,
        stop=1.0,
        state=start.state,
        unknowns=start.unknowns,
        interval=1e-3,
        sink=lambda t, x, z, y: rows.append(y.copy()),
    )
    table = dict(zip(names, np.vstack(rows).T, strict=True))
    crank, total = table["crank.angle"], table["crank.angle"] + table["coupler.angle"]
    # A turn about y takes the first axis to (cos, 0, -sin).
    pin = np.array([p["crank.length"] * np.cos(crank), -p["crank.length"] * np.sin(crank)])
    end = pin + p["coupler.length"] * np.array([np.cos(total), -np.sin(total)])
    gap = end - np.array([[p["ground"]], [0.0]])
    assert np.hypot(*gap) == pytest.approx(p["rocker.length"], rel=1e-11)
    energy = table["energy.kinetic"] + table["energy.gravity"]
    power = -p["damping"] * table["rocker.angle_rate"] ** 2
    work = 1e-3 * (power[1:-1].sum() + 0.5 * (power[0] + power[-1]))
    assert np.ptp(energy) > 0.3
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-4)


def test_quarter_car_has_the_eigenvalues_of_its_two_masses():
    prepared = ready("quarter_car")
    p = {q.name: q.value for q in prepared.equations.parameters}
    ks, cs, kt = p["body.stiffness"], p["body.damping"], p["wheel.stiffness"]
    mass = np.diag([p["wheel.mass"], p["body.mass"]])
    stiffness = np.array([[kt + ks, -ks], [-ks, ks]])
    damping = np.array([[cs, -cs], [-cs, cs]])
    inverse = np.linalg.inv(mass)
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ damping]])
    point = equilibrium_point(prepared, 0.0, "static")
    e, values = prepared.equations, prepared.kernel.parameters
    found = linearise(e, values, 0.0, point.state, point.unknowns)
    wanted = np.sort_complex(np.linalg.eigvals(matrix))
    assert np.sort_complex(np.linalg.eigvals(found.matrix)) == pytest.approx(wanted, rel=1e-9)
    heights = dict(zip((s.name for s in e.states), point.state, strict=True))
    total = p["wheel.mass"] + p["body.mass"]
    assert heights["wheel.height"] == pytest.approx(-total * G / kt, rel=1e-9)


@pytest.mark.parametrize("mass", [250, 4000])
def test_golden_car_has_the_characteristic_polynomial_of_its_four_ratios(mass):
    """(μ λ² + c λ + k + k_t)(λ² + c λ + k) - (c λ + k)², whatever the sprung mass."""
    prepared = ready("golden_car", f"sprung.mass={mass} kg")
    k, tyre, c, ratio = 63.3, 653.0, 6.0, 0.15
    unsprung, sprung, between = [ratio, c, k + tyre], [1.0, c, k], [c, k]
    wanted = np.roots(np.polysub(np.polymul(unsprung, sprung), np.polymul(between, between)))
    point = nominal_point(prepared, 0.0)
    e, values = prepared.equations, prepared.kernel.parameters
    found = np.linalg.eigvals(linearise(e, values, 0.0, point.state, point.unknowns).matrix)
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(wanted), rel=1e-9)


def test_small_car_stands_on_its_wheels_and_is_symmetric():
    prepared = ready("small_car")
    point = equilibrium_point(prepared, 0.0, "static")
    values = prepared.kernel.outputs(0.0, point.state, point.unknowns)
    names = [c.name for c in prepared.equations.channels]
    loads = {n: v for n, v in zip(names, values, strict=True) if n.endswith("normal_force")}
    p = {q.name: q.value for q in prepared.equations.parameters}
    weight = G * (p["body.mass"] + 4.0 * (p["hub.mass"] + p["wheel.mass"]))
    assert sum(loads.values()) == pytest.approx(weight, rel=1e-9)
    moment = p["front.axle"], p["rear.axle"]
    for side in ("left", "right"):
        front, rear = (loads[f"{axle}_{side}.tyre.normal_force"] for axle in ("front", "rear"))
        # Struts along the chassis's height: axles shift by the pitch angle squared only.
        unsprung = G * (p["hub.mass"] + p["wheel.mass"])
        lever = moment[0] * (front - unsprung) + moment[1] * (rear - unsprung)
        assert lever == pytest.approx(0.0, abs=0.01 * weight)
    assert loads["front_left.tyre.normal_force"] == pytest.approx(
        loads["front_right.tyre.normal_force"], rel=1e-9
    )


def test_both_front_wheels_of_the_small_car_steer_the_way_the_gain_says():
    prepared = ready("small_car")
    system = prepared.subject.vehicle.system
    unsteered = replace(system, parts=tuple(p for p in system.parts if p.name != "steer"))
    rack = TimeLaw("steer", prepared.subject.vehicle.rack, lambda _: 0.01)
    equations = derive(unsteered.with_parts(rack))
    kernel = compile_kernel(equations, backend="interpreted")
    state = np.array([s.start for s in equations.states])
    unknowns = kernel.solve_unknowns(0.0, state, np.array([u.start for u in equations.unknowns]))
    values = kernel.outputs(0.0, state, unknowns)
    seen_now = dict(zip((c.name for c in equations.channels), values, strict=True))
    for side in ("left", "right"):
        assert seen_now[f"front_{side}_upright.steer"] == pytest.approx(-0.01 / 0.12, rel=1e-9)


@pytest.mark.parametrize("speed", [2.0, 4.0, 5.0, 8.0])
def test_bicycle_has_the_eigenvalues_of_the_linearised_equations(speed):
    """M q'' + v C1 q' + (g K0 + v² K2) q = 0 after appendix A of Meijaard et al. (2007).

    The formulas are written from memory; that they agree with the derived equations, which
    share nothing with them, is what speaks for both.
    """
    prepared = ready("bicycle", f"parameters.forward_speed={speed} m/s")
    point = nominal_point(prepared, 0.0)
    e, values = prepared.equations, prepared.kernel.parameters
    found = np.linalg.eigvals(linearise(e, values, 0.0, point.state, point.unknowns).matrix)
    wanted = np.linalg.eigvals(whipple(speed))
    for value in wanted:
        assert np.abs(found - value).min() < 1e-9 * (1.0 + abs(value))
    assert np.sum(np.abs(found) > 1e-4) == 4


def whipple(v):
    """Matrix of lean and steer and their rates, from the benchmark's parameters (z down)."""
    w, c, tilt = 1.02, 0.08, np.pi / 10.0
    r_r, m_r, i_rx, i_ry = 0.3, 2.0, 0.0603, 0.12
    x_b, z_b, m_b = 0.3, -0.9, 85.0
    i_b = np.array([[9.2, 0.0, 2.4], [0.0, 11.0, 0.0], [2.4, 0.0, 2.8]])
    x_h, z_h, m_h = 0.9, -0.7, 4.0
    i_h = np.array([[0.05892, 0.0, -0.00756], [0.0, 0.06, 0.0], [-0.00756, 0.0, 0.00708]])
    r_f, m_f, i_fx, i_fy = 0.35, 3.0, 0.1405, 0.28
    m_t = m_r + m_b + m_h + m_f
    x_t = (x_b * m_b + x_h * m_h + w * m_f) / m_t
    z_t = (-r_r * m_r + z_b * m_b + z_h * m_h - r_f * m_f) / m_t
    t_xx = (
        i_rx + i_b[0, 0] + i_h[0, 0] + i_fx + m_r * r_r**2 + m_b * z_b**2 + m_h * z_h**2
        + m_f * r_f**2
    )  # fmt: skip
    t_xz = i_b[0, 2] + i_h[0, 2] - m_b * x_b * z_b - m_h * x_h * z_h + m_f * w * r_f
    t_zz = i_rx + i_b[2, 2] + i_h[2, 2] + i_fx + m_b * x_b**2 + m_h * x_h**2 + m_f * w**2
    m_a = m_h + m_f
    x_a, z_a = (x_h * m_h + w * m_f) / m_a, (z_h * m_h - r_f * m_f) / m_a
    a_xx = i_h[0, 0] + i_fx + m_h * (z_h - z_a) ** 2 + m_f * (r_f + z_a) ** 2
    a_xz = i_h[0, 2] - m_h * (x_h - x_a) * (z_h - z_a) + m_f * (w - x_a) * (r_f + z_a)
    a_zz = i_h[2, 2] + i_fx + m_h * (x_h - x_a) ** 2 + m_f * (w - x_a) ** 2
    s, k = np.sin(tilt), np.cos(tilt)
    u_a = (x_a - w - c) * k - z_a * s
    a_ll = m_a * u_a**2 + a_xx * s**2 + 2.0 * a_xz * s * k + a_zz * k**2
    a_lx = -m_a * u_a * z_a + a_xx * s + a_xz * k
    a_lz = m_a * u_a * x_a + a_xz * s + a_zz * k
    mu = c / w * k
    s_r, s_f = i_ry / r_r, i_fy / r_f
    s_t, s_a = s_r + s_f, m_a * u_a + mu * m_t * x_t
    coupling = a_lx + mu * t_xz
    mass = np.array([[t_xx, coupling], [coupling, a_ll + 2.0 * mu * a_lz + mu**2 * t_zz]])
    k0 = np.array([[m_t * z_t, -s_a], [-s_a, -s_a * s]])
    k2 = np.array([[0.0, (s_t - m_t * z_t) / w * k], [0.0, (s_a + s_f * s) / w * k]])
    c1 = np.array(
        [
            [0.0, mu * s_t + s_f * k + t_xz / w * k - mu * m_t * z_t],
            [-(mu * s_t + s_f * k), a_lz / w * k + mu * (s_a + t_zz / w * k)],
        ]
    )
    inverse = np.linalg.inv(mass)
    below = np.hstack([-inverse @ (G * k0 + v**2 * k2), -inverse @ (v * c1)])
    return np.vstack([np.hstack([np.zeros((2, 2)), np.eye(2)]), below])
