"""Studies of identification and uncertainty as files."""

import json

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError
from vehicledyn.studies.uncertainty.cases import RandomCases

pytestmark = [pytest.mark.long, pytest.mark.usefixtures("needs_compiler")]

SCENARIO = """\
title: A quarter car on a shaker
model: quarter_car
duration: 0.5 s
solver: {kind: rk4, step: 5 ms}
output: {interval: 10 ms}
"""
IDENTIFY = """\
title: Strut of a quarter car
experiments:
  first:
    scenario: run.yaml
    data: first.csv
    signals:
      body.height: {column: height, noise: 1 mm}
  second:
    scenario: run.yaml
    set: {parameters.body.mass: 300 kg}
    data: second.csv
    signals:
      body.height: {column: height, noise: 1 mm, lag: 5 ms}
parameters:
  body.stiffness: {from: 5 kN/m, to: 60 kN/m, start: 30 kN/m}
  body.damping: {from: 200 N*s/m, to: 8 kN*s/m, prior: 1.2 kN*s/m, deviation: 2 kN*s/m}
hold_out: [second]
"""
SPREAD = """\
title: Comfort of a quarter car
scenario: run.yaml
of: [max(body.height), rms(strut.force)]
parameters:
  body.stiffness: {kind: normal, mean: 18 kN/m, deviation: 500 N/m}
  body.damping: {kind: uniform, from: 1 kN*s/m, to: 1.5 kN*s/m}
method: sequence
number: 8
limits:
  max(body.height): {at_most: 1.05 m}
"""


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """Return the texts of two noisy measurements by name."""
    path = tmp_path_factory.mktemp("data") / "run.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    rng, texts = np.random.default_rng(11), {}
    for name, mass, lag in (("first", None, 0.0), ("second", "300 kg", 0.005)):
        run = vd.simulate(path, set={} if mass is None else {"parameters.body.mass": mass})
        noisy = run["body.height"].values + 1e-3 * rng.normal(size=len(run.time))
        lines = [f"{t + lag:.9g}, {1e3 * y:.9g}" for t, y in zip(run.time, noisy, strict=True)]
        texts[name] = "time [s], height [mm]\n" + "\n".join(lines) + "\n"
    return texts


@pytest.fixture
def folder(tmp_path, data):
    """Return a folder with a scenario, its noisy data and a study of each kind."""
    (tmp_path / "run.yaml").write_text(SCENARIO, encoding="utf-8")
    for name, text in data.items():
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    (tmp_path / "identify.yaml").write_text(IDENTIFY, encoding="utf-8")
    (tmp_path / "spread.yaml").write_text(SPREAD, encoding="utf-8")
    return tmp_path


def test_parameters_are_found_in_a_file_and_another_experiment_foretold(folder):
    """The truth lies within three deviations; what is held out fits as well as the noise allows."""
    found = vd.identify_study(folder / "identify.yaml", save_to=folder / "out.h5")
    truth = vd.load(folder / "run.yaml")
    assert found.kind == "identification"
    low, high = found["parameter_low"].values, found["parameter_high"].values
    value = found["parameter_value"].values
    known = vd.sensitivity(truth, "body.height", "body.*")
    names = list(known["parameter"].values)
    for k, name in enumerate(found["parameter"].values):
        exact = float(known["parameter_value"].values[names.index(name)])
        assert abs(value[k] - exact) < 0.8 * (high[k] - low[k]), name
    assert found.report.held_out[0][0] == "second"
    assert found.report.held_out[0][1] == pytest.approx(1.0, abs=0.35)
    assert "held out: second" in found.report.as_text()
    assert np.ptp(found["sample_signal"].values) == 0.0
    assert json.dumps(found.report.as_dict())
    again = vd.open_result(folder / "out.h5")
    assert (again["parameter_value"].values == value).all()
    assert not (folder / "out.h5.checkpoint").exists()


def test_a_stopped_study_goes_on_to_the_same_result(folder, monkeypatch):
    """Samples that were kept are not computed again."""
    whole = vd.uncertainty_study(folder / "spread.yaml")
    new, count = RandomCases._run, []

    def counted(self, point, **settings):
        count.append(point)
        if len(count) == 4:
            raise KeyboardInterrupt
        return new(self, point, **settings)

    monkeypatch.setattr(RandomCases, "_run", counted)
    with pytest.raises(KeyboardInterrupt):
        vd.uncertainty_study(folder / "spread.yaml", save_to=folder / "out.h5")
    again = vd.uncertainty_study(folder / "spread.yaml", save_to=folder / "out.h5", resume=True)
    assert len(count) == 4 + 5
    assert (again["sample"].values == whole["sample"].values).all()
    assert again["mean"].values == pytest.approx(whole["mean"].values, rel=0)
    assert "above 1.05 m" in again.report.as_text()
    count.clear()
    with pytest.raises(KeyboardInterrupt):
        vd.uncertainty_study(folder / "spread.yaml", save_to=folder / "out.h5", overwrite=True)
    (folder / "spread.yaml").write_text(SPREAD.replace("8", "16"), encoding="utf-8")
    with pytest.raises(InputError, match=r"out\.h5\.checkpoint: belongs to another computation"):
        vd.uncertainty_study(folder / "spread.yaml", save_to=folder / "out.h5", resume=True)


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("first.csv", "none.csv", "'none.csv' in the folder of the study: there is no such file"),
        ("column: height, noise: 1 mm}", "column: hight, noise: 1 mm}", "hight"),
        ("noise: 1 mm}", "noise: 1 kg}", "kg"),
        ("noise: 1 mm}", "noise: 0 mm}", "above zero"),
        ("body.height: {column", "body.hight: {column", "did you mean 'body.height'"),
        ("body.stiffness: {from", "body.stifness: {from", "did you mean 'body.stiffness'"),
        ("from: 5 kN/m", "from: 70 kN/m", "from must be below to"),
        ("start: 30 kN/m", "start: 90 kN/m", "outside its bounds"),
        ("prior: 1.2 kN*s/m, ", "", "both prior and deviation"),
        ("hold_out: [second]", "hold_out: [secnd]", "did you mean 'second'"),
        ("hold_out: [second]", "hold_out: [first, second]", "all experiments are held out"),
        ("lag: 5 ms", "lag: 50 ms", "outside the run"),
        ("parameters:\n", "parametres:\n", "unknown key; did you mean 'parameters'"),
    ],
)
def test_wrong_identifications_are_refused(folder, old, new, match):
    """Each with one clear message, before any search."""
    assert old in IDENTIFY
    (folder / "identify.yaml").write_text(IDENTIFY.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=match):
        vd.identify_study(folder / "identify.yaml")


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("time [s], height [mm]\n0, 0\n0, 1\n", "must grow"),
        ("time [s], height [mm]\n0, 0\n0.01, \n", "more samples"),
        ("time [s], height [mm]\n0, 0\n0.01, x\n", "'x' is no number"),
        ("time [s], height [kg]\n0, 0\n", "does not measure"),
        ("height [mm]\n0\n", "'time"),
    ],
)
def test_wrong_data_are_refused(folder, text, match):
    """Gaps are left out, but then there must be enough."""
    (folder / "first.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=match):
        vd.identify_study(folder / "identify.yaml")


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("method: sequence", "method: guess", "method: 'guess' is unknown"),
        ("number: 8", "number: 1", "at least 2"),
        ("number: 8", "number: many", "expected a whole number"),
        ("number: 8", f"number: 1{'0' * 400}", r"spread.yaml:\d+:9: number: .* of at most 1e\+07"),
        ("kind: normal", "kind: norml", r"spread.yaml:\d+:\d+: parameters\.\S+: kind 'norml'"),
        ("kind: normal", "kind: {a: [b]}", r"spread.yaml:\d+:\d+: parameters\.\S+: kind '{'a'"),
        ("of: [max(body.height), rms", "of: [body.height, rms", "is a curve"),
        ("max(body.height): {at_most", "max(body.hight): {at_most", "not among the figures"),
        ("at_most: 1.05 m", "at_most: 1 kg", r"spread.yaml:10:31: limits\.max\(.*at_most: .* in m"),
        ("at_most: 1.05 m", "at_most: [1 m]", r"spread.yaml:10:31: limits.*found a list"),
        ("scenario: run.yaml", "scenario: none.yaml", "none.yaml"),
    ],
)
def test_wrong_uncertainty_studies_are_refused(folder, old, new, match):
    """Each with one clear message."""
    assert old in SPREAD
    (folder / "spread.yaml").write_text(SPREAD.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=match):
        vd.uncertainty_study(folder / "spread.yaml")
