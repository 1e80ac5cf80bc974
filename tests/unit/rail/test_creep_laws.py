"""Every creep law of the catalogue: signs, friction, symmetry, slopes; and each law's own facts."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import vehicledyn.rail.creep
from vehicledyn.base.registry import find, kinds
from vehicledyn.rail.creep import creep_law, polach
from vehicledyn.rail.creep.creep_law import CreepContact, kalker_forces
from vehicledyn.rail.creep.kalker import creep_coefficients
from vehicledyn.rail.creep.vermeulen import vermeulen_factors
from vehicledyn.rail.geometry.hertz import ContactEllipse, hertz
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import ParameterTable

assert vehicledyn.rail.creep
LOAD, FRICTION, SHEAR, POISSON = 5e4, 0.3, 8.2e10, 0.28
EXAMPLES = {
    "carter": {},
    "fastsim": {"strips": 6, "elements": 6},
    "fastsim_1982": {"strips": 6, "elements": 6},
    "haines_ollerton": {},
    "johnson_vermeulen": {},
    "linear": {},
    "linear_smooth": {},
    "polach": {},
    "shen_hedrick_elkins": {},
    "tanh": {"c11": 4.23, "c22": 3.70, "c23": 1.49},
}
KINDS = sorted(EXAMPLES)
WITHOUT_SPIN = {"johnson_vermeulen"}
OWN_STIFFNESS = {"johnson_vermeulen"}
NO_MOMENT = {"johnson_vermeulen", "polach", "tanh"}


def law(kind, **changes):
    return find("creep", kind)(**({"friction": FRICTION} | EXAMPLES[kind] | changes))


def contact(xi, eta, phi, *, load=LOAD, a=5e-3, b=5e-3, speed=0.0):
    return CreepContact(xi, eta, phi, load, ContactEllipse(a, b), SHEAR, POISSON, speed)


def vector(law_or_kind, *felt, **more):
    used = law(law_or_kind) if isinstance(law_or_kind, str) else law_or_kind
    forces = used.forces(contact(*felt, **more))
    return np.array([float(f) for f in (forces.longitudinal, forces.lateral, forces.spin_moment)])


def test_every_law_has_an_example():
    assert set(kinds("creep")) == set(EXAMPLES)


@pytest.mark.parametrize("kind", KINDS)
def test_forces_oppose_creep_and_spin(kind):
    for size in (1e-5, 1e-3, 0.1):
        assert vector(kind, size, 0.0, 0.0)[0] < 0.0 < vector(kind, -size, 0.0, 0.0)[0]
        assert vector(kind, 0.0, size, 0.0)[1] < 0.0 < vector(kind, 0.0, -size, 0.0)[1]
        if kind not in WITHOUT_SPIN:
            assert vector(kind, 0.0, 0.0, size / 5e-3)[1] < 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_sliding_gives_no_energy(kind):
    rng = np.random.default_rng(3)
    for _ in range(60):
        xi, eta = 10.0 ** rng.uniform(-5, -1) * rng.normal(size=2)
        x, y, _ = vector(kind, xi, eta, 0.0, a=rng.uniform(1e-3, 1e-2))
        assert x * xi + y * eta <= 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_friction_is_never_exceeded(kind):
    rng = np.random.default_rng(4)
    for _ in range(150):
        xi, eta, turn = 10.0 ** rng.uniform(-6, 1) * rng.normal(size=3)
        load, a, b = 10.0 ** rng.uniform([-9, -4, -4], [5, -2, -2])
        x, y, _ = vector(kind, xi, eta, turn / 5e-3, load=load, a=a, b=b)
        assert math.hypot(x, y) <= FRICTION * load * (1.0 + 1e-12)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("felt", [(1e-3, 5e-4, 0.3), (-2e-4, 3e-3, -1.0), (0.05, -0.02, 2.0)])
def test_left_and_right_are_mirrored(kind, felt):
    xi, eta, phi = felt
    mirrored = vector(kind, xi, -eta, -phi)
    assert mirrored * [1, -1, -1] == pytest.approx(vector(kind, *felt), rel=1e-11, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_braking_and_driving_are_mirrored(kind):
    for felt in ((1e-3, 5e-4, 0.3), (0.05, 0.02, -2.0)):
        xi, eta, phi = felt
        driven = vector(kind, -xi, eta, phi)
        assert driven * [-1, 1, 1] == pytest.approx(vector(kind, *felt), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_no_load_no_force(kind):
    assert np.all(vector(kind, 0.01, 0.02, 0.5, load=0.0) == 0.0)
    assert np.abs(vector(kind, 0.01, 0.02, 0.5, load=1e-6)).max() < 1e-6


@pytest.mark.parametrize("kind", sorted(set(KINDS) - OWN_STIFFNESS - {"tanh"}))
@pytest.mark.parametrize(("a", "b"), [(5e-3, 5e-3), (3e-3, 6e-3), (7e-3, 2e-3)])
def test_small_creep_is_kalkers(kind, a, b):
    for felt in ((1e-8, 0.0, 0.0), (0.0, 1e-8, 0.0), (0.0, 0.0, 1e-6)):
        linear = kalker_forces(contact(*felt, a=a, b=b))
        wanted = np.array([float(linear.longitudinal), float(linear.lateral)])
        size = np.abs(wanted).max()
        assert vector(kind, *felt, a=a, b=b)[:2] == pytest.approx(wanted, abs=2e-3 * size)


@pytest.mark.parametrize("kind", KINDS)
def test_values_and_slopes_are_finite_everywhere(kind):
    names = ("xi", "eta", "phi", "load", "a", "b", "speed")
    xi, eta, phi, load, a, b, speed = symbols = [ops.symbol(name) for name in names]
    felt = CreepContact(xi, eta, phi, load, ContactEllipse(a, b), SHEAR, POISSON, speed)
    forces = law(kind).forces(felt)
    column = ops.column([forces.longitudinal, forces.lateral, forces.spin_moment])
    value = ops.numeric(symbols, column)
    slope = ops.numeric(symbols, ops.jacobian(column, ops.column(symbols)))
    for creep in ((0, 0, 0), (1e-12, 0, 0), (0, 1e-3, 0), (0, 0, 1.0), (1.0, -1.0, 300.0)):
        for pressed in (0.0, 1e-9, 1.0, 1e5):
            for axes in ((5e-3, 5e-3), (1e-6, 1e-6), (1e-2, 1e-3)):
                there = (*creep, pressed, *axes, 10.0)
                assert np.isfinite(value(*there)).all(), there
                assert np.isfinite(slope(*there)).all(), there
    # The slope at zero creep is that of the linear theory, not that of a regularisation.
    steepest = 1.4 * 7.0 * SHEAR * 25e-6
    assert np.abs(slope(0, 0, 0, LOAD, 5e-3, 5e-3, 0.0)[:2, :2]).max() < steepest


@pytest.mark.parametrize("kind", KINDS)
def test_continuous_along_random_lines(kind):
    symbols = [ops.symbol(name) for name in ("xi", "eta", "phi")]
    forces = law(kind).forces(contact(*symbols))
    value = ops.numeric(symbols, ops.column([forces.longitudinal, forces.lateral]))
    rng = np.random.default_rng(1)
    for start, stop in rng.normal(size=(4, 2, 3)) * [2e-3, 2e-3, 0.4]:
        along = start + np.linspace(0.0, 1.0, 401)[:, None] * (stop - start)
        found = value(*along.T[:, None])
        assert np.abs(np.diff(found, axis=1)).max() < 0.03 * FRICTION * LOAD


@pytest.mark.parametrize("kind", KINDS)
def test_parameters_may_be_symbols(kind):
    table = ParameterTable()
    symbolic = table.add_set("creep", law(kind))
    force = symbolic.forces(contact(1e-3, 5e-4, 0.3)).lateral
    found = ops.numeric([entry.symbol for entry in table.entries], ops.column([force]))
    value = found(*[entry.value for entry in table.entries])[0, 0]
    assert value == pytest.approx(vector(kind, 1e-3, 5e-4, 0.3)[1], rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_a_stiffness_factor_scales_small_creep_only(kind):
    soft = law(kind, stiffness_factor=0.5)
    assert vector(soft, 1e-7, 0, 0)[0] == pytest.approx(0.5 * vector(kind, 1e-7, 0, 0)[0], rel=1e-3)
    assert vector(soft, 0.5, 0, 0)[0] == pytest.approx(vector(kind, 0.5, 0, 0)[0], rel=0.01)


@pytest.mark.parametrize("kind", sorted(set(KINDS) - NO_MOMENT))
def test_spin_moment_opposes_spin(kind):
    for phi in (0.01, 0.5, 5.0):
        assert vector(kind, 0.0, 0.0, phi)[2] < 0.0 < vector(kind, 0.0, 0.0, -phi)[2]
    assert vector(kind, 0.0, 1e-6, 0.0)[2] > 0.0


@pytest.mark.parametrize(
    ("module", "name"),
    [
        (creep_law, "LIMIT_FLOOR"),
        (creep_law, "RELATIVE_FLOOR"),
        (polach, "CREEP_FLOOR"),
    ],
)
def test_halving_a_floor_moves_nothing(module, name, monkeypatch):
    before = {kind: vector(kind, 1e-3, 5e-4, 0.3) for kind in KINDS}
    monkeypatch.setattr(module, name, 0.5 * getattr(module, name))
    for kind, wanted in before.items():
        assert vector(kind, 1e-3, 5e-4, 0.3) == pytest.approx(wanted, rel=1e-9)


def test_linear_is_cut_off_where_friction_is_reached():
    linear = float(kalker_forces(contact(1e-3, 0, 0)).longitudinal)
    assert vector("linear", 1e-3, 0, 0)[0] == pytest.approx(linear, rel=1e-12)
    assert abs(linear) < FRICTION * LOAD
    assert vector("linear", 1e-2, 0, 0)[0] == pytest.approx(-FRICTION * LOAD, rel=1e-12)


def test_smooth_linear_law_at_its_knee():
    stiffness = SHEAR * 25e-6 * float(creep_coefficients(1.0, POISSON).longitudinal)
    knee = FRICTION * LOAD / stiffness
    assert vector("linear_smooth", knee, 0, 0)[0] == pytest.approx(
        -FRICTION * LOAD / math.sqrt(2.0), rel=1e-12
    )


def test_cubic_of_shen_hedrick_elkins():
    limit = FRICTION * LOAD
    for felt in ((1e-3, 0.0, 0.0), (0.0, 1e-3, 0.5), (1e-3, -2e-3, 0.4)):
        linear = kalker_forces(contact(*felt))
        x, y = float(linear.longitudinal), float(linear.lateral)
        rho = math.hypot(x, y) / limit
        bent = rho - rho**2 / 3.0 + rho**3 / 27.0 if rho < 3.0 else 1.0
        found = vector("shen_hedrick_elkins", *felt)[:2]
        assert found == pytest.approx(limit * bent / rho / limit * np.array([x, y]), rel=1e-9)
    assert vector("shen_hedrick_elkins", 0.02, 0, 0)[0] == pytest.approx(-limit, rel=1e-12)


def test_haines_ollerton_is_the_sum_of_its_strips():
    """Tractions μ p₀/a (√(a_y² - x²) - √(a'² - (x - d)²)), the second where the strip sticks."""
    limit = FRICTION * LOAD

    def strip(y, depth):
        half = math.sqrt(1.0 - y * y)
        stuck = max(half - depth, 0.0)
        return 0.5 * math.pi * (half**2 - stuck**2)

    for depth in (0.05, 0.4, 0.9, 1.0):
        kink = math.sqrt(1.0 - depth**2)
        parts = [
            quad(strip, *ends, args=(depth,), epsrel=1e-12)[0] for ends in ((0, kink), (kink, 1))
        ]
        wanted = limit * 2.0 * sum(parts) / (2.0 * math.pi / 3.0)
        slope = float(kalker_forces(contact(1e-3, 0, 0)).longitudinal) / 1e-3
        xi = 0.75 * math.pi * depth * limit / slope
        assert vector("haines_ollerton", xi, 0, 0)[0] == pytest.approx(wanted, rel=1e-9)


def test_carter_on_a_contact_that_is_long_across():
    """ξ = (μ a/R) (1 - √(1 - Q/(μ N))) of cylinders, with N = π a² E/(8 R (1 - ν²)) a width.

    Each strip of a slender ellipse is such a cylinder; the mean of the strips' a is π/4 of its a.
    """
    a, b = 0.5e-3, 5e-3
    stiffness = 0.25 * np.pi**2 * SHEAR * a * b / (1.0 - POISSON)
    for part in (0.02, 0.3, 0.7, 0.95):
        xi = 2.0 * FRICTION * LOAD / stiffness * (1.0 - np.sqrt(1.0 - part))
        found = -vector("carter", xi, 0.0, 0.0, a=a, b=b)[0] / (FRICTION * LOAD)
        assert found == pytest.approx(part, rel=0.02)
    assert vector("carter", 0.1, 0.0, 0.0)[0] == pytest.approx(-FRICTION * LOAD, rel=1e-9)


def test_vermeulen_and_johnson_on_a_circle():
    """Johnson's (1958) circle: φ = π/4 (1 - 3ν/4), ψ = π/4 (1 - ν/4)."""
    limit = FRICTION * LOAD
    for felt, factor in (((1e-3, 0, 0), 1 - 0.75 * POISSON), ((0, 1e-3, 0), 1 - 0.25 * POISSON)):
        tau = 4.0 * SHEAR * 25e-6 * 1e-3 / (limit * factor)
        wanted = -limit * (1.0 - (1.0 - tau / 3.0) ** 3)
        assert vector("johnson_vermeulen", *felt).min() == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("s", [0.01, 0.3, 0.999, 1.0, 1.001, 2.0, 30.0])
def test_vermeulens_factors_are_the_integrals(s):
    def root(angle):
        return math.sqrt(math.cos(angle) ** 2 + (s * math.sin(angle)) ** 2)

    end, options = 0.5 * math.pi, {"epsabs": 1e-13, "limit": 500}
    b = quad(lambda t: math.cos(t) ** 2 / root(t), 0.0, end, **options)[0]
    c = quad(lambda t: (math.sin(t) * math.cos(t)) ** 2 / root(t) ** 3, 0.0, end, **options)[0]
    shear = 0.3 * s * s * c
    phi, psi = map(float, vermeulen_factors(s, 0.3))
    assert phi == pytest.approx(0.7 * b + shear, rel=1e-9)
    assert psi == pytest.approx(b - shear, rel=1e-9)


def test_polach_in_one_direction():
    """The formula of 1999 by hand, pure longitudinal creep."""
    c11 = float(creep_coefficients(1.0, POISSON).longitudinal)
    limit, xi = FRICTION * LOAD, 2e-3
    epsilon = SHEAR * math.pi * 25e-6 * c11 * xi / (4.0 * limit)
    wanted = -2.0 * limit / math.pi * (epsilon / (1.0 + epsilon**2) + math.atan(epsilon))
    assert vector("polach", xi, 0, 0)[0] == pytest.approx(wanted, rel=1e-9)


def test_polach_on_wet_rail_has_its_maximum_at_large_creep():
    """A falling friction with k_S < k_A: the force rises, then falls with sliding."""
    wet = law(
        "polach",
        adhesion_reduction=0.3,
        slip_reduction=0.1,
        friction_ratio=0.4,
        friction_decay=0.2,
    )
    pull = [-vector(wet, xi, 0, 0, speed=20.0)[0] for xi in (0.005, 0.05, 0.5)]
    assert pull[0] < pull[1] > pull[2]
    sliding = FRICTION * LOAD * (0.6 * math.exp(-0.2 * 20.0 * 0.5) + 0.4)
    assert 0.9 * sliding < pull[2] < sliding


@pytest.mark.parametrize("spin", [0.0, 0.05])
def test_polach_has_a_slope_at_zero_creep(spin):
    """That of the linear theory along and across; small creep in any direction follows it."""
    symbols = [ops.symbol(name) for name in ("xi", "eta")]
    forces = law("polach").forces(contact(*symbols, spin, a=3e-3, b=6e-3))
    column = ops.column([forces.longitudinal, forces.lateral])
    slope = ops.numeric(symbols, ops.jacobian(column, ops.column(symbols)))(0.0, 0.0)
    kalker, stiffness = creep_coefficients(0.5, POISSON), SHEAR * 18e-6
    wanted = -stiffness * np.diag([float(kalker.longitudinal), float(kalker.lateral)])
    assert np.array(slope) == pytest.approx(wanted, abs=2e-3 * np.abs(wanted).max())
    still = vector("polach", 0.0, 0.0, spin, a=3e-3, b=6e-3)[:2]
    for angle in np.linspace(0.0, 3.0, 7):
        creep = 2e-9 * np.array([math.cos(angle), math.sin(angle)])
        moved = vector("polach", *creep, spin, a=3e-3, b=6e-3)[:2] - still
        assert moved == pytest.approx(np.array(slope) @ creep, abs=2e-3 * np.linalg.norm(moved))


def askew(used, size, spin=0.0):
    """Return by what part forces of creepages askew miss the sum of those along and across."""
    shape = {"a": 3e-3, "b": 6e-3}
    still, x, y = (
        vector(used, *felt, spin, **shape)[:2] for felt in ((0, 0), (size, 0), (0, size))
    )
    missed = 0.0
    for angle in np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False):
        c, s = math.cos(angle), math.sin(angle)
        whole = vector(used, size * c, size * s, spin, **shape)[:2] - still
        summed = (x - still) * c + (y - still) * s
        missed = max(missed, np.abs(whole - summed).max() / np.abs(whole).max())
    return missed


@pytest.mark.parametrize("kind", KINDS)
def test_a_law_that_is_not_linear_in_small_creepages_says_so(kind):
    used = law(kind)
    assert bool(askew(used, 1e-5) > 1e-2) is bool(used.bends_at_rest)


@pytest.mark.parametrize("spin", [0.0, 0.05])
def test_polach_is_linear_below_a_creepage_that_is_given(spin):
    """There it is Kalker's theory, some 10 % from the law's own formula; far above it is that."""
    smooth = law("polach", linear_below=1e-4)
    assert askew(law("polach"), 2e-6, spin) > 0.09 > 0.01 > askew(smooth, 2e-6, spin)
    felt = (4e-6, 3e-6)
    linear = kalker_forces(contact(*felt, 0.0))
    wanted = [float(linear.longitudinal), float(linear.lateral)]
    assert vector(smooth, *felt, 0.0)[:2] == pytest.approx(wanted, rel=5e-3)
    assert vector(smooth, 2.4e-3, 1.8e-3, spin) == pytest.approx(
        vector("polach", 2.4e-3, 1.8e-3, spin), rel=2e-4
    )


def test_polach_opposes_spin_by_its_side_force():
    small = vector("polach", 0.0, 0.0, 1e-4)[1]
    kalker = kalker_forces(contact(0.0, 0.0, 1e-4))
    assert small == pytest.approx(float(kalker.lateral), rel=1e-3)


def wheelset_ellipse(load, curvature_sum):
    """Return the ellipse of the wheelset problem, c³ = 3 N (1 - ν) E/(2 π G (A + B) √g).

    a = c √g and b = c/√g, with g the ratio of the axes and E the elliptic integral for it.
    """
    g, integral, modulus = 0.7115218, 1.3537956, 7.92e10
    c = (1.5 * load * 0.72 * integral / (math.pi * modulus * curvature_sum * math.sqrt(g))) ** (
        1.0 / 3.0
    )
    return ContactEllipse(c * math.sqrt(g), c / math.sqrt(g))


def test_tanh_is_the_law_of_the_wheelset_problem():
    wheelset = law("tanh", friction=0.12, c11=4.72772197, c22=4.27526987, c23=1.97203505)
    load, xi, eta, phi, g = 80.0, 1e-3, -4e-4, 0.25, 7.92e10
    felt = CreepContact(xi, eta, phi, load, wheelset_ellipse(load, 13.3), g, 0.28)
    forces = wheelset.forces(felt)
    c = (3.0 * load * 0.72 * 1.3537956 / (2.0 * math.pi * 13.3 * g * math.sqrt(0.7115218))) ** (
        1 / 3
    )
    w = 0.12 * load
    x = -w * math.tanh(g * c**2 * 4.72772197 * xi / w)
    y = -w * math.tanh((g * c**2 * 4.27526987 * eta + g * c**3 * 1.97203505 * phi) / w)
    back = min(1.0, w / math.hypot(x, y))
    assert float(forces.longitudinal) == pytest.approx(x * back, rel=1e-9)
    assert float(forces.lateral) == pytest.approx(y * back, rel=1e-9)


def test_the_wheelset_problems_ellipse_is_hertzs():
    """Its two constants are those of one and the same ellipse, that of its own curvatures.

    Cone of angle δ and radius r on a circle of radius R: A = cos δ/(2 r), B = 1/(2 R); E* of
    equal bodies is G/(1 - ν).
    """
    a, b = 0.5 * math.cos(0.0262) / 0.1, 0.5 / 0.06
    exact = hertz(a, b, 7.92e10 / 0.72).ellipse(80.0)
    theirs = wheelset_ellipse(80.0, a + b)
    area, own = (e.semi_axis_x * e.semi_axis_y for e in (exact, theirs))
    assert own == pytest.approx(area, rel=1e-4)
    assert exact.semi_axis_y / exact.semi_axis_x == pytest.approx(0.7115218, rel=1e-4)


def test_a_law_names_what_is_missing_and_what_is_wrong():
    with pytest.raises(ValueError, match="friction"):
        find("creep", "polach")()
    with pytest.raises(ValueError, match="strips"):
        law("fastsim", strips=1)
