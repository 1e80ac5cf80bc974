"""Derivatives of frequency responses, mode shapes and state-space matrices by parameters."""

import math

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyse.gradients import eigenvalues
from vehicledyn.base.errors import InputError, NumericalError

MASS, STIFFNESS, DAMPING, WHEEL, TYRE = NAMES = (
    "body.mass",
    "body.stiffness",
    "body.damping",
    "wheel.mass",
    "wheel.stiffness",
)
FORCE, HEIGHT = "force:body.height", "body.height"


def test_gain_and_phase_follow_the_closed_form():
    """A quarter car under a force F = D z, by its masses and springs: d(ln H) = -dD / D."""
    frequency = 1.5
    of = [f"{kind}({HEIGHT}, {FORCE}, {frequency} Hz)" for kind in ("gain", "phase")]
    found = vd.sensitivity("quarter_car", of)
    known = list(found["parameter"].values)
    places = [known.index(name) for name in NAMES]
    mass, stiffness, damping, wheel, tyre = found["parameter_value"].values[places]
    s = 2j * np.pi * frequency
    strut, below = stiffness + s * damping, wheel * s * s + tyre
    whole = mass * s * s + strut * below / (below + strut)
    by_strut, by_below = np.square([below, strut] / (below + strut))
    by_parameter = np.array([s * s, by_strut, s * by_strut, s * s * by_below, by_below])
    gain, phase = found["figure_value"].values
    assert gain * np.exp(1j * phase) == pytest.approx(1.0 / whole, rel=1e-12)
    slopes = found["figure_slope"].values[:, places]
    assert slopes[0] / gain + 1j * slopes[1] == pytest.approx(-by_parameter / whole, rel=1e-10)


def test_large_equations_have_the_same_slopes(monkeypatch):
    """Partial derivatives as one function, and row by row as those of large equations."""
    whole = vd.sensitivity("simple_wheelset", "critical_speed", speed="40 m/s")
    monkeypatch.setattr(eigenvalues, "_SMALL", -1)
    rows = vd.sensitivity("simple_wheelset", "critical_speed", speed="40 m/s")
    for name in ("figure_value", "figure_slope"):
        assert rows[name].values == pytest.approx(whole[name].values, rel=1e-9, abs=1e-12)


def test_matrices_follow_parameters(tmp_path):
    """The quarter car's state space is linear in its springs and in the inverse masses."""
    patterns = list(NAMES)
    model = vd.linearise("quarter_car", FORCE, [HEIGHT, "strut.force"], to=patterns)
    assert [p.name for p in model.parameters] == list(NAMES)
    by = dict(zip(NAMES, model.slopes.a, strict=True))
    assert by[STIFFNESS][3] == pytest.approx([1 / 300, -1 / 300, 0, 0], abs=1e-15)
    assert by[DAMPING][2] == pytest.approx([0, 0, -1 / 40, 1 / 40], abs=1e-15)
    assert by[MASS][3] == pytest.approx(-model.system.a[3] / 300, rel=1e-12)
    assert by[TYRE][2] == pytest.approx([-1 / 40, 0, 0, 0], abs=1e-15)
    assert model.slopes.b[0][:, 0] == pytest.approx(-model.system.b[:, 0] / 300, rel=1e-12)
    assert not model.slopes.d.any()
    with np.load(model.save(tmp_path / "model.npz")) as saved:
        assert (saved["dA"] == model.slopes.a).all()
        assert list(saved["parameters"]) == list(NAMES)
    with pytest.raises(InputError, match="no derivatives here"):
        vd.linearise("quarter_car", FORCE, HEIGHT, order=2, to="*")
    with pytest.raises(InputError, match=r"did you mean 'body\.mass'"):
        vd.linearise("quarter_car", FORCE, HEIGHT, to="body.mas")


def test_moved_inputs_become_states_with_derivatives():
    """A driven ground whose rate the outputs feel, against differences of the matrices."""

    def model(stiffness):
        changed = {f"parameters.{TYRE}": f"{stiffness} kN/m"}
        return vd.linearise(
            "quarter_car", "road.height", ["wheel.height", "road.height_rate"], set=changed, to=TYRE
        )

    near = model(180)
    ends = [model(value).system for value in (170, 190)]
    assert near.inputs[0].name == "road.height.rate"
    assert near.slopes.a.any()
    for letter in "abcd":
        differences = (getattr(ends[1], letter) - getattr(ends[0], letter)) / 20e3
        assert getattr(near.slopes, letter)[0] == pytest.approx(differences, rel=1e-9, abs=1e-12)


def test_mode_shapes_follow_parameters():
    """Two masses on springs, against differences of the eigenvectors of the moved matrix."""
    model = vd.linearise(
        "double_spring_mass", "force:lower.height", "lower.height", to="upper.stiffness"
    )
    found = vd.sensitivity("double_spring_mass", "mode_shapes", "upper.stiffness")
    at, matrix, moved = 800.0, model.system.a, model.slopes.a[0]
    assert matrix[2, 0] == pytest.approx(-400.0)

    def shapes(change):
        values, vectors = np.linalg.eig(matrix + change * moved)
        modes = [k for k in np.argsort(-values.real, kind="stable") if values[k].imag > 0.0]
        rows = []
        for k in modes:
            fixed = np.argmax(np.abs(vectors[:2, k]))
            shape = vectors[:, k] / vectors[fixed, k]
            rows += [f(shape[j]) for j in range(4) if j != fixed for f in (np.real, np.imag)]
        return np.array(rows)

    rates = [(shapes(h) - shapes(-h)) / (2 * h) for h in (8.0, 4.0, 2.0)]
    first, second = (4 * rates[1] - rates[0]) / 3, (4 * rates[2] - rates[1]) / 3
    assert found["figure_value"].values == pytest.approx(shapes(0.0), rel=1e-9, abs=1e-12)
    slopes = found["figure_slope"].values[:, 0]
    assert slopes * at == pytest.approx((16 * second - first) / 15 * at, rel=1e-9, abs=1e-10)
    assert np.max(np.abs(slopes)) * at > 0.01


def test_repeated_eigenvalues_have_no_mode_shape_slopes(tmp_path):
    """Two equal masses on springs that are not joined vibrate in any mixture."""
    bodies = "".join(
        f"  {name}: {{at: [0 m, 0 m, -0.6 m], joints: [T3 height], mass: 1 kg}}\n"
        for name in ("left", "right")
    )
    links = "".join(
        f"  {name}_spring: {{a: ground, b: {name}, law: {{kind: spring_damper, "
        "stiffness: 100 N/m, damping: 1 N*s/m, free_length: 0.5 m}}\n"
        for name in ("left", "right")
    )
    path = tmp_path / "pair.yaml"
    path.write_text(
        f"title: Two equal masses\nparameters: {{idle: 1 m}}\nbodies:\n{bodies}links:\n{links}",
        encoding="utf-8",
    )
    with pytest.raises(NumericalError, match="repeated"):
        vd.sensitivity(path, "mode_shapes")


OSCILLATOR = """
title: An oscillator
gravity: [0, 0, 0]
parameters: {mass: 2 kg, stiffness: 800 N/m, damping: 6 N*s/m}
bodies: {body: {joints: [T3 height], mass: mass}}
springs:
  own: {coordinate: body.height, law: {kind: spring_damper, stiffness: stiffness, damping: damping}}
"""


def test_peaks_of_an_oscillator_and_what_moves_them(tmp_path):
    """Gain 1 / (c √(k/m - c²/4m²)) at √(k/m - c²/2m²) / 2π, differentiated by hand."""
    path = tmp_path / "oscillator.yaml"
    path.write_text(OSCILLATOR, encoding="utf-8")
    span = "body.height, force:body.height, 0.5 Hz:9 Hz"
    found = vd.sensitivity(
        path, [f"peak_gain({span})", f"peak_frequency({span})"], ["mass", "stiffness", "damping"]
    )
    m, k, c = 2.0, 800.0, 6.0
    own, whole = math.sqrt(k / m - (0.5 * c / m) ** 2), math.sqrt(k / m - 0.5 * (c / m) ** 2)
    gain, frequency = 1.0 / (c * own), whole / (2.0 * math.pi)
    assert found["figure_value"].values == pytest.approx([gain, frequency], rel=1e-12)
    by_own = np.array([-k / m**2 + 0.5 * c**2 / m**3, 1.0 / m, -0.5 * c / m**2]) / (2.0 * own)
    by_gain = -gain * by_own / own - np.array([0.0, 0.0, gain / c])
    by_whole = np.array([-k / m**2 + c**2 / m**3, 1.0 / m, -c / m**2]) / (2.0 * whole)
    slopes = found["figure_slope"].values
    assert slopes[0] == pytest.approx(by_gain, rel=1e-10)
    assert slopes[1] == pytest.approx(by_whole / (2.0 * math.pi), rel=1e-9)


def test_parts_of_a_response_are_those_of_its_gain_and_phase(tmp_path):
    """With derivatives: H = g e^{iφ}."""
    path = tmp_path / "oscillator.yaml"
    path.write_text(OSCILLATOR, encoding="utf-8")
    kinds = ("gain", "phase", "real", "imaginary")
    of = [f"{kind}({HEIGHT}, {FORCE}, 1.5 Hz)" for kind in kinds]
    found = vd.sensitivity(path, of, "mass")
    gain, phase, *parts = found["figure_value"].values
    by_gain, by_phase, *slopes = found["figure_slope"].values[:, 0]
    turn = np.exp(1j * phase)
    assert complex(*parts) == pytest.approx(gain * turn, rel=1e-12)
    expected = (by_gain + 1j * gain * by_phase) * turn
    assert complex(*slopes) == pytest.approx(expected, rel=1e-12)


def test_a_range_of_frequencies_is_as_many_figures(tmp_path):
    path = tmp_path / "oscillator.yaml"
    path.write_text(OSCILLATOR, encoding="utf-8")
    found = vd.sensitivity(path, "phase(body.height, force:body.height, 1 Hz:3 Hz:4)", "mass")
    one = vd.sensitivity(path, "phase(body.height, force:body.height, 1.5 Hz)", "mass")
    assert found["figure_slope"].values.shape == (5, 1)
    assert found["figure_slope"].values[1] == pytest.approx(one["figure_slope"].values[0])
    with pytest.raises(NumericalError, match="no peak between 5 and 9 Hz: the gain is largest at"):
        vd.sensitivity(path, "peak_gain(body.height, force:body.height, 5 Hz:9 Hz)", "mass")


@pytest.mark.parametrize(
    ("of", "match"),
    [
        (f"gain({HEIGHT}, {FORCE})", "write gain"),
        (f"peak_gain({HEIGHT}, {FORCE}, 2 Hz)", "a peak lies in a range, such as"),
        (f"gain({HEIGHT}, {FORCE}, 1 Hz:2 Hz:0)", "number of steps"),
        (f"gain({HEIGHT}, {FORCE}, 2 kg)", "kg"),
        (f"gain({HEIGHT}, {FORCE}, 0 Hz)", "above zero"),
        ([f"gain({HEIGHT}, {FORCE}, 1 Hz)", "eigenvalues"], "one after the other"),
        ("mode_shapes.body.heigth", r"did you mean 'mode_shapes\.body\.height'"),
        (f"gain(body.hight, {FORCE}, 1 Hz)", "no such channel"),
    ],
)
def test_names_are_checked(of, match):
    """Of responses and mode shapes."""
    with pytest.raises(InputError, match=match):
        vd.sensitivity("quarter_car", of)
