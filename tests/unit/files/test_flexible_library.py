"""Flexible bodies of the library against closed forms and Ritz solutions beside them."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from finite_elements import straight
from scipy.integrate import quad
from scipy.linalg import eigh
from system_texts import equations

from vehicledyn.multibody.elements.flexible.flexible_body import FlexibleBody

SYSTEMS = Path(__file__).parents[3] / "systems"


def free_bending(mass, stiffness, half):
    """Return bending frequencies [Hz] of a free beam, symmetric about its middle, by polynomials.

    ``mass`` are pieces (from, to, density) of one half [m, kg/m].
    """
    shapes = [np.polynomial.Legendre.basis(2 * k, domain=[-half, half]) for k in range(9)]
    points, weights = np.polynomial.legendre.leggauss(30)
    m, k = np.zeros((9, 9)), np.zeros((9, 9))
    for start, end, density in mass:
        x = 0.5 * (start + end) + 0.5 * (end - start) * points
        w = (end - start) * weights  # Both halves.
        values, bent = (np.array([s.deriv(d)(x) for s in shapes]) for d in (0, 2))
        m += density * (values * w) @ values.T
        k += stiffness * (bent * w) @ bent.T
    return np.sqrt(np.abs(eigh(k, m, eigvals_only=True)[1:3])) / (2.0 * np.pi)


def test_car_body_of_the_coach():
    """Its mass and inertia are the rigid coach's, its first vertical bending is at 8.5 Hz."""
    ends = {"bolster_1": 22, "bolster_2": 4}
    file = str(SYSTEMS / "coach_body.npz")
    body = FlexibleBody("body", body="car", file=file, interface=ends, modes=4)
    made, found = body.component_modes, body.flexibility
    assert made.mass == pytest.approx(32000.0, rel=1e-12)
    assert found.inertia == pytest.approx(np.diag([56800.0, 1.97e6, 1.97e6]), rel=1e-9, abs=1e-3)
    assert found.centre == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    middle = (32000.0 - 6.2 * 1750.41067) / 19.0
    assert 2.0 * (9.5**3 * middle + (12.6**3 - 9.5**3) * 1750.41067) / 3.0 == pytest.approx(
        1.97e6, rel=1e-6
    )
    pieces = [(0.0, 9.5, middle), (9.5, 12.6, 1750.41067)]
    wanted = free_bending(pieces, 3.228e9, 12.6)[0]
    frequency = made.frequencies[0] / (2.0 * np.pi)
    assert frequency == pytest.approx(8.5, abs=0.01)
    assert wanted < frequency < 1.003 * wanted
    fine = FlexibleBody("body", body="car", file=file, interface=ends, modes=20).component_modes
    assert fine.frequencies[0] / (2.0 * np.pi) == pytest.approx(wanted, rel=1e-4)


def sunk(folder, text, mass):
    """Return how far the chassis is above the axle under weight, by the linearised system [m]."""
    changed = text.replace("{value: 500 kg", f"{{value: {mass} kg")
    assert changed.count(f"{mass} kg") == 1
    e = equations(folder, changed.replace("value: 9.81 m/s^2", "value: 0.01 m/s^2"))
    n = len(e.states) // 2
    zero = np.zeros(2 * n)
    inputs = [e.time, e.state, e.parameter]
    matrix = ca.Function("a", inputs, [ca.jacobian(e.rate, e.state), e.rate])
    slopes, rate = matrix(0.0, zero, [p.value for p in e.parameters])
    q = -np.linalg.solve(np.array(slopes)[n:, :n], np.array(rate)[n:, 0])
    names = [s.name for s in e.states]
    return q[names.index("chassis.z")] - q[names.index("axle.z")]


@pytest.mark.long
@pytest.mark.parametrize(
    ("stiff", "shapes", "error"), [(1.0, 3, 1e-3), (1.0, 6, 1e-5), (1e4, 3, 3e-6)]
)
def test_leaf_springs_have_the_rate_of_tapered_beams(tmp_path, stiff, shapes, error):
    """Four halves, each in line with its bushing: ∫ (L - x)²/EI dx; stiff ones leave the rubber.

    Three shapes of a beam that tapers to a quarter are a little too stiff, six are exact enough.
    """
    text = (SYSTEMS / "jeep_leaf_springs.yaml").read_text(encoding="utf-8")
    for word, value in (("bending: {value: 2400", 2400), ("end_bending: {value: 600", 600)):
        assert text.count(f" {word} ") == 1
        text = text.replace(f" {word} ", f" {word.split(':')[0]}: {{value: {value * stiff} ")
    text = text.replace("modes: {z: 3}", f"modes: {{z: {shapes}}}")
    rate = 100.0 * 0.01 / (sunk(tmp_path, text, 400) - sunk(tmp_path, text, 500))
    soft, _ = quad(lambda x: (0.55 - x) ** 2 / (2400.0 - 1800.0 * x / 0.55), 0.0, 0.55)
    assert rate == pytest.approx(4.0 / (soft / stiff + 1.0 / 800e3), rel=error)


def bare_wheelset(folder, shapes):
    """Return the equations of the wheelset with a flexible axle without rails and springs."""
    text = (SYSTEMS / "flexible_axle_wheelset.yaml").read_text(encoding="utf-8")
    text = text[: text.index("track: {kind")].replace("modes: {y: 2, z: 2}", shapes)
    text = text[: text.index("springs:")] + text[text.index("drives:") :]
    lines = [line for line in text.splitlines() if "profile: S1002" not in line]
    return equations(folder, "\n".join(lines).replace("    rail_wheels:\n", ""))


def with_wheels():
    """Return frequencies [Hz] of the axle of finite elements with discs at the wheels."""
    section = np.pi * 0.08**2
    second = 0.25 * section * 0.08**2
    bending = 210e9 * second
    given = {"axial": 210e9 * section, "torsion": 2.0 * 80.8e9 * second, "mass": 7850.0 * section}
    density = 7850.0 * section
    axle = straight(1.5, 12, {**given, "bending": (bending, bending), "polar": 1e-6})
    heavy = axle.mass.toarray()
    mass, stub = 0.5 * (1500.0 - 2.0 * density), 0.25 * density
    across = 450.0 - mass * 0.75**2 - 2.0 * density / 6.0
    for node, outwards in ((1, -1.0), (13, 1.0)):
        rows = np.arange(6 * node - 6, 6 * node)
        heavy[rows, rows] += [mass, mass, mass, 60.0, across, across]
        moved = np.eye(3, 6)
        moved[1, 5], moved[2, 4] = 0.125 * outwards, -0.125 * outwards
        turned = np.diag([0.0, 0.0, 0.0, 0.0, 1.0, 1.0]) * stub * 0.25**2 / 12.0
        heavy[np.ix_(rows, rows)] += stub * moved.T @ moved + turned
    squares = eigh(axle.stiffness.toarray(), heavy, eigvals_only=True)
    return np.sqrt(np.abs(squares[6:12])) / (2.0 * np.pi)


@pytest.mark.long
def test_wheelset_with_a_flexible_axle(tmp_path):
    """It weighs as the rigid one; bending is that of finite elements, torsion that of two discs."""
    e = bare_wheelset(tmp_path, "modes: {y: 4, z: 4}")
    n = len(e.states) // 2
    names = [s.name for s in e.states]
    kinetic = e.output[[c.name for c in e.channels].index("energy.kinetic")]
    inputs = [e.time, e.state, e.parameter]
    own = [n + names.index(f"axle.{name}") for name in ("longitudinal", "vertical", "yaw", "roll")]
    mass = ca.Function("m", inputs, [ca.hessian(kinetic, e.state)[0]])
    matrix = ca.Function("a", inputs, [ca.jacobian(e.rate, e.state)])
    at = (0.0, np.zeros(e.state.numel()), [p.value for p in e.parameters])
    inertia = np.diag(np.array(mass(*at)))[own]
    assert inertia == pytest.approx([1500.0, 1500.0, 900.0, 900.0], rel=1e-6)
    values = np.linalg.eigvals(np.array(matrix(*at)))
    found = np.sort(np.abs(values[values.imag > 1.0])) / (2.0 * np.pi)
    for wanted in with_wheels()[:5]:
        assert np.abs(found / wanted - 1.0).min() < 1e-4
    stiffness = 80.8e9 * 0.5 * np.pi * 0.08**4 / 1.5
    torsion = np.sqrt(2.0 * stiffness / 60.0) / (2.0 * np.pi)
    assert np.abs(found / torsion - 1.0).min() < 1e-4
