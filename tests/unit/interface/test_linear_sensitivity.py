"""Derivatives of frequency responses, mode shapes and state-space matrices by parameters."""

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


@pytest.mark.parametrize(
    ("of", "match"),
    [
        (f"gain({HEIGHT}, {FORCE})", "write gain"),
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
