"""Identification from frequency responses, bench curves and single figures."""

import h5py
import numpy as np
import pytest
from going_on import arrays, stopped

import vehicledyn as vd
import vehicledyn.catalogue  # the study is loaded behind the front door
from vehicledyn.base.errors import InputError, Interrupted
from vehicledyn.results.tables.identification_table import read_identification
from vehicledyn.studies.identification.study import load_identification

TRUTH = {"body.stiffness": "25 kN/m", "body.damping": "1.9 kN*s/m"}
CHANGES = {f"parameters.{name}": value for name, value in TRUTH.items()}
SCENARIO = """\
title: A quarter car
model: quarter_car
duration: 1 s
solver: {kind: rk4, step: 5 ms}
output: {interval: 10 ms}
"""
RESPONSE = """\
experiments:
  shaker:
    scenario: run.yaml
    data: shaker.csv
    figures:
      gain(body.height, road.height): {over: frequency, column: magnitude, relative_noise: 0.05}
      phase(body.height, road.height): {over: frequency, column: phase, noise: 3 deg}
      real(body.height, road.height): {over: frequency, column: real, noise: 0.05}
      imaginary(body.height, road.height): {over: frequency, column: imaginary, noise: 0.05}
      mean(body.height): {value: HEIGHT, noise: 1 mm}
parameters:
  body.stiffness: {from: 5 kN/m, to: 60 kN/m}
  body.damping: {from: 200 N*s/m, to: 8 kN*s/m}
"""
RIG = """\
experiments:
  rig:
    scenario: run.yaml
    data: bench.csv
    figures:
      rig(wheel.toe_angle, parallel): {over: travel, column: toe, noise: 0.2 mrad}
      kinematics(wheel.toe_angle, wheel.z): {over: height, column: toe_at, noise: 0.2 mrad}
      rig(wheel.camber_gain, parallel): {value: CAMBER, noise: 0.5 deg/m}
parameters:
  track_rod.inner.z: {from: 200 mm, to: 340 mm}
  upper.front.z: {from: 420 mm, to: 540 mm}
"""


def study(folder, text, scenario=SCENARIO):
    """Write a study and its scenario; return the study's path."""
    (folder / "run.yaml").write_text(scenario, encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def write_shaker(folder, seed=3):
    """Write what a shaker would measure of the true car, with noise and a gap, beyond a turn."""
    found = vd.sensitivity(
        "quarter_car",
        ["real(body.height, road.height, 0.5 Hz:12 Hz:23)",
         "imaginary(body.height, road.height, 0.5 Hz:12 Hz:23)"],
        "body.stiffness",
        set=CHANGES,
    )  # fmt: skip
    real, imaginary = found["figure_value"].values.reshape(2, -1)
    rng, frequencies = np.random.default_rng(seed), np.linspace(0.5, 12.0, 24)
    response = real + 1j * imaginary
    magnitude = np.abs(response) * (1.0 + 0.05 * rng.normal(size=24))
    phase = np.degrees(np.angle(response)) + 3.0 * rng.normal(size=24) - 360.0
    parts = [part + 0.05 * rng.normal(size=24) for part in (real, imaginary)]
    rows = [", ".join(map(repr, map(float, row))) for row in zip(
        frequencies, magnitude, phase, *parts, strict=True)]  # fmt: skip
    rows[5] = rows[5].rpartition(",")[0] + ", nan"
    head = "frequency [Hz], magnitude [1], phase [deg], real [1], imaginary [1]"
    (folder / "shaker.csv").write_text("\n".join([head, *rows]), encoding="utf-8")


@pytest.mark.long
def test_a_frequency_response_tells_spring_and_damper(tmp_path):
    write_shaker(tmp_path)
    path = study(tmp_path, RESPONSE)
    run = vd.simulate(tmp_path / "run.yaml", set=CHANGES)
    height = np.trapezoid(run["body.height"].values, run.time) / run.time[-1]
    path.write_text(RESPONSE.replace("HEIGHT", f"{height + 0.5e-3:.6f} m"), encoding="utf-8")
    found = vd.identify_study(path, save_to=tmp_path / "out.h5")
    low, high = found["parameter_low"].values, found["parameter_high"].values
    for k, truth in enumerate((25e3, 1.9e3)):
        middle, reach = 0.5 * (low[k] + high[k]), 0.5 * (high[k] - low[k])
        assert abs(middle - truth) < 1.5 * reach < 0.2 * truth
    assert found.attributes["variance"] == pytest.approx(1.0, abs=0.4)
    assert "1 gap is left out" in found.report.as_text()
    assert "frequency [Hz]" in read_identification(tmp_path / "out.h5").over


COMPLEX = """\
experiments:
  shaker:
    scenario: run.yaml
    data: shaker.h5
    figures:
      gain(body.height, road.height): {over: f, column: H, over_unit: Hz, unit: 1, noise: 0.05}
      phase(body.height, road.height): {over: f, column: H, over_unit: Hz, noise: 3 deg}
      imaginary(body.height, road.height): {over: f, column: H, over_unit: Hz, unit: 1, noise: 0.1}
parameters:
  body.stiffness: {from: 5 kN/m, to: 60 kN/m}
"""
PARTS = ("gain", "phase", "imaginary")


def test_parts_of_a_complex_column_are_those_of_plain_columns(tmp_path):
    """As the data of experiments, which are read from HDF5 and from CSV."""
    frequencies, values = np.array([1.0, 2.0, 5.0]), np.array([1.1 - 0.1j, -1.5j, 0.2 - 0.4j])
    with h5py.File(tmp_path / "shaker.h5", "w") as file:
        file["f"], file["H"] = frequencies, values
    path = study(tmp_path, COMPLEX)
    columns = np.abs(values), np.angle(values), values.imag
    rows = [
        ", ".join(map(repr, map(float, row))) for row in zip(frequencies, *columns, strict=True)
    ]
    head = "f [Hz], gain [1], phase [rad], imaginary [1]"
    (tmp_path / "shaker.csv").write_text("\n".join([head, *rows]), encoding="utf-8")
    own = load_identification(path).experiments[0].figures[0].items
    plain = COMPLEX.replace("shaker.h5", "shaker.csv").replace(", over_unit: Hz, unit: 1", "")
    plain = plain.replace(", over_unit: Hz", "")
    for part in PARTS:
        plain = plain.replace("column: H", f"column: {part}", 1)
    path.write_text(plain, encoding="utf-8")
    for one, other in zip(
        own, load_identification(path).experiments[0].figures[0].items, strict=True
    ):
        assert one.figures == other.figures
        assert list(one.values) == list(other.values)
    path.write_text(COMPLEX.replace("gain(body.height, road.height)", "rms(strut.force)"), "utf-8")
    with pytest.raises(InputError, match="has no places; leave 'over' out"):
        load_identification(path)


@pytest.mark.long
def test_bench_curves_tell_hardpoints(tmp_path):
    """Toe over travel on the rig and over the height of the wheel, and one camber gain."""
    truth = {"track_rod.inner.z": 0.26, "upper.front.z": 0.47}
    name, moved = "double_wishbone_suspension", [f"{n}={v} m" for n, v in truth.items()]
    names = [
        "rig(wheel.toe_angle, parallel, -60 mm:60 mm:4)",
        "kinematics(wheel.toe_angle, wheel.z, 270 mm:360 mm:3)",
        "rig(wheel.camber_gain, parallel)",
    ]
    set_to = {f"parameters.{item.partition('=')[0]}": item.partition("=")[2] for item in moved}
    values = [
        vd.sensitivity(name, of, "track_rod.inner.z", set=set_to)["figure_value"].values
        for of in names
    ]
    rng = np.random.default_rng(4)
    toe, toe_at = (v + 0.2e-3 * rng.normal(size=len(v)) for v in values[:2])
    rows = [f"{30.0 * k - 60.0}, {1e3 * a}, {270 + 30 * k}," for k, a in enumerate(toe)]
    rows = [f"{row} {1e3 * toe_at[k] if k < 4 else 'nan'}" for k, row in enumerate(rows)]
    head = "travel [mm], toe [mrad], height [mm], toe_at [mrad]"
    (tmp_path / "bench.csv").write_text("\n".join([head, *rows]), encoding="utf-8")
    text = RIG.replace("CAMBER", f"{values[2][0]:.9f} rad/m")
    found = vd.identify_study(study(tmp_path, text, SCENARIO.replace("quarter_car", name)))
    low, high = found["parameter_low"].values, found["parameter_high"].values
    for k, true in enumerate(truth.values()):
        assert low[k] < true < high[k]
        assert high[k] - low[k] < 0.05


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("over: frequency", "over: frequenzy", "did you mean 'frequency'"),
        ("column: phase", "column: fase", "did you mean 'phase'"),
        ("phase(body.height", "phase(body.hight", "did you mean"),
        ("noise: 3 deg", "noise: 3 mm", "a quantity in rad"),
        ("over: frequency, column: phase", "column: phase", "'value', or the column"),
        ("relative_noise: 0.05", "relative_noise: 0", "above zero"),
        ("    data: shaker.csv\n", "", "needs the 'data'"),
        ("value: HEIGHT", "value: HEIGHT, unit: mm", "is that of a curve"),
        ("column: real", "column: real, unit: mm", "is in '1'; leave 'unit' out"),
    ],
)
def test_what_is_no_curve_is_refused_in_its_line(tmp_path, old, new, match):
    (tmp_path / "shaker.csv").write_text(
        "frequency [Hz], magnitude [1], phase [deg], real [1], imaginary [1]\n1, 1, 1, 1, 1\n",
        encoding="utf-8",
    )
    text = RESPONSE.replace("HEIGHT", "1 m")
    changed = text.replace(old.replace("HEIGHT", "1 m"), new.replace("HEIGHT", "1 m"))
    with pytest.raises(InputError, match=match) as refused:
        vd.identify_study(study(tmp_path, changed))
    assert "study.yaml:" in str(refused.value)


RESUMED = """\
experiments:
  shaker:
    scenario: run.yaml
    data: shaker.csv
    figures:
      gain(body.height, road.height): {over: f, column: gain, noise: 0.05}
      max(strut.force): {value: 1.6 kN, noise: 100 N}
parameters:
  body.stiffness: {from: 15 kN/m, to: 35 kN/m}
"""


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:residuals are larger:vehicledyn.AccuracyWarning")
def test_a_stopped_identification_from_figures_goes_on_to_the_same_result(tmp_path, monkeypatch):
    """Wherever it was stopped, also by taking all runs that it may; no run is made twice."""
    (tmp_path / "shaker.csv").write_text("f [Hz], gain [1]\n1, 1.8\n2, 1.0\n", encoding="utf-8")
    path, out = study(tmp_path, RESUMED + "most_runs: 2\n"), tmp_path / "o.h5"
    steps = stopped(monkeypatch, 0)
    with pytest.warns(vd.AccuracyWarning, match="most allowed; .* go on with resume"):
        vd.identify_study(path, save_to=out)
    path.write_text(RESUMED, encoding="utf-8")
    vd.identify_study(path, save_to=out, resume=True)
    whole, count = arrays(out), len(steps)
    assert count == len(set(steps)) > 6
    for number in (1, 3, count - 1):
        out.unlink(missing_ok=True)
        with monkeypatch.context() as patch, pytest.raises((KeyboardInterrupt, Interrupted)):
            stopped(patch, number)
            vd.identify_study(path, save_to=out)
        assert not out.exists()
        vd.identify_study(path, save_to=out, resume=True)
        assert arrays(out) == whole


STIFFNESS = {"body.stiffness": {"from": "5 kN/m", "to": "60 kN/m"}}
CURVE = {
    "over": np.array([1.0, 2.0, 5.0]), "over_unit": "Hz",
    "values": np.array([1.1 - 0.1j, np.nan, 0.2 - 0.4j]), "noise": 0.05,
}  # fmt: skip


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:residuals are larger:vehicledyn.AccuracyWarning")
def test_both_doors_give_the_same_numbers(tmp_path):
    """Curves and figures from a study file, and as arrays."""
    gain, phase = "gain(body.height, road.height)", "phase(body.height, road.height)"
    with h5py.File(tmp_path / "shaker.h5", "w") as file:
        file["f"], file["H"] = CURVE["over"], CURVE["values"]
    text = COMPLEX.replace("imaginary(body.height, road.height)", "mean(body.height)")
    ending = "{over: f, column: H, over_unit: Hz, unit: 1, noise: 0.1}"
    text = text.replace(ending, "{value: 4 cm, noise: 1 m}").replace("noise: 3 deg", "noise: 0.05")
    path = study(tmp_path, text.replace("noise: 0.05}", "noise: 0.05 rad}").replace(" rad", "", 1))
    figures = {gain: CURVE, phase: CURVE, "mean(body.height)": {"value": 0.04, "noise": "1 m"}}
    own = vd.identify(tmp_path / "run.yaml", {}, STIFFNESS, figures=figures)
    found = vd.identify_study(path).report
    assert own.found.values.tolist() == found.found.values.tolist()
    assert own.found.covariance.tolist() == found.found.covariance.tolist()
    assert own.as_text().count("1 gap is left out") == 2


@pytest.mark.parametrize(
    ("name", "change", "match"),
    [
        ("gain", {"over_unit": None}, "states no unit of 'over'; give 'over_unit'"),
        ("gain", {"over_unit": "mm"}, "Hz"),
        ("gain", {"overs": 1}, "unknown key; did you mean 'over'"),
        ("gain", {"values": [1.0]}, "not of the same length"),
        ("gain", {"values": "no"}, "'values' holds no numbers"),
        ("gain", {"values": [[1.0, 2.0], [3.0]]}, "expected an array of numbers"),
        ("gain", {"unit": "kg"}, "'kg' does not measure"),
        ("gain", {"noise": "1 mm"}, "wrong unit"),
        ("gane", {}, "figures.gane.*did you mean"),
    ],
)
def test_wrong_figures_are_named_in_python(name, change, match):
    entry = {key: item for key, item in {**CURVE, **change}.items() if item is not None}
    figures = {f"{name}(body.height, road.height)": entry}
    with pytest.raises(InputError, match=match) as refused:
        vd.identify("quarter_car", {}, STIFFNESS, figures=figures, duration="1 s")
    assert str(refused.value).startswith("figures.")


def test_figures_that_are_no_mappings_are_named():
    with pytest.raises(InputError, match="figures: expected a mapping"):
        vd.identify("quarter_car", {}, STIFFNESS, figures={"rms(strut.force)": 1.0})
    with pytest.raises(InputError, match="measured: give one channel or more, or figures"):
        vd.identify("quarter_car", {}, STIFFNESS)


@pytest.mark.parametrize(
    ("times", "values", "match"),
    [
        ([0.0, 1.0], ["a", "b"], "values: expected an array of real numbers, found texts"),
        ([0.0, 1.0 + 1.0j], [0.0, 1.0], "times: expected .*, found complex numbers"),
        ([0.0, [1.0]], [0.0, 1.0], "times: expected an array of real numbers"),
    ],
)
def test_channels_that_are_no_numbers_are_named(times, values, match):
    with pytest.raises(InputError, match=f"measured: body.height: {match}"):
        vd.identify("quarter_car", {"body.height": (times, values, "1 mm")}, STIFFNESS)
