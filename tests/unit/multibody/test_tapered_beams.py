"""Tapered beams against closed forms, and against their differential equations solved beside."""

import casadi as ca
import numpy as np
import pytest
from beam_kernels import LENGTH, at_rest, frequencies, kernel_of
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq

from vehicledyn.base.errors import InputError
from vehicledyn.multibody import GROUND, Body
from vehicledyn.multibody.bodies.beam_properties import (
    Material,
    Properties,
    Stiffness,
    tapered_stiffness,
)
from vehicledyn.multibody.bodies.beam_sections import Section
from vehicledyn.multibody.bodies.beam_shapes import assumed_shapes, quadrature
from vehicledyn.multibody.bodies.exact_beam import DIRECTIONS, ExactBeam
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes

pytestmark = pytest.mark.long

DENSITY, YOUNG, POISSON = 2700.0, 70e9, 0.3
WIDE, NARROW = 0.02, 0.008
CONE = {
    "stiffness": None,
    "section": Section(shape="circle", radius=WIDE),
    "end_section": Section(shape="circle", radius=NARROW),
    "material": Material(density=DENSITY, young=YOUNG, poisson=POISSON),
}
LINEAR = {
    "stiffness": Stiffness(
        mass_per_length=2.0, y=50.0, z=80.0, twist=20.0, stretch=5e4, polar=0.01
    ),
    "end_stiffness": Stiffness(
        mass_per_length=0.5, y=10.0, z=30.0, twist=5.0, stretch=2e4, polar=0.002
    ),
}  # fmt: skip


def radius(x):
    return WIDE + (NARROW - WIDE) * x / LENGTH


def bending_stiffness(x):
    return YOUNG * np.pi / 4.0 * radius(x) ** 4


def line_mass(x):
    return DENSITY * np.pi * radius(x) ** 2


def linear(name):
    first, last = (getattr(LINEAR[key], name) for key in ("stiffness", "end_stiffness"))
    return lambda x: first + (last - first) * x / LENGTH


def bending_frequencies(stiffness, mass, count):
    """Return frequencies of the clamped beam, (E I w'')'' = ω² μ w, by shooting [rad/s]."""

    def mismatch(omega):
        def rates(x, y):
            w, slope, moment, shear = y.reshape(4, 2)
            return np.array([slope, moment / stiffness(x), shear, omega**2 * mass(x) * w]).ravel()

        start = np.array([[0, 0], [0, 0], [1, 0], [0, 1]], dtype=float).ravel()
        end = solve_ivp(rates, (0.0, LENGTH), start, method="DOP853", rtol=1e-11, atol=1e-14)
        return np.linalg.det(end.y[:, -1].reshape(4, 2)[2:])

    return roots(mismatch, np.sqrt(stiffness(0.0) / mass(0.0)) / LENGTH**2, count)


def twist_frequencies(stiffness, inertia, count):
    """Return frequencies of (G J ϑ')' + ω² ι ϑ = 0, clamped at the start and free at the end."""

    def mismatch(omega):
        def rates(x, y):
            return [y[1] / stiffness(x), -(omega**2) * inertia(x) * y[0]]

        end = solve_ivp(rates, (0.0, LENGTH), [0.0, 1.0], method="DOP853", rtol=1e-11, atol=1e-14)
        return end.y[1, -1]

    return roots(mismatch, np.sqrt(stiffness(0.0) / inertia(0.0)) / LENGTH, count)


def roots(mismatch, pace, count):
    """Return the first roots of a function of the frequency."""
    found, last = [], 0.05 * pace
    before = mismatch(last)
    while len(found) < count:
        omega = last + 0.5 * pace
        value = mismatch(omega)
        if value * before < 0.0:
            found.append(brentq(mismatch, last, omega, rtol=1e-12))
        last, before = omega, value
    return found


MODELS = [
    ({"model": "modes", "modes": Modes(z=10)}, 1e-6),
    ({"model": "exact", "modes": Modes(z=10)}, 1e-6),
    ({"model": "segments", "segments": 24, "modes": Modes(z=1)}, 2e-5),
]


@pytest.mark.parametrize(("settings", "within"), MODELS)
def test_bending_frequencies_where_stiffness_and_mass_change_linearly(settings, within):
    expected = bending_frequencies(linear("z"), linear("mass_per_length"), 3)
    found = frequencies(kernel_of(**LINEAR, **settings))[:3]
    assert found[:2] == pytest.approx(expected[:2], rel=within)
    assert found[2] == pytest.approx(expected[2], rel=30 * within)


def test_bending_frequencies_of_a_cone():
    expected = bending_frequencies(bending_stiffness, line_mass, 3)
    found = frequencies(kernel_of(**CONE, modes=Modes(z=11)))[:3]
    assert found == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("model", ["modes", "segments"])
def test_frequencies_of_twist(model):
    expected = twist_frequencies(linear("twist"), linear("polar"), 2)
    settings = {"modes": Modes(twist=8)} | ({"segments": 24} if model == "segments" else {})
    found = frequencies(kernel_of(**LINEAR, model=model, **settings))[:2]
    assert found == pytest.approx(expected, rel=1e-7 if model == "modes" else 1e-5)


@pytest.mark.parametrize("model", ["modes", "exact", "segments"])
def test_deflection_of_a_heavy_cone_with_a_weight_at_its_end(model):
    """∫ M (L - x)/(E I) dx; F L³/(3 E I) r/r_end of the thick end is the share of the weight."""
    tip, g = Body("load", "beam.tip", mass=50.0), 1e-3
    given = CONE | {"model": model, "frames": (0.5,), "segments": 32}
    seen = at_rest(kernel_of(tip, gravity=(0.0, 0.0, -g), modes=Modes(z=12), **given))
    nodes, weights = (LENGTH * item for item in quadrature(30))

    def moment(x):
        beyond = x + (LENGTH - x) * nodes / LENGTH
        lever = (weights * line_mass(beyond) * (beyond - x)).sum() * (LENGTH - x) / LENGTH
        return g * (50.0 * (LENGTH - x) + lever)

    bent = [moment(x) * (LENGTH - x) / bending_stiffness(x) for x in nodes]
    light = 50.0 * g * LENGTH**3 / (3.0 * bending_stiffness(0.0)) * WIDE / NARROW
    bent_by_weight = 50.0 * g * (LENGTH - nodes) ** 2 / bending_stiffness(nodes)
    assert weights @ bent_by_weight == pytest.approx(light, rel=1e-12)
    within = 1e-4 if model == "segments" else 1e-6
    assert -seen["beam.tip_z"] == pytest.approx(weights @ bent, rel=within)
    if model == "segments":
        return
    middle = 0.5 * LENGTH
    assert seen["beam.frame_1.moment_y"] == pytest.approx(moment(middle), rel=1e-4)
    stress = moment(middle) * radius(middle) * YOUNG / bending_stiffness(middle)
    assert seen["beam.frame_1.stress"] == pytest.approx(stress, rel=1e-4)
    if model == "modes":
        shear = (moment(middle + 1e-4) - moment(middle - 1e-4)) / 2e-4
        assert seen["beam.frame_1.shear_force_z"] == pytest.approx(shear, rel=1e-3)


def test_mass_and_centre_of_mass_of_a_cone():
    beam = Beam("beam", body=GROUND, length=LENGTH, modes=Modes(z=1), **CONE)
    root = beam.added_bodies()[0]
    square = WIDE**2 + WIDE * NARROW + NARROW**2
    assert float(root.mass) == pytest.approx(DENSITY * np.pi * LENGTH * square / 3.0, rel=1e-14)
    centre = LENGTH / 4.0 * (WIDE**2 + 2.0 * WIDE * NARROW + 3.0 * NARROW**2) / square
    assert float(root.com[0]) == pytest.approx(centre, rel=1e-13)
    parts = Beam(
        "beam", body=GROUND, length=LENGTH, model="segments", segments=6, modes=Modes(z=1), **CONE
    ).added_bodies()
    parts = [body for body in parts if "segment" in body.name]
    assert sum(float(p.mass) for p in parts) == pytest.approx(float(root.mass), rel=1e-13)
    places = np.cumsum([0.0, *(float(p.at[0]) for p in parts[1:])])
    moment = sum(float(p.mass) * (x + float(p.com[0])) for p, x in zip(parts, places, strict=True))
    assert moment / float(root.mass) == pytest.approx(centre, rel=1e-13)


def test_a_large_deflection_of_a_tapered_beam():
    """Against the elastica with E I(x): (E I θ')' = F cos θ, clamped, no moment at its end."""
    force, stiffness = 60.0, linear("z")

    def rates(x, y):
        angle, moment = y[:2]
        return np.array(
            [moment / stiffness(x), force * np.cos(angle), np.cos(angle), np.sin(angle)]
        )

    def ends(first, last):
        return np.array([first[0], last[1], first[2], first[3]])

    grid = np.linspace(0.0, LENGTH, 50)
    angle, _, x, z = solve_bvp(rates, ends, grid, np.zeros((4, 50)), tol=1e-9).y[:, -1]
    assert np.degrees(abs(angle)) > 40.0
    shapes = assumed_shapes(8, 2)
    made = {d: assumed_shapes(8 if d == "z" else 0, 2 if d in "yz" else 1) for d in DIRECTIONS}
    start, end = LINEAR["stiffness"], LINEAR["end_stiffness"]
    numbers = Properties(start, lambda place: tapered_stiffness(start, end, place))
    beam = ExactBeam("beam", LENGTH, numbers, made)
    q = ca.SX.sym("q", shapes.count)
    tip = beam.deflection(1.0, list(ca.vertsplit(q))).position
    energy = beam.energy(list(ca.vertsplit(q))) + force * tip[2]
    slope, matrix = ca.gradient(energy, q), ca.hessian(energy, q)[0]
    both, value = ca.Function("both", [q], [slope, matrix]), np.zeros(shapes.count)
    for _ in range(20):
        first, second = (np.array(item) for item in both(value))
        value = value - np.linalg.solve(second, first).ravel()
    found = np.array(ca.Function("tip", [q], [ca.vertcat(*(tip[k] for k in range(3)))])(value))
    assert found.ravel() == pytest.approx([x, 0.0, z], rel=1e-5, abs=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"end_section": Section(shape="circle", radius=0.1)}, "give end_stiffness"),
        (CONE | {"end_stiffness": Stiffness(mass_per_length=1.0)}, "give end_section"),
        (
            CONE | {"end_section": Section(shape="tube", radius=0.1, thickness=0.01)},
            "is tube where the start is circle",
        ),
    ],
)  # fmt: skip
def test_ends_that_do_not_go_with_the_start_are_refused(change, words):
    settings = {"length": LENGTH, "stiffness": LINEAR["stiffness"], "modes": Modes(z=2)} | change
    with pytest.raises(InputError, match=words):
        Beam("beam", body=GROUND, **settings)
