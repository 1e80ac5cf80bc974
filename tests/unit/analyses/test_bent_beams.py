"""What shows beams of assumed modes warns where they bend farther than these hold for."""

import warnings
from contextlib import nullcontext

import pytest

import vehicledyn as vd
from vehicledyn.base.errors import AccuracyWarning

RUN = """title: A strip is let go
model: strip.yaml
duration: 1 s
solver: {kind: rosenbrock, relative_tolerance: 1e-5, absolute_tolerance: 1e-6}
output: {interval: 10 ms}
"""
STRIP = """title: A strip with a load at its end
parameters: {length: 2.2 m, mass: 2 kg}
bodies:
  load: {parent: strip.tip, mass: mass}
elements:
  strip:
    kind: beam
    body: ground
    length: length
    section: {shape: rectangle, width: 20 mm, height: 10 mm}
    material: {density: 7850 kg/m^3, young: 210 GPa}
    modes: {z: 2}
    model: MODEL
"""


@pytest.mark.parametrize(
    ("model", "length", "warned"),
    [("modes", "2.2 m", True), ("modes", "1.5 m", False), ("exact", "2.2 m", False)],
)
def test_only_small_deflections_suit_modes(tmp_path, model, length, warned):
    """The end falls twice as far as it hangs at rest, by 0.29 of the length, or 0.12."""
    (tmp_path / "strip.yaml").write_text(STRIP.replace("MODEL", model))
    (tmp_path / "run.yaml").write_text(RUN)
    warning = (
        pytest.warns(AccuracyWarning, match="beam 'strip': its end moves aside by 0.2. of its")
        if warned
        else nullcontext()
    )
    with warning:
        run = vd.simulate(
            vd.load(tmp_path / "run.yaml"), backend="interpreted", parameters={"length": length}
        )
    share = abs(run["strip.tip_z"].values).max() / float(length.split()[0])
    assert share == pytest.approx(0.29 if length == "2.2 m" else 0.12, rel=0.03)


@pytest.mark.parametrize(
    ("analysis", "mass"), [(vd.equilibrium, "5 kg"), (vd.equilibrium, "2 kg"), (vd.modes, "5 kg")]
)
def test_points_are_looked_at(tmp_path, analysis, mass):
    """Where it hangs at rest, by 0.26 of the length, or 0.15."""
    (tmp_path / "strip.yaml").write_text(STRIP.replace("MODEL", "modes"))
    with warnings.catch_warnings(record=True) as issued:
        warnings.simplefilter("always")
        analysis(vd.load(tmp_path / "strip.yaml"), backend="interpreted", parameters={"mass": mass})
    warned = [str(w.message) for w in issued if w.category is AccuracyWarning]
    if mass == "2 kg":
        assert not warned
        return
    assert len(warned) == 1
    assert "beam 'strip': its end moves aside by 0.26 of its length; " in warned[0]


SWEEP = """title: Loads at the end of a strip
scenario: run.yaml
cases: {kind: grid, vary: {parameters.mass: [1 kg, 2 kg, 3 kg]}}
output: {figures: false, channels: [energy.*]}
"""


def test_sweeps_count_the_cases(tmp_path):
    (tmp_path / "strip.yaml").write_text(STRIP.replace("MODEL", "modes"))
    (tmp_path / "run.yaml").write_text(RUN)
    (tmp_path / "study.yaml").write_text(SWEEP)
    with pytest.warns(
        AccuracyWarning, match=r"by up to 0.3\d of its length in 2 of 3 cases \(1, 2"
    ):
        vd.sweep(tmp_path / "study.yaml", backend="interpreted", workers=1)


FANNED = """title: A strip that is fanned
parameters: {pace: 1 N*s/m}
gravity: [0, 0, 0]
elements:
  strip:
    kind: beam
    body: ground
    length: 2.2 m
    stiffness: {mass_per_length: 1.57 kg/m, z: 350 N*m^2}
    modes: {z: 1}
forces:
  fan: {coordinate: strip.z_1, force: (pace - 1 N*s/m - 22 N*s/m^3 * position**2) * rate}
"""


def warnings_of(analysis, *arguments, **settings):
    """Return the warnings of accuracy that an analysis issues."""
    with warnings.catch_warnings(record=True) as issued:
        warnings.simplefilter("always")
        analysis(*arguments, **settings)
    return [str(w.message) for w in issued if w.category is AccuracyWarning]


def test_limit_cycles_are_looked_at(tmp_path):
    """The widest of them bends the strip by 0.4 of its length, cycles below 1.5 N s/m do not."""
    (tmp_path / "fanned.yaml").write_text(FANNED)
    given = {"parameter": "pace", "points": 4, "simulate": False, "backend": "interpreted"}
    (warned,) = warnings_of(vd.hunt, tmp_path / "fanned.yaml", 0.8, 2.0, **given)
    assert "moves aside by 0.4" in warned
    assert "of its length in the limit cycle at pace = 2 " in warned
    assert not warnings_of(vd.hunt, tmp_path / "fanned.yaml", 0.8, 1.2, **given)


@pytest.mark.parametrize("of", ["eigenvalues", "max(strip.tip_z)"])
def test_derivatives_are_looked_at(tmp_path, of):
    (tmp_path / "strip.yaml").write_text(STRIP.replace("MODEL", "modes"))
    (tmp_path / "run.yaml").write_text(RUN.replace("1 s", "0.5 s"))
    file = tmp_path / ("strip.yaml" if of == "eigenvalues" else "run.yaml")
    given = {"of": of, "to": "parameters.mass", "parameters": {"mass": "5 kg"}}
    (warned,) = warnings_of(vd.sensitivity, vd.load(file), **given)
    assert "beam 'strip': its end moves aside by 0." in warned


def test_linear_models_are_looked_at(tmp_path):
    strip = STRIP.replace("MODEL", "modes").replace("body: ground", "body: table")
    law = "{kind: sine, amplitude: 1 mm, frequency: 1 Hz}"
    drives = f"drives:\n  table: {{coordinate: table.lift, law: {law}}}\n"
    strip = strip.replace("bodies:\n", "bodies:\n  table: {joints: [T3 lift]}\n") + drives
    (tmp_path / "strip.yaml").write_text(strip)
    given = "table.lift", "strip.tip_z"
    (warned,) = warnings_of(
        vd.linearise, tmp_path / "strip.yaml", *given, parameters={"mass": "5 kg"}
    )
    assert "by 0.26 of its length" in warned
