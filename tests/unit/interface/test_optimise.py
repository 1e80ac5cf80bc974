"""Optimisation studies, from Python."""

import json
import re

import numpy as np
import pytest
from programs import call

import vehicledyn as vd
from vehicledyn.analyse.objective import Evaluated
from vehicledyn.analyse.optimise import optimise
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.cli.exit_codes import NEGATIVE, code_of_result
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.failed_runs import failure_notes, with_values

SCENARIO = """\
title: A quarter car on a shaker
model: quarter_car
duration: 2 s
solver: {kind: rk4, step: 5 ms}
output: {interval: 10 ms}
"""
STUDY = """\
title: Body and strut
scenarios: run.yaml
variables:
  body.stiffness: {from: 5 kN/m, to: 60 kN/m, start: 50 kN/m}
  parameters.body.damping: {from: 200 N*s/m, to: 8 kN*s/m, start: 7 kN*s/m}
minimise: {rms(strut.force): 1}
constraints:
  rms(strut.rate): {at_most: 0.12 m/s}
"""


def study(folder, text=STUDY):
    """Write a study and its scenario; return the study's path."""
    (folder / "run.yaml").write_text(SCENARIO, encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_constrained_optimum_is_stationary(tmp_path):
    """The gradient is a multiple of that of the active constraint, and bounds hold."""
    found = vd.optimise(study(tmp_path))
    report = found.report
    assert found.kind == "optimum"
    assert found.attributes["optimality"] < 1e-5
    start, best = found["figure_start"].values, found["figure_best"].values
    assert best[0] < start[0]
    assert best[1] == pytest.approx(0.12, rel=1e-5)
    assert report.as_dict()["active"] == ["rms(strut.rate)"]
    assert found.attributes["runs"] < 40
    assert "active: rms(strut.rate) at most 0.12" in report.as_text()


def test_a_stopped_search_goes_on_to_the_same_optimum(tmp_path, monkeypatch):
    """Runs that were kept are not computed again; the result is the same to the last bit."""
    path = study(tmp_path)
    found = vd.optimise(path)
    whole = found["variable_best"].values
    from vehicledyn.studies.optimisation import problem

    new, count = problem.Problem._new, []

    def counted(self, point, **settings):
        count.append(point)
        if len(count) == 3:
            raise KeyboardInterrupt
        return new(self, point, **settings)

    monkeypatch.setattr(problem.Problem, "_new", counted)
    with pytest.raises(KeyboardInterrupt):
        vd.optimise(path, save_to=tmp_path / "out.h5")
    kept = tmp_path / "out.h5.checkpoint"
    kept.write_bytes(kept.read_bytes() + b"cut off")
    again = vd.optimise(path, save_to=tmp_path / "out.h5", resume=True)
    assert (again["variable_best"].values == whole).all()
    assert again.notes == found.notes
    assert "2 runs were known" in again.report.as_text()
    assert not kept.exists()


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("body.stiffness: {", "body.stifness: {", "did you mean 'body.stiffness'"),
        ("from: 5 kN/m", "from: 70 kN/m", "from must be below to"),
        ("start: 50 kN/m", "start: 90 kN/m", "outside its bounds"),
        (
            "variables:\n",
            "variables:\n  wheel.mass: {from: 0 kg, to: 60 kg}\n",
            r"variables\.wheel\.mass: the model refuses 0 kg: .*greater than 0 kg",
        ),
        ("from: 5 kN/m", "from: 5 kg", r"variables\.body\.stiffness\.from: '5 kg'"),
        ("at_most: 0.12", "at_least: 0.2 m/s, at_most: 0.12", "at_least is above at_most"),
        ("rms(strut.rate)", "rms(strut.rat)", "did you mean 'strut.rate'"),
        ("at_most", "most", "did you mean .at_most"),
        ("at_most: 0.12 m/s", "at_most: 0.12", "0.12 has no unit; write '0.12 m/s'"),
        ("rms(strut.force): 1}", "rms(strut.force): .nan}", "a weight that is not zero"),
        ("minimise: {rms(strut.force): 1}", "minimise: body.height_rate", "is a curve"),
        ("minimise:", "minimize:", "unknown key"),
        ("scenarios: run.yaml", "scenarios: none.yaml", "none.yaml"),
        ("minimise:", "front: {figure: rms(strut.rate)}\nminimise:", "a list at_most or"),
        ("minimise:", "starts: 0\nminimise:", "a whole number of at least 1"),
        ("minimise:", "optimiser: simplex\nminimise:", "known: trust_region, slsqp, ipopt"),
        ("minimise:", "choices: {speed: 3}\nminimise:", "a list of values"),
        ("minimise:", "least_squares: {a: {target: 1, size: 1}}\nminimise:", "either minimise or"),
        ("minimise:", "scatter: {body.mas: {kind: normal}}\nminimise:", "did you mean 'body.mass'"),
        ("minimise:", "scatter: {body.mass: {kind: normal}}\nminimise:", "has mean, deviation"),
        (
            "minimise: {rms(strut.force): 1}",
            "minimise: [rms(strut.force)]",
            "expected a figure, or weights",
        ),
    ],
)
def test_wrong_studies_are_refused(tmp_path, old, new, match):
    """Each with one clear message."""
    assert old in STUDY
    with pytest.raises(InputError, match=match):
        vd.optimise(study(tmp_path, STUDY.replace(old, new)))


@pytest.mark.long
def test_a_front_of_compromises_and_several_starts(tmp_path):
    """Each compromise keeps its limit and is stationary; no other start does better."""
    front = "front: {figure: rms(strut.rate), at_most: [0.11 m/s, 0.1 m/s, 0.09 m/s]}\nstarts: 3\n"
    found = vd.optimise(study(tmp_path, STUDY + front), save_to=tmp_path / "out.h5")
    alone = vd.optimise(study(tmp_path))
    assert found["figure_best"].values == pytest.approx(alone["figure_best"].values, rel=1e-4)
    assert found["front_figure"].values == pytest.approx([0.11, 0.1, 0.09], rel=1e-5)
    assert (np.diff(found["front_objective"].values) > 0.0).all()
    assert (found["front_optimality"].values < 1e-4).all()
    assert sum("start " in note for note in found.notes) == 3
    from vehicledyn.results.plots.table_results import table_figures

    assert [name for name, _ in table_figures(tmp_path / "out.h5")] == ["convergence", "front"]
    assert len(found.report.as_dict()["front"]) == 3
    assert "front: objective" in found.report.as_text()


RATTLING = """\
title: A block comes to rest by dry friction
gravity: [0, 0, 0]
parameters: {stiffness: 100 N/m, friction: 5 N}
bodies: {block: {joints: [T1 x], mass: 1 kg}}
forces:
  f: {coordinate: block.x, force: "-stiffness*position - friction*where(rate > 0 m/s, 1, -1)"}
initial: {block.x_rate: 1 m/s}
"""


@pytest.mark.long
def test_gradients_that_runs_do_not_confirm_are_reported(tmp_path):
    """A force that holds the block changes its sign in every step."""
    (tmp_path / "rattling.yaml").write_text(RATTLING, encoding="utf-8")
    path = study(
        tmp_path,
        "scenarios: run.yaml\nmost_runs: 2\nminimise: mean(block.x)\n"
        "variables: {stiffness: {from: 90 N/m, to: 110 N/m}, friction: {from: 4 N, to: 6 N}}\n",
    )
    run = SCENARIO.replace("model: quarter_car", "model: rattling.yaml").replace("2 s", "1 s")
    (tmp_path / "run.yaml").write_text(run.replace("step: 5 ms", "step: 1 ms"), encoding="utf-8")
    with (
        pytest.warns(vd.AccuracyWarning, match="do not confirm"),
        pytest.warns(vd.UnfinishedWarning, match="stopped after 2 runs"),
    ):
        vd.optimise(path)


@pytest.mark.long
def test_a_variable_is_one_of_every_scenario(tmp_path):
    """Another model that lacks it is refused, not only the first one."""
    text = STUDY.replace("scenarios: run.yaml", "scenarios: {a: run.yaml, b: double_pendulum}")
    text = text.replace("rms(strut", "a/rms(strut")
    text = text.replace("minimise: {", "minimise: {b/rms(upper.angle): 1, ")
    with pytest.raises(InputError, match="no parameter of 'double_pendulum'"):
        vd.optimise(study(tmp_path, text))


def test_a_failed_run_is_retreated_from():
    """Beyond x = 2 there is no motion; the search comes back and reports it."""

    def evaluate(x):
        if x[0] > 2.0:
            raise NumericalError("flies off")
        return Evaluated(float((x[0] - 1.9) ** 2), 2.0 * (x - 1.9), np.zeros(0), np.zeros((0, 1)))

    found = optimise(
        evaluate,
        start=np.array([0.0]),
        bounds=(np.array([-10.0]), np.array([10.0])),
        tolerance=1e-14,
        most_runs=60,
    )
    assert found.variables == pytest.approx([1.9], abs=1e-5)
    assert json.dumps(found.failures) == json.dumps(["flies off"] * len(found.failures))
    point = with_values([Quantity("angle", "rad", "")], [np.pi])
    notes = failure_notes([f"{point}: flies off"] * 6)
    assert notes[:4] == ["a run failed with angle = 180 deg: flies off"] * 4
    assert notes[4:] == ["2 further runs failed; all were retreated from"]


@pytest.mark.long
def test_a_search_that_took_all_its_runs_goes_on_with_more(tmp_path):
    """To the result of a search that was allowed all of them at once, with none made twice."""
    path, out = study(tmp_path, STUDY.replace("constraints:", "most_runs: 3\nconstraints:")), "o.h5"
    with pytest.warns(vd.UnfinishedWarning, match="stopped after 3 runs"):
        found = vd.optimise(path, save_to=tmp_path / out)
    assert "go on with resume" in found.report.as_text()
    study(tmp_path, STUDY)
    found = vd.optimise(path, save_to=tmp_path / out, resume=True)
    whole = vd.optimise(path)
    assert found.report.n_known >= 3
    assert {path.name for path in tmp_path.iterdir()} == {"run.yaml", "study.yaml", out}
    for name in ("point", "objective", "figure_slope"):
        assert found[name].values.tobytes() == whole[name].values.tobytes()


def test_the_system_found_is_written_as_a_file(tmp_path):
    """It has the parameters found, and runs as the best run did, though its search was stopped."""
    path = study(tmp_path, STUDY.replace("constraints:", "most_runs: 3\nconstraints:"))
    with pytest.warns(vd.UnfinishedWarning, match="stopped after 3 runs"):
        found = vd.optimise(path, system_file=tmp_path / "best.yaml")
    assert found.status == "stopped"
    assert code_of_result(found) == NEGATIVE
    assert "allow it more runs" in found.report.as_text()
    motion = vd.simulate(tmp_path / "run.yaml", set={"model": str(tmp_path / "best.yaml")})
    force, time = motion["strut.force"].values, motion["time"].values
    assert np.sqrt(np.trapezoid(force**2, time) / time[-1]) == pytest.approx(
        found["figure_best"].values[0], rel=1e-3
    )
    with pytest.raises(InputError, match="exists"):
        vd.optimise(path, system_file=tmp_path / "best.yaml")


@pytest.mark.long
def test_what_a_system_file_cannot_hold_is_refused_before_the_search(tmp_path):
    """Such as the friction of the tyre of one wheel, which files give all wheels."""
    path = tmp_path / "study.yaml"
    path.write_text(
        "scenarios: run.yaml\nvariables: {front_left.tyre.friction: {from: 0.5, to: 1}}\n"
        "minimise: max(chassis.roll)\n",
        encoding="utf-8",
    )
    car = "model: small_car\nmanoeuvre: {kind: straight}\nspeed: 9 m/s"
    run = SCENARIO.replace("model: quarter_car", car)
    (tmp_path / "run.yaml").write_text(run, encoding="utf-8")
    with pytest.raises(InputError, match=r"cannot hold 'front_left\.tyre\.friction'"):
        vd.optimise(path, system_file=tmp_path / "best.yaml")


FUNCTIONS = """\
title: Functions of parameters
parameters: {x: 0.9, y: 0.5, share: 0, well: 1}
bodies:
  mass: {joints: [{kind: T1, name: slide}], mass: 1 kg, inertia: [0, 0, 0]}
sensors:
  sum: {kind: expression, value: x + y, unit: "1"}
  product: {kind: expression, value: x * y, unit: "1"}
  gain: {kind: expression, value: x, unit: "1"}
  load: {kind: expression, value: x * (1 + share), unit: "1"}
  wells: {kind: expression, value: "(x**2 - 1)**2 + 0.3 * x", unit: "1"}
  near: {kind: expression, value: "(x - well)**2 + (well - 2)**2", unit: "1"}
"""
TINY = """\
title: Functions
model: functions.yaml
duration: 10 ms
solver: {kind: rk4, step: 10 ms}
output: {interval: 10 ms}
"""


def functions(folder, text):
    """Write a study of functions of parameters; return its path."""
    (folder / "functions.yaml").write_text(FUNCTIONS, encoding="utf-8")
    (folder / "tiny.yaml").write_text(TINY, encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(f"scenarios: tiny.yaml\n{text}", encoding="utf-8")
    return path


def test_least_squares_hit_their_targets(tmp_path):
    """Sum 5 and product 6: the numbers 2 and 3, with a residual that vanishes."""
    found = vd.optimise(
        functions(
            tmp_path,
            "variables: {x: {from: 0, to: 2.4}, y: {from: 0, to: 9}}\n"
            "least_squares:\n"
            "  final(sum): {target: 5, size: 0.1}\n"
            "  final(product): {target: 6, size: 0.5}\n",
        )
    )
    assert found["variable_best"].values == pytest.approx([2.0, 3.0], abs=1e-6)
    assert found.attributes["optimality"] < 1e-6
    assert found.attributes["runs"] < 15


@pytest.mark.parametrize("optimiser", ["slsqp", pytest.param("ipopt", marks=pytest.mark.long)])
def test_robust_optima_keep_their_limits_by_deviations(tmp_path, optimiser):
    """x (1 + share) <= 4 with two deviations of 10 %: x = 4 / 1.2; with one of x: 4 - 2 / 4."""
    text = (
        "variables: {x: {from: 0, to: 9}}\nminimise: {final(gain): -1}\ndeviations: 2\n"
        f"constraints: {{final(load): {{at_most: 4}}}}\noptimiser: {optimiser}\n"
    )
    share = "scatter: {share: {kind: normal, mean: 0, deviation: 0.1}}\n"
    found = vd.optimise(functions(tmp_path, text + share))
    assert found["variable_best"].values == pytest.approx([4.0 / 1.2], rel=1e-6)
    assert found.report.as_dict()["active"] == ["final(load)"]
    assert any(note.startswith("deviation of final(load): 0.09 -> 0.333") for note in found.notes)
    own = text.replace("final(gain): -1", "final(sum): -1")
    own += "scatter: {x: {kind: normal, mean: 1, deviation: 0.25}}\n"
    found = vd.optimise(functions(tmp_path, own))
    assert found["variable_best"].values == pytest.approx([3.5], rel=1e-6)


@pytest.mark.long
def test_bounds_are_explored_before_the_search(tmp_path):
    """From x = 0.9 the search alone ends in the well at 0.96; the deeper one is at -1.04."""
    text = "variables: {x: {from: -3, to: 3}}\nminimise: final(wells)\n"
    near = vd.optimise(functions(tmp_path, text))
    best = vd.optimise(functions(tmp_path, text + "explore: 40\n"))
    wells = np.sort(np.roots([4.0, 0.0, -4.0, 0.3]).real)
    assert near["variable_best"].values == pytest.approx([wells[2]], abs=1e-4)
    assert best["variable_best"].values == pytest.approx([wells[0]], abs=1e-4)
    assert any("explored the bounds in 40 runs" in note for note in best.notes)


@pytest.mark.long
def test_the_best_of_discrete_choices_is_found(tmp_path):
    """Each is optimised by itself; the report lists them all."""
    text = "variables: {x: {from: -5, to: 5}}\nminimise: final(near)\n"
    text += "choices: {parameters.well: [1, 2, 4]}\n"
    path = functions(tmp_path, text)
    found = vd.optimise(path, save_to=tmp_path / "out.h5")
    assert found["variable_best"].values == pytest.approx([2.0], abs=1e-5)
    assert "best choice: parameters.well = 2" in found.notes
    assert sum("objective" in note for note in found.notes) == 3


RIG = """\
title: No bump steer
scenarios: run.yaml
variables:
  track_rod.inner.z: {from: 200 mm, to: 340 mm}
  upper.front.z: {from: 420 mm, to: 540 mm}
least_squares:
  "rig(wheel.toe_gain, parallel)": {target: 0 rad/m, size: 1 deg/m}
  "rig(wheel.camber_gain, parallel, 20 mm)": {target: -0.2 rad/m, size: 1 deg/m}
"""


@pytest.mark.long
def test_hardpoints_follow_targets_on_the_rig(tmp_path):
    """Figures of other analyses than the run are those of the rig at the point found."""
    path = study(tmp_path, RIG)
    (tmp_path / "run.yaml").write_text(
        SCENARIO.replace("quarter_car", "double_wishbone_suspension"), encoding="utf-8"
    )
    found = vd.optimise(path)
    assert found["figure_best"].values == pytest.approx([0.0, -0.2], abs=1e-6)
    names = found["variable"].values
    best = dict(zip(names, (f"{float(v)!r} m" for v in found["variable_best"].values), strict=True))
    rig = vd.rig("double_wishbone_suspension", "parallel", "0 mm:20 mm:1", set=best)
    assert rig["wheel.toe_gain"].values[0] == pytest.approx(0.0, abs=1e-6)
    assert rig["wheel.camber_gain"].values[1] == pytest.approx(-0.2, abs=1e-6)


@pytest.mark.parametrize(
    ("figure", "match"),
    [
        ("rig(wheel.*, parallel)", "stands for several figures"),
        ("rig(wheel.toe_gian, parallel)", r"did you mean 'wheel\.toe_gain'"),
        ("steady(yaw_rate, constant_speed, 1 m/s^2)", "is no road vehicle"),
    ],
)
def test_figures_of_analyses_are_checked(tmp_path, figure, match):
    path = study(tmp_path, RIG.replace("rig(wheel.toe_gain, parallel)", figure))
    (tmp_path / "run.yaml").write_text(
        SCENARIO.replace("quarter_car", "double_wishbone_suspension"), encoding="utf-8"
    )
    with pytest.raises(InputError, match=match):
        vd.optimise(path)


@pytest.mark.long
@pytest.mark.parametrize("verb", ["validate", "optimise"])
def test_mistakes_in_figures_of_all_analyses_are_told_at_once(tmp_path, verb):
    """In their lines, by the check of a study and by its start."""
    text = RIG.replace("rig(wheel.toe_gain, parallel)", "rig(wheel.toe_gian, parallel)")
    study(tmp_path, text + "  rms(wheel.q): {target: 1 m, size: 1 m}\n")
    (tmp_path / "run.yaml").write_text(
        SCENARIO.replace("quarter_car", "double_wishbone_suspension"), encoding="utf-8"
    )
    done = call(["vehicledyn", verb, "study.yaml"], tmp_path)
    assert done.returncode == 2
    for words in ("did you mean 'wheel.toe_gain'", "'rms(wheel.q)' is neither", "2 problems"):
        assert words in done.stderr
    assert len(re.findall(r"^study\.yaml:\d+:\d+: ", done.stderr, re.MULTILINE)) == 2


@pytest.mark.long
def test_of_names_that_overlap_the_pattern_is_blamed(tmp_path):
    """Not the name before it, which stands for one figure; variables are checked all the same."""
    text = RIG.replace("rig(wheel.camber_gain, parallel, 20 mm)", "rig(wheel.toe*, parallel)")
    path = study(tmp_path, text.replace("upper.front.z", "upper.*.z"))
    (tmp_path / "run.yaml").write_text(
        SCENARIO.replace("quarter_car", "double_wishbone_suspension"), encoding="utf-8"
    )
    with pytest.raises(InputError) as refused:
        vd.optimise(path)
    variable, figure, count = str(refused.value).splitlines()
    assert f"{path}:5:3: variables.upper.*.z" in variable and "no parameter" in variable
    assert f"{path}:8:3: least_squares.rig(wheel.toe*, parallel)" in figure
    assert count.startswith("2 problems")


@pytest.mark.parametrize(("optimality", "told"), [(1e-3, False), (0.11, True)])
def test_an_end_with_a_gradient_left_is_told(optimality, told):
    """Such as where a figure jumps."""
    from types import SimpleNamespace

    from vehicledyn.studies.optimisation.run import convergence_notes

    found = SimpleNamespace(is_feasible=True, message="converged", optimality=optimality)
    assert [
        "11% of the gradient is left" in note
        for note in convergence_notes(found, was_stopped=False)
    ] == ([True] if told else [])
    assert not convergence_notes(found, was_stopped=True)
