"""`import vehicledyn` is light, offers its names, and simulates to a value in memory."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest
from small_systems import pendulum

import vehicledyn as vd
from vehicledyn.base.errors import UnknownNameError
from vehicledyn.integrate.accuracy.monitor import Accuracy, AccuracyMonitor

HEAVY = ("casadi", "h5py", "matplotlib", "numpy", "pandas", "pydantic", "ruamel", "scipy", "xarray")
QUICK = {"backend": "interpreted"}
TIGHT = {"kind": "dop853", "relative_tolerance": 1e-12, "absolute_tolerance": 1e-12}


def run_python(code, folder, *words):
    done = subprocess.run(
        [sys.executable, *words, "-c", code], cwd=folder, check=False, capture_output=True,
        text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done


def test_import_loads_nothing_heavy_and_takes_no_time(tmp_path):
    code = f"""
import sys, time
begin = time.process_time()
import vehicledyn
spent = time.process_time() - begin
print(spent, [name for name in {HEAVY!r} if name in sys.modules])
"""
    spent, loaded = run_python(code, tmp_path).stdout.split(" ", 1)
    assert float(spent) < 0.1
    assert loaded.strip() == "[]"


def test_every_name_is_offered_and_documented():
    assert set(vd.__all__) <= set(dir(vd))
    for name in vd.__all__:
        assert getattr(vd, name) is not None
        if callable(getattr(vd, name)):
            assert getattr(vd, name).__doc__, name
    with pytest.raises(AttributeError, match="no attribute 'simulat'; did you mean 'simulate'"):
        vd.simulat  # noqa: B018


def test_a_file_with_keywords_is_simulated_without_a_word(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    result = vd.simulate("quarter_car", duration="0.1 s", set={"output.interval": "20 ms"}, **QUICK)
    height = result["body.height"]
    assert (height.unit, height.dims, height.shape) == ("m", ("time",), (6,))
    assert result.time == pytest.approx(np.arange(6) * 0.02)
    assert height.time is result.time or np.array_equal(height.time, result.time)
    assert (result.status, result.kind, result.is_whole) == ("ok", "run", True)
    assert capfd.readouterr() == ("", "")
    assert list(tmp_path.iterdir()) == []


def test_a_system_in_python_swings_as_the_closed_form_says():
    swing = vd.simulate(
        pendulum(), set={"initial.rod.angle": "0.01 deg"}, length="2 m", duration="2 s",
        output={"interval": "0.1 s"}, solver=TIGHT, **QUICK,
    )  # fmt: skip
    expected = math.radians(0.01) * np.cos(math.sqrt(1.5 * 9.81 / 2.0) * swing.time)
    assert swing["rod.angle"].values == pytest.approx(expected, abs=1e-10)
    assert swing.title == "pendulum, changed: initial.rod.angle = 0.01 deg, length = 2 m"


def test_a_value_is_changed_and_its_origin_stays():
    scenario = vd.load("quarter_car")
    longer = scenario.changed({"parameters.body.mass": "400 kg"}, duration="0.1 s")
    assert longer.scenario.duration == 0.1
    assert scenario.scenario.duration != 0.1
    assert longer.resolved["parameters"]["body.mass"] == 400.0
    twice = longer.changed(duration="0.2 s")
    assert twice.resolved["parameters"]["body.mass"] == 400.0
    assert "Scenario" in repr(twice) and "0.2 s" in repr(twice)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"duration": "1 kg"}, "duration: '1 kg' has the wrong unit"),
        ({"dration": "1 s"}, "dration: unknown key; did you mean 'duration'"),
        ({"set": {"solver.stp": 1}}, "solver.stp: unknown key; did you mean 'step'"),
        ({"set": "speed=1"}, "set: expected a mapping"),
        ({"duration": object()}, "duration: expected numbers, texts"),
    ],
)
def test_bad_input_names_the_argument_and_no_option(settings, words):
    with pytest.raises(vd.InputError) as caught:
        vd.simulate("quarter_car", **settings)
    assert words in str(caught.value)
    assert "--" not in str(caught.value)


def test_what_is_no_scenario_is_refused(tmp_path):
    with pytest.raises(vd.InputError, match="did you mean 'quarter_car'"):
        vd.simulate("quarter_cat")
    with pytest.raises(vd.InputError, match="scenario: expected a text, a path, a System"):
        vd.simulate(42)
    with pytest.raises(vd.InputError, match=r"no coordinate named 'rod\.angel'"):
        vd.simulate(pendulum(), set={"initial.rod.angel": 1.0})


def test_a_system_in_python_is_no_name_for_a_file(tmp_path):
    (tmp_path / "x.yaml").write_text("title: x\nmodel: python:pendulum\n", encoding="utf-8")
    with pytest.raises(vd.InputError, match=r"x\.yaml:2:8: model"):
        vd.load(tmp_path / "x.yaml")


def test_a_failed_run_warns_and_keeps_its_part(tmp_path):
    scenario = vd.load("quarter_car").changed(
        {"solver": {"kind": "rk4", "step": "0.1 s"}, "output.interval": "0.1 s"}, duration="50 s"
    )
    with pytest.warns(vd.UnfinishedWarning, match="not whole: failed") as caught:
        result = vd.simulate(scenario, **QUICK)
    assert result.status == "failed"
    assert 0.0 < result.time[-1] < 50.0
    assert [item.filename for item in caught] == [__file__]


def test_temporary_results_go_with_their_value():
    result = vd.simulate(pendulum(), duration="0.1 s", **QUICK)
    path = result.path
    assert path.is_file()
    del result
    assert not path.parent.exists()


def test_saving_refuses_what_exists(tmp_path):
    result = vd.simulate(pendulum(), duration="0.1 s", **QUICK)
    path = result.save(tmp_path / "kept.h5")
    with pytest.raises(vd.InputError, match=r"kept\.h5: exists; .*overwrite=True"):
        result.save(path)
    result.save(path, overwrite=True)
    again = vd.open_result(path)
    assert again["rod.angle"].values.tolist() == result["rod.angle"].values.tolist()
    with pytest.raises(vd.InputError, match=r"save_to=.*exists"):
        vd.simulate(pendulum(), save_to=path)
    with pytest.raises(vd.InputError, match="does not exist"):
        result.save(tmp_path / "none" / "x.h5")
    kept = vd.simulate(pendulum(), duration="0.1 s", save_to=tmp_path / "b.h5", **QUICK).path
    assert kept == tmp_path / "b.h5" and kept.is_file()


def test_progress_is_shown_only_when_asked_for(capfd):
    told = []
    vd.simulate(
        pendulum(), duration="0.1 s", progress=lambda text, part: told.append(text), **QUICK
    )
    assert told
    assert capfd.readouterr().err == ""
    vd.simulate(pendulum(), duration="0.1 s", progress=True, **QUICK)
    assert told[0] in capfd.readouterr().err


def test_a_restart_goes_on_from_a_value():
    whole = vd.simulate(pendulum(), duration="0.2 s", **QUICK)
    first = vd.simulate(pendulum(), duration="0.1 s", **QUICK)
    rest = vd.simulate(pendulum(), duration="0.2 s", restart=first, **QUICK)
    # Both are within ten times the usual tolerance of 1e-8.
    assert rest["rod.angle"].values == pytest.approx(whole["rod.angle"].values, abs=1e-7)


def test_names_are_found_by_pattern_and_unknown_ones_refused():
    result = vd.simulate(pendulum(), duration="0.1 s", **QUICK)
    assert result.names("rod.*") == ["rod.angle", "rod.angle_rate"]
    assert "rod.angle" in result and "rod" not in result
    assert result.get("rod") is None
    with pytest.raises(UnknownNameError, match=r"did you mean 'rod\.angle'"):
        result["rod.angel"]
    assert np.max(np.abs(result["rod.angle"])) == pytest.approx(0.5)
    assert (2.0 * result["rod.angle"])[0] == pytest.approx(1.0)
    assert result["rod.angle"].to("deg")[0] == pytest.approx(math.degrees(0.5))
    with pytest.raises(vd.InputError, match="is in rad, which is no m"):
        result["rod.angle"].to("m")


def test_it_shows_itself():
    result = vd.simulate(pendulum(), duration="0.1 s", **QUICK)
    text, page = repr(result), result._repr_html_()
    assert text.startswith("run of python:pendulum: pendulum (ok)")
    assert "rod.angle       time: 11  rad" in text
    assert "<td>rod.angle</td><td>time: 11</td><td>rad</td>" in page
    assert "rod.angle (time: 11) [rad]" in repr(result["rod.angle"])


def test_frames_and_data_sets():
    result = vd.simulate(pendulum(), duration="0.1 s", **QUICK)
    frame = result.to_dataframe("rod.*")
    assert list(frame.columns) == ["rod.angle", "rod.angle_rate"]
    assert frame.index.name == "time"
    assert frame["rod.angle"].iloc[0] == 0.5
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert data["rod.angle"].attrs["units"] == "rad"
    assert float(data["rod.angle"].sel(time=0.0)) == 0.5
    assert result["rod.angle"].to_xarray().dims == ("time",)


def test_channels_are_drawn_against_each_other_and_over_results():
    one = vd.simulate(pendulum(), duration="0.1 s", **QUICK)
    two = vd.simulate(pendulum(1.0), duration="0.1 s", **QUICK)
    figure = one.plot("rod.angle", "rod.angle_rate", others={"higher": two})
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "rod.angle [deg]",
        "Rate of rod.angle [deg/s]",
    ]
    assert len(figure.axes[0].lines) == 2
    assert figure._repr_png_().startswith(b"\x89PNG")
    phase = one.plot("rod.angle_rate", against="rod.angle")
    (line,) = phase.axes[0].lines
    assert line.get_xdata() == pytest.approx(one["rod.angle"].to("deg"))
    with pytest.raises(vd.InputError, match=r"did you mean 'rod\.angle'"):
        one.plot("rod.angel")


def test_accuracy_warnings_are_python_warnings(monkeypatch):
    found = Accuracy("inaccurate", 0.2, "'body.height'", 0.001)
    monkeypatch.setattr(AccuracyMonitor, "conclude", lambda self, **how: found)
    with pytest.warns(vd.AccuracyWarning, match="the step is too long") as caught:
        vd.simulate("quarter_car", duration="0.1 s", solver={"kind": "rk4"}, **QUICK)
    assert caught[0].filename == __file__


def test_configuration_says_what_was_changed(tmp_path):
    result = vd.simulate("quarter_car", duration="0.1 s", **QUICK)
    import h5py

    with h5py.File(result.path) as file:
        known = json.loads(file["scenario/configuration"].asstr()[()])
    assert known["overrides"] == ['duration="0.1 s"']
