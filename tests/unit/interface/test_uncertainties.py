"""Uncertainty of runs, from Python."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError, NumericalError

LAWS = {"length": {"kind": "normal", "mean": "1 m", "deviation": "5 mm"}}
LAWS["parameters.mass"] = {"kind": "uniform", "from": "0.9 kg", "to": "1.1 kg"}
OF, SHORT = ["final(upper.angle)"], {"duration": "0.3 s"}


def test_first_order_agrees_with_samples():
    """Nearly linear figures: deviation within errors; the mass of a pendulum does not matter."""
    linear = vd.uncertainty("double_pendulum", OF, LAWS, **SHORT)
    assert linear.n_runs == 1
    assert linear.shares[0] == pytest.approx([1.0, 0.0], abs=1e-9)
    drawn = vd.uncertainty("double_pendulum", OF, LAWS, method="sequence", number=64, **SHORT)
    assert drawn.found.deviation == pytest.approx(linear.found.deviation, rel=0.05)
    assert drawn.found.mean == pytest.approx(linear.found.mean, abs=3e-2 * drawn.found.deviation[0])
    assert "final(upper.angle)" in drawn.as_text()


def test_risks_and_indices():
    """A limit at the median is passed by half of all samples; one parameter brings all scatter."""
    middle = float(vd.uncertainty("double_pendulum", OF, LAWS, **SHORT).found.mean[0])
    limits = {OF[0]: {"at_most": f"{middle!r} rad"}}
    found = vd.uncertainty(
        "double_pendulum", OF, LAWS, method="sobol", number=32, limits=limits, **SHORT
    )
    (risk,) = found.as_dict()["risks"]
    assert risk["interval"][0] < 0.5 < risk["interval"][1]
    assert found.n_runs == 32 * 4
    assert np.abs(found.totals[0] - [1.0, 0.0]).max() < 0.1


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"parameters": {"lenght": LAWS["length"]}}, "did you mean 'length'"),
        ({"parameters": {"length": {"kind": "norml"}}}, "kind 'norml'"),
        ({"parameters": {"length": {"kind": "normal", "mean": "1 m"}}}, "mean, deviation"),
        ({"parameters": {"length": LAWS["length"] | {"mean": "1 kg"}}}, "kg"),
        ({"parameters": {"length": LAWS["length"] | {"deviation": "-1 mm"}}}, "above zero"),
        (
            {"parameters": {"mass": {"kind": "uniform", "from": "-1 kg", "to": "2 kg"}}},
            "mass: the model refuses -0.997 kg",
        ),
        ({"parameters": {}}, "at least one"),
        ({"method": "guess"}, "method: expected 'first_order'.* found 'guess'"),
        ({"method": "sobol", "number": 30}, "power of two"),
        ({"of": ["upper.angle"]}, "is a curve"),
        ({"of": ["max(upper.angel)"]}, "did you mean 'upper.angle'"),
        ({"limits": {OF[0]: {"at_most": "1 rad"}}}, "needs samples"),
    ],
)
def test_what_means_nothing_is_refused(changes, match):
    """Each with one clear message."""
    given = {"of": OF, "parameters": LAWS} | changes
    of, laws = given.pop("of"), given.pop("parameters")
    with pytest.raises(InputError, match=match):
        vd.uncertainty("double_pendulum", of, laws, **given, **SHORT)


FUNCTIONS = """\
title: Functions of parameters
parameters: {x: 0, y: 0, z: 0}
bodies:
  mass: {joints: [{kind: T1, name: slide}], mass: 1 kg, inertia: [0, 0, 0]}
sensors:
  ishigami: {kind: expression, value: "sin(x) + 7 * sin(y)**2 + 0.1 * z**4 * sin(x)", unit: "1"}
  line: {kind: expression, value: "5 + x + 2 * y - 0.3 * z", unit: "1"}
  curved: {kind: expression, value: "3 + 0.1 * y**2 - x", unit: "1"}
  rooted: {kind: expression, value: "sqrt(x) + y", unit: "1"}
"""
TINY = {"duration": "10 ms", "solver": {"kind": "rk4", "step": "10 ms"}, "output.interval": "10 ms"}
LINE = {
    "x": {"kind": "normal", "mean": 1.0, "deviation": 0.5},
    "y": {"kind": "normal", "mean": 2.0, "deviation": 0.1},
    "z": {"kind": "normal", "mean": 0.0, "deviation": 2.0},
}
PARTS = np.array([0.5, 0.2, 0.6]) ** 2


@pytest.fixture
def functions(tmp_path):
    """Return a model whose channels are functions of its parameters."""
    path = tmp_path / "functions.yaml"
    path.write_text(FUNCTIONS)
    return path


@pytest.mark.long
def test_polynomial_chaos_finds_the_indices_of_ishigami(functions):
    """Within 1 % from 256 runs: Ishigami and Homma (1990), a = 7, b = 0.1."""
    laws = {name: {"kind": "uniform", "from": -np.pi, "to": np.pi} for name in "xyz"}
    found = vd.uncertainty(
        functions, "final(ishigami)", laws, method="polynomial_chaos", number=256, **TINY
    )
    of_x, of_y, mixed = 0.5 * (1 + np.pi**4 / 50) ** 2, 49 / 8, np.pi**8 * 0.01 * (1 / 18 - 1 / 50)
    whole = of_x + of_y + mixed
    assert found.n_runs == 256
    assert found.found.mean[0] == pytest.approx(3.5, rel=0.01)
    assert found.found.deviation[0] ** 2 == pytest.approx(whole, rel=0.01)
    assert found.shares[0] == pytest.approx([of_x / whole, of_y / whole, 0.0], abs=0.01)
    expected = [(of_x + mixed) / whole, of_y / whole, mixed / whole]
    assert found.totals[0] == pytest.approx(expected, abs=0.01)
    assert "polynomials miss" in found.as_text()


@pytest.mark.parametrize("method", ["first_order", "second_order", "polynomial_chaos"])
def test_linear_figures_of_normal_parameters_are_exact(functions, method):
    """Mean, deviation and shares to rounding, by whatever has no samples' error."""
    found = vd.uncertainty(functions, "final(line)", LINE, method=method, number=16, **TINY)
    assert found.found.mean[0] == pytest.approx(10.0, rel=1e-9)
    assert found.found.deviation[0] == pytest.approx(np.sqrt(PARTS.sum()), rel=1e-9)
    assert found.shares[0] == pytest.approx(PARTS / PARTS.sum(), rel=1e-8)


@pytest.mark.parametrize(("limit", "side"), [("at_most", -1.0), ("at_least", 1.0)])
def test_the_reliability_of_linear_figures_is_exact(functions, limit, side):
    """The chance is that of a normal figure, here both of failing and of not failing first."""
    from scipy.stats import norm

    limits = {"final(line)": {limit: 12.0}}
    found = vd.uncertainty(
        functions, "final(line)", LINE, method="reliability", number=4, limits=limits, **TINY
    )
    ((_, words, chance, low, high),) = found.risks
    expected = norm.cdf(side * 2.0 / np.sqrt(PARTS.sum()))
    assert chance == pytest.approx(expected, rel=1e-6)
    assert low == pytest.approx(expected, rel=1e-6)
    assert high == pytest.approx(expected, rel=1e-6)
    assert ("above" if limit == "at_most" else "below") in words
    assert f"{-side * 2.0 / np.sqrt(PARTS.sum()):.4g}" in found.as_text()


@pytest.mark.parametrize(("limit", "side"), [("at_most", ""), ("at_least", "all but ")])
def test_rare_chances_have_digits(functions, limit, side):
    """Φ(-5.6) is 1.072e-8; of 16 samples none, which bounds the chance by Wilson's 19.4 %."""
    limits = {"final(curved)": {limit: 8.6}}
    given = {"parameters": {"x": {"kind": "normal", "mean": 0.0, "deviation": 1.0}}, **TINY}
    given |= {"of": "final(curved)", "limits": limits, "number": 16}
    found = vd.uncertainty(functions, method="reliability", **given).as_text()
    number = f"{side}1.072e-06%"
    assert f"in {number} (95 %: {number} to {number})" in found
    if not side:
        sampled = vd.uncertainty(functions, method="sequence", **given).as_text()
        assert "in 0% (95 %: 0% to 19.36%)" in sampled


def test_curved_limits_have_the_chance_within_its_error(functions):
    """x > 3 + y² / 10 of standard normal x, y: against integration; first order is 30 % high."""
    from scipy.integrate import quad
    from scipy.stats import norm

    laws = {name: {"kind": "normal", "mean": 0.0, "deviation": 1.0} for name in "xy"}
    limits = {"final(curved)": {"at_least": 0.0}}
    found = vd.uncertainty(
        functions, "final(curved)", laws, method="reliability", number=40, limits=limits, **TINY
    )
    expected = quad(lambda y: norm.pdf(y) * norm.sf(3.0 + 0.1 * y**2), -9.0, 9.0)[0]
    ((_, _, chance, low, high),) = found.risks
    assert low < expected < high
    assert high - low < 0.3 * expected
    assert chance < 0.9 * norm.sf(3.0)
    assert f"{norm.sf(3.0):.3g}" in found.as_text()


def test_second_derivatives_move_the_mean(functions):
    """3 + y² / 10 - x is quadratic: mean 3.1, variance 1 + 2 / 100, exactly."""
    laws = {name: {"kind": "normal", "mean": 0.0, "deviation": 1.0} for name in "xy"}
    found = vd.uncertainty(functions, "final(curved)", laws, method="second_order", **TINY)
    assert found.found.mean[0] == pytest.approx(3.1, rel=1e-9)
    assert found.found.deviation[0] ** 2 == pytest.approx(1.02, rel=1e-9)
    assert found.totals[0] == pytest.approx([1.0 / 1.02, 0.02 / 1.02], rel=1e-8)


ROOTED = {
    "x": {"kind": "normal", "mean": 1.0, "deviation": 0.5},
    "y": {"kind": "normal", "mean": 1.0, "deviation": 0.2},
}


@pytest.mark.parametrize("method", ["sequence", "sobol", "polynomial_chaos", "reliability"])
def test_runs_that_fail_are_left_out_and_told(functions, method):
    """The root of a negative x is no number: one in 44 of these, none of the middle."""
    limits = {"final(rooted)": {"at_least": 1.2 if method == "reliability" else 1.6}}
    found = vd.uncertainty(
        functions, "final(rooted)", ROOTED, method=method, number=64, limits=limits, **TINY
    )
    text = found.as_text()
    assert "left out" in text
    assert "nan" not in text
    ((*_, share, low, high),) = found.risks
    assert low < share < high
    if method != "reliability":
        assert "'final(rooted)' is not a number" in text
        failed = np.isnan(found.samples[:, 0])
        assert (failed == (found.points[:, 0] < 0.0)).all()
        assert f"{failed.sum()} of {len(failed)} runs failed" in text
    if method == "polynomial_chaos":
        left = found.samples[~failed]
        assert found.found.mean == pytest.approx(left.mean(axis=0), rel=1e-12)
        assert found.found.deviation == pytest.approx(left.std(axis=0, ddof=1), rel=1e-12)
        assert "shares those of polynomials that go on over the region of failed runs" in text


def test_samples_most_of_which_fail_are_refused(functions):
    """Nothing can be said of a scatter; the first failure is told."""
    law = {"x": {"kind": "uniform", "from": -2.0, "to": 1.0}}
    with pytest.raises(NumericalError, match=r"too many to speak of a scatter.* x = .* not a numb"):
        vd.uncertainty(functions, "final(rooted)", law, method="sequence", number=32, **TINY)


def test_shares_have_errors(functions):
    """Of few runs large ones, which are warned of; Gaussian linear shares are within them."""
    found = vd.uncertainty(functions, "final(line)", LINE, method="sobol", number=32, **TINY)
    assert np.all(np.abs(found.shares[0] - PARTS / PARTS.sum()) < 3.0 * found.shares_error[0])
    assert found.shares_error.max() > 0.05
    assert "warning: shares of the variance have standard errors" in found.as_text()
    assert found.as_dict()["figures"]["final(line)"]["totals_error"] == list(found.totals_error[0])
    assert found.found.mean_error[0] == pytest.approx(found.found.deviation[0] / 8.0)


@pytest.mark.parametrize(
    ("method", "words"),
    [
        ("first_order", "has no effect at the means of the parameters, to first order"),
        ("second_order", "has no effect at the means of the parameters, to second order"),
        ("sobol", "changes no figure"),
        ("polynomial_chaos", "brings less than 1e-06 of the variance of any figure"),
        ("sequence", "brings less than 1e-06 of the variance of any figure"),
    ],
)
def test_a_parameter_that_does_nothing_is_warned_of(functions, method, words):
    """The curved figure does not depend on z; each method says what it knows of that."""
    found = vd.uncertainty(functions, "final(curved)", LINE, method=method, number=16, **TINY)
    assert [note for note in found.notes if "'" in note] == [f"warning: 'z' {words}"]


def test_tolerances_of_hardpoints_scatter_the_bump_steer():
    """Figures of the rig: the deviation of toe by travel is that of the exact derivatives."""
    figure, heights = "rig(wheel.toe_gain, parallel)", ["track_rod.inner.z", "track_rod.outer.z"]
    laws = {
        name: {"kind": "normal", "mean": mean, "deviation": "0.5 mm"}
        for name, mean in zip(heights, ("250 mm", "275 mm"), strict=True)
    }
    found = vd.uncertainty("scenarios/systems/double_wishbone_suspension.yaml", figure, laws).found
    slopes = vd.sensitivity("double_wishbone_suspension", figure, heights)["figure_slope"].values[0]
    assert found.deviation == pytest.approx([5e-4 * np.hypot(*slopes)], rel=1e-9)


def test_figures_of_one_analysis_are_asked_for():
    law = {"track_rod.inner.z": {"kind": "normal", "mean": "250 mm", "deviation": "1 mm"}}
    both = ["rig(wheel.toe_gain, parallel)", "max(wheel.toe_angle)"]
    with pytest.raises(InputError, match="figures of one analysis"):
        vd.uncertainty("scenarios/systems/double_wishbone_suspension.yaml", both, law)
