"""Derivatives of limit cycles and of the non-linear critical speed by parameters."""

import math
import re

import numpy as np
import pytest
from cycle_examples import field, from_hopf
from solve_examples import build, symbols

import vehicledyn as vd
from vehicledyn.analyse.periodic.cycles_at import cycle_beside, points_beside
from vehicledyn.analyse.periodic.fine_orbits import FineOrbits
from vehicledyn.analyse.periodic.orbit_slopes import ParameterSlopes, orbit_slopes
from vehicledyn.analyses.sensitivity import cycles
from vehicledyn.analyses.sensitivity.cycle_figures import CycleFigures
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.results.tables.sensitivity_table import read_sensitivity
from vehicledyn.symbolic.equations import Block

pytestmark = pytest.mark.long

CUBIC, QUINTIC, TURN, TWIST = 1.3, -0.8, 2.0, 0.3


def circles():
    """r' = r (μ + a s + b s²), θ' = ω + τ s with s = r² the unknown of a block."""
    t, x, y, m, a, b, w, c, s = symbols("t", "x", "y", "mu", "a", "b", "omega", "tau", "s")
    growth, turn = m + a * s + b * s * s, w + c * s
    return build(
        "circles", time=t, states=[(x, 0.0), (y, 0.0)],
        rates=[x * growth - y * turn, y * growth + x * turn],
        parameters=[(m, 0.0), (a, CUBIC), (b, QUINTIC), (w, TURN), (c, TWIST)],
        outputs=[("x", x + m), ("square", b * s * x * x), ("bent", abs(x + m))],
        unknowns=[(s, 0.0)],
        residuals=[s + s**3 - (x * x + y * y) - (x * x + y * y) ** 3],
        blocks=(Block("square", 0, 1, 1e-12),),
    )  # fmt: skip


def test_circles_follow_their_closed_form():
    """Of μ + a s + b s² = 0: ds/d(μ, a, b) = -(1, s, s²) / (a + 2 b s); T = 2 π / (ω + τ s).

    A channel has kinks of its own, |x + μ|, where the orbit has none.
    """
    model = field(circles(), "mu")
    _, branch = from_hopf(model, -1.0, 0.5)
    value, slopes = -0.2, ParameterSlopes(model, range(5), [0, 1, 2])
    cycles = [cycle_beside(model, p, value) for p in points_beside(branch, value)]
    assert len(cycles) == 2
    for cycle, sign in zip(cycles, (1.0, -1.0), strict=True):
        fine = FineOrbits(model, slopes.asked).at(cycle.orbit)
        figures = CycleFigures(slopes, fine.found.orbit, orbit_slopes(slopes, fine))
        s = (-CUBIC + sign * math.sqrt(CUBIC**2 - 4.0 * QUINTIC * value)) / (2.0 * QUINTIC)
        by = -np.array([1.0, s, s * s, 0.0, 0.0]) / (CUBIC + 2.0 * QUINTIC * s)
        r, turn = math.sqrt(s), TURN + TWIST * s
        by_turn = TWIST * by + [0.0, 0.0, 0.0, 1.0, s]
        for kind, known, slope in (
            ("cycle_period", 2.0 * math.pi / turn, -2.0 * math.pi / turn**2 * by_turn),
            ("cycle_frequency", turn / (2.0 * math.pi), by_turn / (2.0 * math.pi)),
        ):
            number, found = figures.whole(kind)
            assert number == pytest.approx(known, rel=1e-9)
            assert found == pytest.approx(slope, rel=1e-8, abs=1e-9)
        shift, size = np.eye(5)[0], math.hypot(value, r / math.sqrt(2.0))
        side, low = math.asin(value / r), math.sqrt(1.0 - value**2 / s)
        folded = (
            2.0 / math.pi * (r * low + value * side),
            2.0 / math.pi * (low * by / (2.0 * r) + side * shift),
        )
        mean, by_mean = QUINTIC * s * s / 2.0, QUINTIC * s * by + s * s / 2.0 * np.eye(5)[2]
        for kind, channel, known, slope in (
            ("cycle_amplitude", 0, r, by / (2.0 * r)),
            ("cycle_max", 0, r + value, by / (2.0 * r) + shift),
            ("cycle_min", 0, value - r, shift - by / (2.0 * r)),
            ("cycle_mean", 0, value, shift),
            ("cycle_rms", 0, size, (value * shift + by / 4.0) / size),
            ("cycle_mean", 1, mean, by_mean),
            ("cycle_max", 1, 0.0, 0.0 * by),
            ("cycle_amplitude", 1, -mean, -by_mean),
            ("cycle_mean", 2, *folded),
        ):
            number, found = figures.of_channel(kind, channel)
            assert number == pytest.approx(known, rel=1e-9, abs=1e-9), kind
            assert found == pytest.approx(slope, rel=1e-8, abs=1e-9), kind


def test_a_fold_follows_its_closed_form():
    """The circles fold at μ = a² / (4 b)."""
    model = field(circles(), "mu")
    _, branch = from_hopf(model, -1.0, 0.5)
    (fold,) = branch.special
    fine = FineOrbits(model).fold(fold.orbit, fold.tangent)
    assert fine.found.orbit.parameter == pytest.approx(CUBIC**2 / (4.0 * QUINTIC), rel=1e-10)
    found = orbit_slopes(ParameterSlopes(model, range(1, 5)), fine).parameter
    known = [CUBIC / (2.0 * QUINTIC), -((CUBIC / QUINTIC) ** 2) / 4.0, 0.0, 0.0]
    assert found == pytest.approx(known, abs=1e-7)


WHEEL = """\
title: A balance wheel that a wind drives, its small swings lost above a calm
parameters:
  speed: 1.9 m/s
  calm: 2 m/s
  drive: 0.3 N*s^2/rad
  cubic: 1 N*m*s/rad
  quintic: 1
  scale: 1 rad
  stiffness: 4 N*m/rad
gravity: [0, 0, 0]
bodies:
  wheel: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
forces:
  spring: {coordinate: wheel.angle, force: -stiffness * position}
  air:
    coordinate: wheel.angle
    force: "(drive * (speed - calm) + cubic * ((position / scale)**2
      - quintic * (position / scale)**4)) * rate"
"""


def effects(found):
    """Return the change of each figure by a relative one of each parameter, both by name."""
    names = [str(name) for name in found["parameter"].values]
    sizes = found["parameter_value"].values
    rows = zip(
        found["figure"].values, found["figure_value"].values, found["figure_slope"].values,
        strict=True,
    )  # fmt: skip
    return {
        str(name): (float(value), dict(zip(names, slope * sizes / value, strict=True)))
        for name, value, slope in rows
    }


def test_a_wheel_swings_by_its_scale(tmp_path):
    """In u = quintic (angle / scale)² the air knows cubic / quintic alone."""
    path = tmp_path / "wheel.yaml"
    path.write_text(WHEEL, encoding="utf-8")
    of = ["cycle_amplitude(wheel.angle)", "cycle_rms(wheel.angle_rate)", "cycle_period"]
    found = effects(vd.sensitivity(path, of, save_to=tmp_path / "s.h5"))
    assert [name.partition(".")[0] for name in found] == ["cycle_1"] * 3 + ["cycle_2"] * 3
    small, large = (found[f"cycle_{k}.amplitude(wheel.angle)"] for k in (1, 2))
    assert small[0] < large[0]
    for name, (_, by) in found.items():
        power = 0.0 if "period" in name else 1.0
        assert by["scale"] == pytest.approx(power, abs=1e-9)
        assert by["quintic"] == pytest.approx(-power / 2.0 - by["cubic"], abs=1e-9)
    found = effects(vd.sensitivity(path, "nonlinear_critical_speed"))
    speed, by = found["nonlinear_critical_speed"]
    assert speed == pytest.approx(2.0 - 1.0 / (8.0 * 0.3), rel=1e-3), "by averaging"
    assert by["quintic"] == pytest.approx(-by["cubic"], rel=1e-9)
    assert by["drive"] == pytest.approx(2.0 / speed - 1.0, rel=1e-9)
    assert by["calm"] == pytest.approx(2.0 / speed, rel=1e-9)
    assert by["speed"] == 0.0


STAND = WHEEL.replace("scale: 1 rad", "scale: 1 rad\n  offset: 0.2 m").replace(
    "forces:", "  stand: {joints: [T1 place], mass: 1 kg}\ninitial: {START}\nforces:"
)


def test_what_a_cycle_does_not_move_follows_where_it_is_written_to_stand(tmp_path):
    path = tmp_path / "wheel.yaml"
    path.write_text(STAND.replace("START", "stand.place: offset * speed / (1 m/s)"), "utf-8")
    found = vd.sensitivity(path, "cycle_mean(stand.place)", ["offset", "speed"])
    assert found["figure_value"].values == pytest.approx([0.38] * 2, rel=1e-12)
    assert found["figure_slope"].values == pytest.approx(np.array([[1.9, 0.2]] * 2), rel=1e-12)


def test_a_channel_without_period_is_refused(tmp_path):
    """A stand that goes on was shown where it starts, with derivatives of zero."""
    path = tmp_path / "wheel.yaml"
    path.write_text(STAND.replace("START", "stand.place_rate: offset / (1 s)"), "utf-8")
    with pytest.raises(InputError, match=r"'stand.place' has no period"):
        vd.sensitivity(path, ["cycle_mean(stand.place)"], ["offset"])


DIMENSIONS = {"kg": (0, 1, 0), "m": (1, 0, 0), "s": (0, 0, 1), "N": (1, 1, -2), "Hz": (0, 0, -1)}


def dimension(unit):
    """Return the powers of metre, kilogram and second in a unit of the program."""
    powers, sign = np.zeros(3), 1.0
    for part in re.findall(r"[*/]|[^*/()]+", unit):
        if part in "*/":
            sign = -1.0 if part == "/" else sign
            continue
        name, _, power = part.partition("^")
        powers += sign * float(power or 1) * np.array(DIMENSIONS.get(name, (0, 0, 0)))
    return powers


@pytest.mark.parametrize(
    ("system", "speed", "of"),
    [
        ("simple_wheelset", "58 m/s", ["cycle_amplitude(wheelset.lateral)", "cycle_frequency"]),
        ("cooperrider_classic", "66 m/s", ["nonlinear_critical_speed"]),
    ],
)
def test_derivatives_do_not_depend_on_units(system, speed, of, tmp_path):
    """Euler's theorem: units of length, mass and time change all parameters and the figure.

    Contacts of flanges begin on the way. At the fold the parameter 'speed' is the figure itself.
    """
    vd.sensitivity(system, of, speed=speed, save_to=tmp_path / "s.h5")
    table = read_sensitivity(tmp_path / "s.h5")
    powers = np.array([dimension(p.unit) for p in table.parameters])
    for figure, value, slope in zip(table.figures, table.values, table.slopes, strict=True):
        by = slope * table.parameter_values / value
        assert np.abs(by).max() > 0.1
        assert by @ powers == pytest.approx(dimension(figure.unit), abs=1e-7)


def test_a_fold_with_flanges_is_that_of_another_search():
    """Found with a yaw spring 0.1 per cent softer and stiffer."""
    of, name = "nonlinear_critical_speed", "yaw_stiffness"
    found = vd.sensitivity("simple_wheelset", of, name, speed="58 m/s")
    (speed, by), stiffness = effects(found)[of], float(found["parameter_value"].values[0])
    sides = [
        vd.sensitivity(
            "simple_wheelset", of, name, speed="58 m/s",
            set={f"parameters.{name}": f"{part * stiffness!r} N*m/rad"},
        )["figure_value"].values[0]
        for part in (0.999, 1.001)
    ]  # fmt: skip
    assert (sides[1] - sides[0]) / 2e-3 / speed == pytest.approx(by[name], rel=1e-5)


@pytest.mark.parametrize(
    ("of", "to", "more", "words"),
    [
        ("cycle_amplitude(wheel.angel)", "*", {}, "did you mean 'wheel.angle'"),
        ("cycle_period", "start.*", {}, "no start values"),
        ("cycle_period", "no_such", {}, "matches no parameter"),
        (["cycle_period", "eigenvalues"], "*", {}, "one after the other"),
        ("cycle_period", "*", {"speed": "0 m/s"}, "above zero"),
        ("cycle_period", "*", {"speed": "1 m/s"}, "no limit cycle is found at 1 m/s"),
        ("nonlinear_critical_speed", "*", {"set": {"parameters.cubic": "-1 N*m*s/rad"}}, "no fold"),
    ],
)
def test_what_is_refused(of, to, more, words, tmp_path):
    path = tmp_path / "wheel.yaml"
    path.write_text(WHEEL, encoding="utf-8")
    with pytest.raises((InputError, NumericalError), match=words):
        vd.sensitivity(path, of, to, **more)


def test_small_effects_are_measured_by_themselves():
    """An effect of a hundredth of the largest may not change by more than a millionth of itself."""
    values, before = np.array([2.0, 1.0, 1.0]), np.array([[0.5, 0.01, 0.0], [0.0, 0.0, 0.0]])
    after = before + np.array([[1e-8, 5e-8, 1e-10], [0.0, 0.0, 0.0]])
    of_largest, of_itself = cycles._changes(before, after, values, np.array([0.5, 0.0]))
    assert of_largest == pytest.approx(5e-8, rel=1e-3)
    assert of_itself == pytest.approx(5e-6, rel=1e-3)


def test_effects_on_what_symmetry_makes_zero_are_none():
    """The mean of an even swing follows nothing, and what rounding makes never settles."""
    values, before = np.ones(2), np.array([[1e-14, -1e-13]])
    of_largest, of_itself = cycles._changes(before, -before, values, np.array([5e-3]))
    assert of_largest < 1e-7
    assert of_itself < 1e-6
