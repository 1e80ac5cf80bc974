"""Steps that are too long are told of, those left out are chosen, in runs and sweeps."""

from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result
from vehicledyn.results.store.study_reader import open_study
from vehicledyn.studies import load_study
from vehicledyn.studies.sweep import run_study

ROOT = Path(__file__).parents[3]
QUARTER_CAR = ROOT / "scenarios" / "systems" / "quarter_car.yaml"
MASSES = [100] * 12 + [0.001]
SLALOM = ROOT / "scenarios" / "iltis_slalom.yaml"


def run(scenario, output, *overrides, backend="auto"):
    loaded = load_scenario(scenario, overrides)
    return run_scenario(loaded, output=output, backend=backend, progress=lambda *_: None)


@pytest.mark.parametrize("backend", ["auto", "interpreted"])
def test_a_diverged_run_fails_and_keeps_what_is_finite(tmp_path, backend):
    path = tmp_path / "a.h5"
    overrides = ("solver.step=50 ms", "output.interval=50 ms")
    outcome = run(QUARTER_CAR, path, *overrides, backend=backend)
    assert outcome.status == "failed"
    (told,) = [text for text in outcome.messages if "diverges with a step of 50 ms" in text]
    assert "take a step of 6.25 ms" in told
    with open_result(path) as result:
        assert result.status == "failed"
        assert abs(result.channel("wheel.height").values).max() < 1e12


@pytest.mark.usefixtures("needs_compiler")  # interpreted runs name a channel, not the figure
@pytest.mark.parametrize(("step", "error"), [("10 ms", 3.0), ("5 ms", 0.1)])
def test_a_coarse_slalom_is_warned_of_with_the_step_to_take(tmp_path, step, error):
    """The side-slip angle is off by six times at 10 ms and by 13 % at 5 ms.

    Some processors end a longer run at 10 ms early, as its motion becomes a wild one.
    """
    brief = "duration=10 s"
    outcome = run(SLALOM, tmp_path / "a.h5", f"solver.step={step}", brief)
    assert outcome.status == "ok"
    (told,) = [text for text in outcome.messages if text.startswith("warning: the step is too")]
    assert "largest_sideslip_angle" in told
    with open_result(tmp_path / "a.h5") as result:
        facts = result.solver
        assert told in result.notes
    assert facts["accuracy"] == "inaccurate"
    assert facts["estimated_error"] > error
    again = run(SLALOM, tmp_path / "b.h5", f"solver.step={facts['recommended_step']} s", brief)
    assert not [text for text in again.messages if text.startswith("warning:")]
    angle = again.summary["largest_sideslip_angle"].value
    assert angle == pytest.approx(0.01550, rel=2e-2)


@pytest.mark.usefixtures("needs_compiler")  # interpreted runs are not taken again as a whole
def test_energy_from_nowhere_is_warned_of(tmp_path):
    """Heights are off by 1 % only, but 25 of 150 J are not accounted for."""
    coarse = "output.interval=40 ms"
    outcome = run(QUARTER_CAR, tmp_path / "a.h5", "solver.step=40 ms", coarse)
    (told,) = [text for text in outcome.messages if text.startswith("warning:")]
    assert "energy comes from nowhere or is lost, about 17 % of what is exchanged" in told
    with open_result(tmp_path / "a.h5") as result:
        facts = result.solver
    assert facts["least_accurate"] == "energy_drift"
    step = f"solver.step={facts['recommended_step']} s"
    for better in (step, "solver.step=1 ms"):  # what the samples miss is no reason to warn
        again = run(QUARTER_CAR, tmp_path / "b.h5", better, coarse)
        assert not [text for text in again.messages if text.startswith("warning:")]


@pytest.mark.usefixtures("needs_compiler")  # interpreted runs are not taken again as a whole
def test_the_energy_of_large_masses_hides_no_small_one(tmp_path):
    """A light mass in resonance is off by forty times; no key figure names one of 13 places."""
    masses = [f"  m{k}: {{joints: [T3 z], mass: {mass} kg}}" for k, mass in enumerate(MASSES)]
    springs = [
        f"  s{k}: {{coordinate: m{k}.z, law: {{kind: spring_damper, stiffness: {stiffness} N/m}}}}"
        for k, stiffness in enumerate([2000] * 12 + [1000])
    ]
    shake = "forces: {shake: {coordinate: m12.z, force: 0.01 N * sin(1000 rad/s * time)}}"
    (tmp_path / "many.yaml").write_text(
        "\n".join(["title: Many masses", "bodies:", *masses, "springs:", *springs, shake])
    )
    (tmp_path / "run.yaml").write_text(
        "title: A light mass is shaken\nmodel: many.yaml\nduration: 2 s\n"
        "solver: {kind: rk4, step: 1 ms}\noutput: {interval: 2 ms}"
    )
    outcome = run(tmp_path / "run.yaml", tmp_path / "a.h5")
    (told,) = [text for text in outcome.messages if text.startswith("warning:")]
    assert "'m12.z" in told
    assert "take a step of" in told


def test_an_accurate_run_says_so_in_its_file(tmp_path):
    outcome = run(QUARTER_CAR, tmp_path / "a.h5")
    assert not [text for text in outcome.messages if "step" in text]
    with open_result(tmp_path / "a.h5") as result:
        assert result.solver["accuracy"] == "accurate"
        assert result.solver["estimated_error"] < 1e-3
        assert "recommended_step" not in result.solver


def without_step(folder, scenario):
    text = scenario.read_text(encoding="utf-8").replace("step: 1 ms", "").replace("rk4, ", "rk4")
    path = folder / "stepless.yaml"
    path.write_text(text.replace("../../", f"{ROOT}/"), encoding="utf-8")
    assert "step:" not in path.read_text(encoding="utf-8")
    return path


@pytest.mark.parametrize("scenario", [QUARTER_CAR, SLALOM], ids=["quarter_car", "slalom"])
def test_a_step_left_out_is_chosen_told_and_kept(tmp_path, scenario):
    outcome = run(without_step(tmp_path, scenario), tmp_path / "a.h5")
    (told,) = [text for text in outcome.messages if text.startswith("step: ")]
    assert told.endswith(", chosen from the motion at the start")
    assert not [text for text in outcome.messages if text.startswith("warning:")]
    given = run(scenario, tmp_path / "b.h5")
    with open_result(tmp_path / "a.h5") as result:
        step = result.solver["largest_step"]
        assert told in result.notes
        assert result.solver["accuracy"] == "accurate"
    assert 1e-4 < step <= 2e-3
    for name, entry in given.summary.items():
        if isinstance(entry.value, float) and abs(entry.value) > 1e-3:
            assert outcome.summary[name].value == pytest.approx(entry.value, rel=0.02), name


@pytest.mark.parametrize("interval", [1e-11, 1e-305, 1e-309])
def test_intervals_may_be_as_short_as_numbers_are(tmp_path, interval):
    """The pictures between them would be further apart than the integers go."""
    overrides = (f"duration={4 * interval!r} s", f"output.interval={interval!r} s")
    outcome = run(QUARTER_CAR, tmp_path / "a.h5", *overrides, "solver={kind: rk4}")
    assert outcome.status == "ok"


def test_a_chosen_step_that_would_never_come_to_a_sample_is_refused(tmp_path):
    overrides = ("duration=1e12 s", "output.interval=1e12 s", "solver={kind: rk4}")
    with pytest.raises(NumericalError, match=r"too short for the output interval of 1e\+12 s"):
        run(QUARTER_CAR, tmp_path / "a.h5", *overrides)


def test_other_methods_need_no_step_and_get_none(tmp_path):
    outcome = run(
        ROOT / "scenarios" / "systems" / "double_pendulum.yaml", tmp_path / "a.h5", "duration=1 s"
    )
    assert not [text for text in outcome.messages if text.startswith("step: ")]


STUDY = f"""\
title: Quarter cars with softer and stiffer tyres
scenario: {QUARTER_CAR}
set: {{solver: {{kind: symplectic_euler, step: STEP}}, output.interval: 40 ms}}
cases: {{kind: grid, vary: {{parameters.wheel.stiffness: [20 kN/m, 40 kN/m, 60 kN/m]}}}}
"""


def sweep(folder, step, **options):
    (folder / "study.yaml").write_text(STUDY.replace("STEP", step), encoding="utf-8")
    settings = {"workers": 1, "lanes": None, "resume": False, "backend": "auto"} | options
    return run_study(
        load_study(folder / "study.yaml", ()),
        output=folder / f"{len(list(folder.iterdir()))}.h5",
        progress=lambda *_: None,
        **settings,
    )


def test_a_sweep_counts_its_inaccurate_cases(tmp_path):
    outcome = sweep(tmp_path, "40 ms")
    with open_study(outcome.path) as study:
        verdicts = study.figure_texts("accuracy")
        errors = study.figure("estimated_error")
        steps = study.figure("recommended_step") if "recommended_step" in study.figures else []
    number = verdicts.count("inaccurate")
    assert number, (verdicts, errors)
    (told,) = [text for text in outcome.messages if text.startswith("warning:")]
    assert f"too long in {number} of 3 cases" in told
    for verdict, error, step in zip(verdicts, errors, steps, strict=True):
        if verdict == "inaccurate":
            assert error > 0.04
            assert step < 0.04
    single = sweep(tmp_path, "40 ms", lanes=1)
    with open_study(single.path) as study:
        assert study.figure_texts("accuracy") == verdicts


def test_an_accurate_sweep_says_nothing(tmp_path):
    outcome = sweep(tmp_path, "1 ms")
    assert not [text for text in outcome.messages if text.startswith("warning:")]
    with open_study(outcome.path) as study:
        assert study.figure_texts("accuracy") == ["accurate"] * 3


def test_a_step_must_still_divide_the_interval():
    with pytest.raises(InputError, match="does not divide the output interval"):
        load_scenario(QUARTER_CAR, ("solver.step=0.7 ms",))
