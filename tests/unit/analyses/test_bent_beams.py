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
