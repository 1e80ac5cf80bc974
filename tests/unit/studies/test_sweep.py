"""Sweeps in one process: results, choices, failures, going on, and the file."""

import json
import os

import h5py
import numpy as np
import pytest
from small_study import PENDULUM, STUDY, swept, written

from vehicledyn.analyses.simulation.simulation import run_scenario
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.compare.study_compare import compare_studies
from vehicledyn.results.compare.tolerances import Tolerances
from vehicledyn.results.store import case_checksums
from vehicledyn.results.store.reader import open_result
from vehicledyn.results.store.study_reader import open_study
from vehicledyn.results.store.study_writer import StudyWriter, pending
from vehicledyn.studies import sweep

pytestmark = pytest.mark.long

EXACTLY = Tolerances(0.0, 0.0)
SLALOM = PENDULUM.parents[1] / "iltis_slalom.yaml"

VERDICT = {"accuracy", "estimated_error"}
"""What a study keeps of the accuracy of each case, whatever figures it asks for."""


def contents(path):
    """Return all numbers and texts of a study's file by place, figures by name."""
    with open_study(path) as file:
        found = {name: file.figure(name) for name in file.figures}
        found |= {f"{name} text": file.figure_texts(name) for name in file.figures}
    with h5py.File(path) as file:
        found |= {name: file[name][()] for name in ("time", "samples") if name in file}
        found |= {name: file["cases"][name][()] for name in file["cases"]}
    return found


def same(first, second):
    one, other = contents(first), contents(second)
    assert one.keys() == other.keys()
    for name, values in one.items():
        np.testing.assert_array_equal(values, other[name], err_msg=name)


def test_a_case_is_the_run_of_its_scenario(tmp_path, study):
    outcome = swept(study, tmp_path / "out.h5")
    assert (outcome.status, outcome.counts["done"]) == ("ok", 24)
    with open_study(outcome.path) as file:
        values, samples = file.values(), file.samples(11)
        case = zip(file.axes, values[11].tolist(), strict=True)
        changes = [f"{axis.name}={value!r} {axis.unit}" for axis, value in case]
        loaded = load_scenario(
            PENDULUM,
            [*changes, "solver={kind: rk4, step: 1 ms}", "duration=0.2 s", "output.interval=20 ms"],
        )
        single = run_scenario(
            loaded,
            output=tmp_path / "single.h5",
            backend="auto",
            progress=lambda *_: None,
        )
        with open_result(single.path) as result:
            assert file.times == pytest.approx(result.time, abs=1e-15)
            for number, channel in enumerate(file.channels):
                wanted = result.channel(channel.name)
                assert samples[:, number] == pytest.approx(wanted.values, rel=1e-11, abs=1e-11)
                assert channel.unit == wanted.unit
        summary = {name: entry.value for name, entry in single.summary.items()}
        figures = {n: file.figure(n)[11] for n in file.figures if n not in VERDICT}
        assert figures == pytest.approx(summary, rel=1e-9, abs=1e-11)


def test_vehicle_starts_in_the_equilibrium_of_each_case(tmp_path):
    text = f"""\
title: Slaloms
scenario: {SLALOM}
set: {{duration: 0.1 s}}
cases:
  kind: list
  rows:
    - {{speed: 36 km/h, parameters.chassis.mass: 1.2 t, tyres.friction: 0.9}}
    - {{speed: 50 km/h, parameters.chassis.mass: 1.6 t, tyres.friction: 1.0}}
    - {{speed: 20 km/h, parameters.chassis.mass: 1.0 t, tyres.friction: 0.6}}
output: {{interval: 10 ms, channels: [chassis.*, wheel_*.tyre.normal_force]}}
"""
    outcome = swept(written(tmp_path, text), tmp_path / "out.h5")
    assert outcome.status == "ok"
    with open_study(outcome.path) as file:
        names = [c.name for c in file.channels]
        for case, (speed, mass) in enumerate(((10.0, 1200.0), (50 / 3.6, 1600.0), (20 / 3.6, 1e3))):
            start = dict(zip(names, file.samples(case)[0], strict=True))
            assert start["chassis.x_rate"] == pytest.approx(speed, rel=1e-12)
            load = sum(v for name, v in start.items() if name.endswith("normal_force"))
            rest = 4 * 57.35 + 4 * 6.0  # wheels and arms [kg]
            assert load == pytest.approx((mass + rest) * 9.81, rel=2e-3)
            later = dict(zip(names, file.samples(case)[-1], strict=True))
            assert later["chassis.z"] == pytest.approx(start["chassis.z"], abs=1e-6)


def test_starts_that_parameters_alone_do_not_give(tmp_path):
    """Of the coordinates of a system, and of wheels whose radius gives their spin."""
    text = (
        STUDY.partition("cases:")[0]
        + """\
cases:
  kind: list
  rows:
    - {initial.upper.angle: 30 deg, initial.lower.angle_rate: 1 rad/s}
    - {initial.upper.angle: -1.5 rad, initial.lower.angle_rate: -20 deg/s}
output: {interval: 20 ms, channels: [upper.*, lower.*]}
"""
    )
    outcome = swept(written(tmp_path, text), tmp_path / "out.h5")
    with open_study(outcome.path) as file:
        names = [c.name for c in file.channels]
        for case, (angle, rate) in enumerate(((np.pi / 6, 1.0), (-1.5, -np.pi / 9))):
            start = dict(zip(names, file.samples(case)[0], strict=True))
            assert start["upper.angle"] == pytest.approx(angle, rel=1e-14)
            assert start["lower.angle_rate"] == pytest.approx(rate, rel=1e-14)
    text = f"""\
title: Wheels
scenario: {SLALOM}
set: {{duration: 10 ms, start: static}}
cases: {{kind: grid, vary: {{front.unloaded_radius: [360 mm, 370 mm]}}}}
output: {{interval: 10 ms, channels: [wheel_*.spin_angle_rate], figures: false}}
"""
    outcome = swept(written(tmp_path, text), tmp_path / "wheels.h5")
    with open_study(outcome.path) as file:
        names = [c.name for c in file.channels]
        for case, radius in enumerate((0.36, 0.37)):
            start = dict(zip(names, file.samples(case)[0], strict=True))
            assert start["wheel_fl.spin_angle_rate"] == pytest.approx(10.0 / radius, rel=1e-12)
            assert start["wheel_rl.spin_angle_rate"] == pytest.approx(10.0 / 0.363812, rel=1e-12)


def test_lanes_blocks_and_resuming_change_nothing(tmp_path, study, monkeypatch):
    whole = swept(study, tmp_path / "whole.h5").path
    same(whole, swept(study, tmp_path / "scalar.h5", lanes=1).path)
    same(whole, swept(study, tmp_path / "four.h5", lanes=4).path)
    calls = []
    write = StudyWriter.write

    def stop_after_two(writer, block):
        write(writer, block)
        calls.append(range(block.first, block.first + len(block)))
        if len(calls) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(sweep, "_BLOCK_BYTES", 1)  # blocks of eight cases
    monkeypatch.setattr(sweep, "_CHUNK_BYTES", 10_000)
    monkeypatch.setattr(StudyWriter, "write", stop_after_two)
    outcome = swept(study, tmp_path / "parts.h5")
    assert outcome.status == "interrupted"
    assert outcome.counts == {"done": 16, "failed": 0, "ended": 0, "driver_lost": 0, "pending": 8}
    assert "16 of 24 cases are kept in parts.h5, continue with resume" in "\n".join(
        outcome.messages
    )
    outcome = swept(study, tmp_path / "parts.h5", resume=True)
    assert outcome.status == "ok"
    assert sorted(k for span in calls for k in span) == list(range(24))  # nothing twice
    same(whole, tmp_path / "parts.h5")
    done = swept(study, tmp_path / "parts.h5", resume=True)
    assert (done.status, len(calls)) == ("ok", 3)


def test_choices_have_equations_of_their_own(tmp_path):
    text = (
        STUDY.partition("cases:")[0]
        + """\
cases:
  kind: grid
  vary:
    solver.kind: [rk4, symplectic_euler]
    parameters.mass: [1 kg, 2 kg]
output: {interval: 20 ms, channels: [tip.z], precision: single, figures: false}
"""
    )
    outcome = swept(written(tmp_path, text), tmp_path / "out.h5")
    assert outcome.counts["done"] == 4
    with open_study(outcome.path) as file:
        tips = file.channel("tip.z")
        assert tips.dtype == np.float32
        assert file.axes[0].choices == ('"rk4"', '"symplectic_euler"')
        assert set(file.figures) == VERDICT
    assert np.allclose(tips[0], tips[1])  # equal masses fall equally
    assert np.abs(tips[0] - tips[2]).max() > 1e-4  # first order is less exact


@pytest.mark.usefixtures("needs_compiler")  # interpreted cases are judged while they run
def test_failed_cases_are_told_and_kept(tmp_path):
    quarter = PENDULUM.with_name("quarter_car.yaml")
    text = f"""\
title: Quarter cars
scenario: {quarter}
set: {{solver: {{kind: rk4, step: 1 ms}}, start: nominal, duration: 1 s}}
cases:
  kind: grid
  vary: {{wheel.stiffness: [180 kN/m, 1.0e+10 N/m, 200 kN/m]}}
output: {{interval: 10 ms, channels: [wheel.height]}}
"""
    outcome = swept(written(tmp_path, text), tmp_path / "out.h5")
    assert (outcome.status, outcome.counts["failed"] > 0) == ("ok", True)
    assert outcome.counts == {"done": 2, "failed": 1, "ended": 0, "driver_lost": 0, "pending": 0}
    ((case, time, reason),) = outcome.failures
    assert case == 1
    assert "is no longer a finite number after t =" in reason
    assert f"case 1: {reason}" in outcome.as_text()
    json.dumps(outcome.as_dict() | {"result": ""})
    with open_study(outcome.path) as file:
        reached = file.times <= time
        assert np.isfinite(file.samples(1)[reached]).all()
        assert not np.isfinite(file.samples(1)[~reached]).any()
        assert np.isfinite(file.samples(2)).all()


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("cases.seed=6", "the study has changed"),
        ("duration=0.4 s", "its scenario or model has changed"),
        ("output.precision=single", "the study has changed"),
    ],
)
def test_another_study_cannot_go_on_in_a_file(tmp_path, study, override, words):
    path = swept(study, tmp_path / "out.h5", "cases.number=2").path
    before = path.read_bytes()
    with pytest.raises(InputError, match=f"cannot be continued: .*{words}"):
        swept(study, path, "cases.number=2", override, resume=True)
    assert path.read_bytes() == before


def test_another_program_cannot_go_on_in_a_file(tmp_path, study, monkeypatch):
    path = swept(study, tmp_path / "out.h5", "cases.number=2").path
    monkeypatch.setattr("vehicledyn.studies.block.program_fingerprint", lambda: "other")
    with pytest.raises(InputError, match="begun by another version of vehicledyn"):
        swept(study, path, "cases.number=2", resume=True)


def test_files_that_exist_or_cannot_be_written(tmp_path, study):
    path = swept(study, tmp_path / "out.h5", "cases.number=2").path
    with pytest.raises(InputError, match="exists; go on with it by resume"):
        swept(study, path, "cases.number=2")
    other = tmp_path / "text.h5"
    other.write_text("no result", encoding="utf-8")
    with pytest.raises(InputError, match="is no HDF5 file"):
        swept(study, other, resume=True)
    with pytest.raises(InputError, match="does not exist"):
        swept(study, tmp_path / "none" / "out.h5")
    if os.geteuid():
        path.chmod(0o400)
        with pytest.raises(InputError, match="read-only"):
            swept(study, path, "cases.number=2", resume=True)


def test_a_full_disk_loses_nothing(tmp_path, study, monkeypatch):
    from vehicledyn.results.hdf5 import disk

    whole = swept(study, tmp_path / "whole.h5").path
    monkeypatch.setattr(sweep, "_BLOCK_BYTES", 1)
    monkeypatch.setattr(sweep, "_CHUNK_BYTES", 10_000)
    path, limit = tmp_path / "out.h5", [0]
    write = disk._SteadyFile.write

    def no_space(file, data):
        if limit[0] and file.tell() + len(data) > limit[0]:
            file.error = OSError(28, "No space left on device")
        return write(file, data)

    monkeypatch.setattr(disk._SteadyFile, "write", no_space)
    for size in (40_000, 55_000, 70_000, 90_000):
        limit[0] = size
        try:
            swept(study, path, resume=True)
        except InputError as error:
            assert "No space left on device" in str(error)
            assert "continue with resume" in str(error)
    limit[0] = 0
    assert swept(study, path, resume=True).counts["done"] == 24
    same(whole, path)


def test_more_than_the_disk_holds_is_refused_at_once(tmp_path, study):
    with pytest.raises(InputError, match=r"1000000000000 cases need about .* TB, .* has .* free"):
        swept(study, tmp_path / "out.h5", "cases.number=1000000000000")
    assert not (tmp_path / "out.h5").exists()


@pytest.mark.parametrize("change", ["output.precision=double", "output.precision=single"])
def test_cases_too_long_for_the_memory_are_kept_on_the_disk(tmp_path, study, monkeypatch, change):
    """A worker holds a case until its figures are found: 5 million samples took gigabytes."""
    whole = swept(study, tmp_path / "whole.h5", change).path
    monkeypatch.setattr(sweep, "LARGEST_CASE", 1000)
    monkeypatch.setattr(sweep, "_MOST_BYTES", 1)
    monkeypatch.setattr(case_checksums, "AT_ONCE", 200)
    same(whole, swept(study, tmp_path / "out.h5", change).path)
    assert {path.name for path in tmp_path.iterdir()} >= {"whole.h5", "out.h5"}
    assert not [path for path in tmp_path.iterdir() if path.name.startswith((".", "tmp"))]
    monkeypatch.setattr(sweep, "_MOST_SAMPLES", 3)
    with pytest.raises(InputError, match=r"\d+ samples of \d+ channels need .*B of memory a case"):
        swept(study, tmp_path / "none.h5")
    assert not (tmp_path / "none.h5").exists()


def test_a_full_disk_has_no_room_for_a_case(tmp_path, study, monkeypatch):
    def fallocate(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(sweep, "LARGEST_CASE", 1000)
    monkeypatch.setattr("vehicledyn.base.numbers.disk_array.os.posix_fallocate", fallocate)
    with pytest.raises(InputError, match="No space left on device"):
        swept(study, tmp_path / "out.h5")


def test_long_cases_are_computed_one_at_a_time(tmp_path, study, monkeypatch):
    """A block held eight cases at least, however long they were."""
    spans = []

    def noted(status, chunk, most):
        spans.extend(pending(status, chunk, most))
        return iter(spans)

    monkeypatch.setattr(sweep, "pending", noted)
    whole = swept(study, tmp_path / "whole.h5").path
    assert max(stop - first for first, stop in spans) > 1
    spans.clear()
    monkeypatch.setattr(sweep, "_MOST_BYTES", 1)
    monkeypatch.setattr(sweep, "_CHUNK_BYTES", 1)
    single = swept(study, tmp_path / "single.h5").path
    assert spans == [(k, k + 1) for k in range(24)]
    same(whole, single)


def test_spans_of_pending_cases():
    status = np.array([0, 0, 1, 1, 0, 2, 0, 0, 0], dtype=np.int8)
    assert list(pending(status, 2, 4)) == [(0, 2), (4, 5), (6, 8), (8, 9)]
    assert list(pending(np.ones(5, dtype=np.int8), 2, 4)) == []


def test_files_of_studies_are_compared(tmp_path, study):
    first = swept(study, tmp_path / "a.h5").path
    second = swept(study, tmp_path / "b.h5", "output.precision=single").path
    assert compare_studies(first, first, tolerances=EXACTLY).is_equal
    rough = compare_studies(second, first, tolerances=EXACTLY)
    assert rough.verdict == "different"
    assert "in case" in rough.as_text()
    assert compare_studies(second, first, tolerances=Tolerances(1e-6, 0.0)).is_equal
    missed = compare_studies(first, first, tolerances=EXACTLY, channels=["nothing"])
    assert "channels: no channel matches 'nothing'" in missed.as_text()
    third = swept(study, tmp_path / "c.h5", "cases.number=3").path
    assert (
        "3 cases, in the reference 24"
        in compare_studies(third, first, tolerances=EXACTLY).as_text()
    )
