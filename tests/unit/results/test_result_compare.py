import json
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from result_files import slalom_values

from vehicledyn.results.compare.any_compare import compare_results
from vehicledyn.results.compare.run_compare import compare_files

TIME, VALUES = slalom_values()
ROLL = VALUES["chassis.roll"][1]
LOAD = VALUES["wheel_fl.tyre.normal_force"][1]


def changed(**columns):
    """Values with some channels replaced; double underscores stand for dots."""
    return {**VALUES, **{name.replace("__", "."): column for name, column in columns.items()}}


@pytest.fixture
def reference(make_result):
    return make_result("reference.h5")


def test_equal_files(reference, make_result):
    comparison = compare_files(make_result(), reference, relative=0.0)
    assert comparison.verdict == "equal"
    assert "6 of 6 channels agree" in comparison.as_text()


def test_tolerance_is_relative_to_the_range(reference, make_result):
    span = np.ptp(LOAD)
    for share, verdict in ((0.9e-3, "equal"), (1.1e-3, "different")):
        off = LOAD.copy()
        off[17] += share * span
        path = make_result(values=changed(wheel_fl__tyre__normal_force=("N", off)))
        assert compare_files(path, reference, relative=1e-3).verdict == verdict


@pytest.mark.parametrize("level", [5.0, -5.0])
def test_tolerance_of_a_constant_is_relative_to_its_magnitude(make_result, level):
    noise = np.where(np.arange(len(TIME)) % 2, np.spacing(level), 0.0)
    reference = make_result("reference.h5", values={"a": ("m", level + noise)})
    for share, verdict in ((0.9e-3, "equal"), (1.1e-3, "different")):
        path = make_result(values={"a": ("m", np.full_like(TIME, level * (1.0 + share)))})
        assert compare_files(path, reference, relative=1e-3).verdict == verdict


def test_a_zero_reference_needs_an_absolute_tolerance(make_result):
    reference = make_result("reference.h5", values={"a": ("m", np.zeros_like(TIME))})
    path = make_result(values={"a": ("m", np.full_like(TIME, 1e-15))})
    assert compare_files(path, reference, relative=1.0).verdict == "different"
    assert compare_files(path, reference, relative=0.0, absolute=2e-15).verdict == "equal"
    assert compare_files(reference, reference, relative=0.0).verdict == "equal"


def test_the_worst_channel_its_values_and_time_are_named(reference, make_result):
    off, slightly = LOAD.copy(), ROLL.copy()
    off[30] += 100.0
    slightly[5] += 1e-5
    path = make_result(
        values=changed(wheel_fl__tyre__normal_force=("N", off), chassis__roll=("rad", slightly))
    )
    comparison = compare_files(path, reference)
    worst = comparison.worst
    assert worst.name == comparison.failed[0].name == "wheel_fl.tyre.normal_force"
    assert worst.time == TIME[30]
    assert (worst.value, worst.reference) == (off[30], LOAD[30])
    assert worst.difference == pytest.approx(100.0, rel=1e-12)
    assert "wheel_fl.tyre.normal_force: off by 100 N" in comparison.as_text()
    assert [channel.name for channel in comparison.failed][1] == "chassis.roll"


def test_tolerances_by_pattern(reference, make_result):
    path = make_result(values=changed(wheel_fl__tyre__normal_force=("N", LOAD + 10.0)))
    assert compare_files(path, reference).verdict == "different"
    loose = {"wheel_*.normal_force": 1e-2}
    assert compare_files(path, reference, channel_tolerances=loose).verdict == "equal"
    last = {**loose, "wheel_fl.*": 1e-6}
    assert compare_files(path, reference, channel_tolerances=last).verdict == "different"


def test_only_the_chosen_channels_are_compared(reference, make_result):
    path = make_result(values=changed(chassis__roll=("rad", ROLL + 1.0)))
    assert compare_files(path, reference, channels=["wheel_*"]).verdict == "equal"
    assert compare_files(path, reference, channels=["wheel_*", "chassis.r*"]).verdict == "different"


@pytest.mark.parametrize(
    "options", [{"channels": ["wheeel_fl"]}, {"channel_tolerances": {"x.*": 1}}]
)
def test_a_pattern_that_matches_nothing_is_unusable(reference, options):
    comparison = compare_files(reference, reference, **options)
    assert comparison.verdict == "unusable"
    assert "no channel matches" in comparison.as_text()


@pytest.mark.parametrize(
    "options",
    [
        {"relative": -1.0},
        {"relative": np.nan},
        {"absolute": np.inf},
        {"channel_tolerances": {"*": -1}},
    ],
)
def test_tolerances_that_are_none(reference, options):
    assert compare_files(reference, reference, **options).verdict == "unusable"


def test_a_missing_channel_fails_unless_allowed(reference, make_result):
    fewer = {name: column for name, column in VALUES.items() if name != "chassis.roll"}
    path = make_result(values=fewer)
    comparison = compare_files(path, reference)
    assert comparison.verdict == "different"
    assert "chassis.roll: missing from the result" in comparison.as_text()
    allowed = compare_files(path, reference, allow_missing=True)
    assert (allowed.verdict, allowed.skipped) == ("equal", ("chassis.roll",))
    nothing = compare_files(path, reference, channels=["chassis.roll"], allow_missing=True)
    assert nothing.verdict == "unusable"


def test_extra_channels_are_listed(reference, make_result):
    path = make_result(values={**VALUES, "chassis.pitch": ("rad", ROLL)})
    comparison = compare_files(path, reference)
    assert (comparison.verdict, comparison.extra) == ("equal", ("chassis.pitch",))
    assert comparison.as_text().endswith("only in the result, not compared: chassis.pitch")


def test_many_extra_channels_are_counted(reference, make_result):
    more = {f"further.channel_{number}": ("rad", ROLL) for number in range(9)}
    comparison = compare_files(make_result(values=VALUES | more), reference)
    assert len(comparison.as_dict()["extra"]) == 9
    listed = "further.channel_0, further.channel_1, further.channel_2, further.channel_3"
    assert comparison.as_text().endswith(f"not compared: {listed} and 5 more")


def test_units_must_be_equal(reference, make_result):
    path = make_result(values=changed(chassis__roll=("deg", ROLL)))
    comparison = compare_files(path, reference)
    assert comparison.verdict == "different"
    assert "unit is deg, in the reference rad" in comparison.as_text()


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", ["result", "reference", "both"])
def test_values_that_are_not_finite_fail(make_result, value, place):
    bad = ROLL.copy()
    bad[40] = value
    holed = changed(chassis__roll=("rad", bad))
    reference = make_result("ref.h5", values=VALUES if place == "result" else holed)
    path = make_result(values=VALUES if place == "reference" else holed)
    comparison = compare_files(path, reference, relative=1e9)
    assert comparison.verdict == "different"
    assert f"{value} in the" in comparison.as_text()


@pytest.mark.parametrize("interpolate", [False, True])
@pytest.mark.parametrize("cut", [slice(None, -1), slice(1, None)])
def test_a_shorter_run_fails(reference, make_result, cut, interpolate):
    short = {name: (unit, column[cut]) for name, (unit, column) in VALUES.items()}
    path = make_result(time=TIME[cut], values=short)
    comparison = compare_files(path, reference, interpolate=interpolate)
    assert comparison.verdict == "different"
    assert "the result ends at" in comparison.as_text() or "starts at" in comparison.as_text()


def test_another_grid_needs_interpolation(make_result):
    def line(time):
        return {"a": ("m", 3.0 * time)}

    coarse, fine = np.linspace(0.0, 1.0, 11), np.linspace(0.0, 1.2, 49)
    reference = make_result("ref.h5", time=coarse, values=line(coarse))
    path = make_result(time=fine, values=line(fine))
    refused = compare_files(path, reference)
    assert refused.verdict == "different"
    assert "49 samples, the reference has 11" in refused.as_text()
    assert compare_files(path, reference, interpolate=True, relative=1e-12).verdict == "equal"


def test_a_moved_sample_is_another_grid(reference, make_result):
    moved = TIME.copy()
    moved[100] += 1e-6
    comparison = compare_files(make_result(time=moved), reference)
    assert comparison.verdict == "different"
    assert "sample 100 lies at" in comparison.as_text()
    rounded = TIME * (1.0 + 1e-15)
    assert compare_files(make_result(time=rounded), reference, relative=0.0).verdict == "equal"


@pytest.mark.parametrize("status", ["failed", "interrupted"])
def test_partial_files_are_refused(reference, make_result, status):
    partial = make_result("partial.h5", status=status, message="because")
    for pair in ((partial, reference), (reference, partial)):
        comparison = compare_files(*pair)
        assert comparison.verdict == "unusable"
        assert f"partial: {status}" in comparison.as_text()


def test_a_killed_file_is_refused(reference, make_result):
    killed = make_result("killed.h5")
    with h5py.File(killed, "r+") as file:
        file.attrs["status"] = "running"
    comparison = compare_files(killed, reference)
    assert comparison.verdict == "unusable"
    assert "not a complete run (partial: broken off" in comparison.as_text()


def test_unusable_files_are_told_of_together(tmp_path, make_result):
    (tmp_path / "text.h5").write_text("no")
    comparison = compare_files(tmp_path / "none.h5", tmp_path / "text.h5")
    assert comparison.verdict == "unusable"
    assert "no such file" in comparison.as_text()
    assert "not an HDF5 file" in comparison.as_text()


def test_a_newer_format_is_refused(reference, make_result):
    newer = make_result()
    with h5py.File(newer, "r+") as file:
        file.attrs["format_version"] = 99
    assert compare_files(newer, reference).verdict == "unusable"


def test_a_reference_without_channels_or_samples_is_unusable(make_result):
    bare = make_result("bare.h5", values={})
    assert compare_files(bare, bare).verdict == "unusable"
    empty = make_result("empty.h5", time=TIME[:0], values={"a": ("m", TIME[:0])})
    assert compare_files(empty, empty).verdict == "unusable"


def test_one_flipped_channel_length_is_not_overlooked(reference, make_result):
    path = make_result()
    with h5py.File(path, "r+") as file:
        file["chassis/roll"].resize((len(TIME) - 1,))
    assert compare_files(path, reference).verdict == "unusable"


def test_another_model_is_noted(reference, make_result):
    path = make_result(model_hash="fedc")
    assert "other equations or parameters" in compare_files(path, reference).as_text()
    assert "model is bicycle" in compare_files(make_result(model="bicycle"), reference).as_text()


def test_only_the_missing_file_is_named(tmp_path):
    """Whatever the kind of the other one, whose own problems would mislead."""
    other = tmp_path / "modes.h5"
    with h5py.File(other, "w") as file:
        file.attrs["format"] = "vehicledyn-modes"
    for pair in ((other, tmp_path / "lost.h5"), (tmp_path / "lost.h5", other)):
        found = compare_results(*pair)
        assert found.problems == (f"{tmp_path / 'lost.h5'}: there is no such file",)


def test_other_parameters_are_no_other_equations(make_result):
    """The note names them, with both values."""
    given = {"equations_hash": "same", "parameters": {"mass": (1200.0, "kg"), "gap": (0.1, "m")}}
    reference = make_result("reference.h5", **given)
    heavy = given | {
        "model_hash": "fedc",
        "parameters": {"mass": (1300.0, "kg"), "gap": (0.1, "m")},
    }
    (note,) = compare_files(make_result(**heavy), reference).notes
    assert "other parameters than in the reference: mass = 1300 kg (reference 1200 kg)" in note
    assert "equations" not in note and "gap" not in note
    (note,) = compare_files(make_result(**(heavy | {"equations_hash": "x"})), reference).notes
    assert "other equations than" in note


def test_settings_that_differ_are_noted(make_result):
    """A number written into a system's file is no parameter, so equations and names are equal."""
    bodies = {"body": {"mass": 350.0}, "wheel": {"mass": 40.0}}
    reference = make_result("reference.h5", configuration={"title": "a", "bodies": bodies})
    assert compare_files(make_result("same.h5", configuration={"title": "b", "bodies": bodies}),
                         reference).notes == ()  # fmt: skip
    heavy = {"title": "a", "bodies": bodies | {"body": {"mass": 360.0}}, "road": {"kind": "flat"}}
    texts = [{"system": f"bodies:\n  body:\n    mass: {mass} kg\n"} for mass in (350, 360)]
    light = make_result("light.h5", configuration=texts[0])
    (note,) = compare_files(make_result("file.h5", configuration=texts[1]), light).notes
    assert note.endswith("system = mass: 360 kg (reference mass: 350 kg)")
    (note,) = compare_files(make_result("heavy.h5", configuration=heavy), reference).notes
    assert "bodies.body.mass = 360.0 (reference 350.0)" in note and "wheel" not in note
    assert "road.kind = flat (reference nothing)" in note


def test_json_is_strict(make_result):
    bad = ROLL.copy()
    bad[3] = np.nan
    path = make_result(values=changed(chassis__roll=("rad", bad)))
    found = json.loads(json.dumps(compare_files(path, path).as_dict(), allow_nan=False))
    assert (found["verdict"], found["worst"]) == ("different", "chassis.roll")
    assert len(found["channels"]) == 6


def test_junit_has_a_case_a_channel(reference, make_result):
    path = make_result(values=changed(chassis__roll=("rad", ROLL + 1.0)))
    suite = ElementTree.fromstring(compare_files(path, reference).as_junit()).find("testsuite")
    counts = {name: suite.get(name) for name in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": "7", "failures": "1", "errors": "0", "skipped": "0"}
    cases = suite.findall("testcase")
    assert [case.get("name") for case in cases] == ["files", *VALUES]
    failed = [case.get("name") for case in cases if case.find("failure") is not None]
    assert failed == ["chassis.roll"]


def test_junit_escapes_what_xml_cannot_hold(make_result):
    values = {'a<b>&"c\x01': ("m", TIME)}
    path = make_result(values=values)
    reference = make_result("ref.h5", values={'a<b>&"c\x01': ("m", TIME + 1.0)})
    root = ElementTree.fromstring(compare_files(path, reference).as_junit())
    assert root.find("testsuite/testcase[2]").get("name") == 'a<b>&"c?'


def test_junit_of_unusable_files_is_an_error(tmp_path):
    junit = compare_files(tmp_path / "a.h5", tmp_path / "b.h5").as_junit()
    suite = ElementTree.fromstring(junit).find("testsuite")
    assert suite.get("errors") == "1"
    assert "no such file" in suite.find("testcase/error").get("message")
