"""The verb hunt: what it refuses, what it keeps, and branches found from simulations."""

import contextlib
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyse.settling import simulated_cycles as settled
from vehicledyn.analyses.hunting import study as hunt_study
from vehicledyn.analyses.hunting.hunt import find_limit_cycles
from vehicledyn.analyses.hunting.start import HuntSettings
from vehicledyn.analyses.preparation.sources import laws_that_bend
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.files.scenario import load_model
from vehicledyn.results.labelled.requested import save_standard
from vehicledyn.results.tables.hunt_table import read_hunt

pytestmark = pytest.mark.long

WHEELSET = Path(__file__).parents[3] / "systems" / "simple_wheelset.yaml"
ISOLATED = """\
title: A balance wheel, stable at rest, that swings on once it is pushed
parameters: {push: 0.1 N*m*s/rad^3, loss: 0.04 N*m*s/rad, limit: 0.02 N*m*s/rad^5}
gravity: [0, 0, 0]
bodies:
  wheel: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
forces:
  spring: {coordinate: wheel.angle, force: -1 N*m/rad * position}
  air: {coordinate: wheel.angle, force: "-(loss - push * position**2 + limit * position**4) * rate"}
"""


def study(settings, target=None, tmp_path=None, **more):
    output = None if tmp_path is None else tmp_path / "hunt.h5"
    return find_limit_cycles(
        target or load_model(str(WHEELSET)), settings, backend="auto", output=output,
        progress=lambda *_: None, **more,
    )  # fmt: skip


class BranchEndError(Exception):
    """Ends a branch in a test."""


@cache
def up_to_65():
    return study(HuntSettings("speed", 50.0, 65.0, points=15, simulate=False))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (HuntSettings("sped", "20 m/s", "30 m/s"), "did you mean 'speed'"),
        (HuntSettings("speed", "20 kg", "30 m/s"), "first='20 kg'"),
        (HuntSettings("speed", "30 m/s", "20 m/s"), "must be below the last; exchange them"),
        (HuntSettings("speed", "30 m/s", "108 km/h"), "they are equal: 'eig' looks at a single"),
        (HuntSettings("speed", "0 m/s", "20 m/s"), "first='0 m/s': a speed of zero.* begin above"),
        (HuntSettings("speed", "-5 m/s", "20 m/s"), "first='-5 m/s': a speed of zero or below"),
        (HuntSettings("speed", 20.0, float("inf")), "must be finite"),
        (HuntSettings("speed", 20.0, 30.0, points=1), "points must be"),
        (HuntSettings("speed", 20.0, 30.0, amplitude=0.0), "amplitude and"),
        (HuntSettings("speed", 20.0, 30.0, channels=("wheelset.yow",)), "wheelset.yaw"),
        (HuntSettings("speed", 20.0, 30.0, simulated="5 m"), "simulated='5 m'"),
        (HuntSettings("speed", 20.0, 30.0, simulated="0 s"), "simulated='0 s': must be above zero"),
    ],
)
def test_what_is_refused(settings, message):
    with pytest.raises(InputError, match=message):
        study(settings)


def test_a_range_without_oscillation(tmp_path):
    report = study(HuntSettings("speed", 20.0, 40.0, points=10), tmp_path=tmp_path)
    assert report.status == "ok" and not report.table.cycles
    assert "no oscillation begins to grow" in report.as_text()
    assert read_hunt(tmp_path / "hunt.h5").eigenvalues.real.max() < 0.0


def test_a_range_that_begins_above_the_critical_speed():
    """The motion grew at all speeds of the range, and nothing said so."""
    above = study(HuntSettings("speed", 62.5, 63.0, points=8, simulate=False))
    found = above.table.figures["linear_critical"]
    assert found == pytest.approx(61.1294, abs=1e-4)
    assert "grows at speed = 62.5 m/s already" in above.messages[0]
    assert "begin to grow at 61.13 m/s, below the range" in above.messages[0]
    assert above.table.cycles
    assert above.table.locus_values[-1] == 63.0


def test_a_range_far_above_the_critical_speed():
    report = study(HuntSettings("speed", 130.0, 132.0, points=4, simulate=False))
    assert "the linear critical value is lower" in report.messages[0]
    assert "oscillations grow at all values of this range" in report.as_text()
    assert report.table.channels[0].name == "wheelset.lateral"


@pytest.mark.parametrize(
    ("error", "status"), [(KeyboardInterrupt, "interrupted"), (BranchEndError, "partial")]
)
def test_what_was_found_is_kept(tmp_path, monkeypatch, error, status):
    """Ctrl-C on the way, or a branch that is lost, leaves the cycles before in the file."""
    follow = hunt_study.follow_cycles

    def cut(model, start, direction, limits, *, branch, report, upwards):
        def stop(point):
            if len(branch.points) == 6:
                raise error

        with contextlib.suppress(BranchEndError):
            follow(model, start, direction, limits, branch=branch, report=stop, upwards=upwards)
        branch.ending, branch.reason = "lost", "lost near speed = 61: it does not converge"
        return branch

    monkeypatch.setattr(hunt_study, "follow_cycles", cut)
    settings = HuntSettings("speed", 50.0, 70.0, points=8, simulate=False)
    report = study(settings, tmp_path=tmp_path)
    assert report.status == status
    save_standard({"": tmp_path / "hunt.h5"}, tmp_path / "plots")
    kept = read_hunt(tmp_path / "hunt.h5")
    assert kept.status == status and len(kept.cycles) == 6
    assert "kept" in kept.message or "lost near speed" in kept.message
    assert (tmp_path / "plots" / "bifurcation.png").is_file()


def test_ranges_of_channels_are_those_of_the_motion():
    report = up_to_65()
    row = report.table.cycles[-1]
    motion = np.asarray(row.motion)
    assert row.greatest == pytest.approx(motion.max(axis=0), rel=5e-3)
    assert row.smallest == pytest.approx(-row.greatest, rel=1e-6)  # left and right are alike
    assert report.as_dict()["cycles"][-1]["amplitude"] == pytest.approx(row.amplitude)


def test_no_equilibrium_is_told(tmp_path):
    text = WHEELSET.read_text(encoding="utf-8").replace(
        "springs:\n", "springs:\n  none: {coordinate: wheelset.yaw, law: {kind: spring_damper}}\n"
    )
    text = text.replace("forces:\n", "forces:\n  wind: {coordinate: wheelset.yaw, force: 9e9 N}\n")
    path = tmp_path / "blown.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises((NumericalError, InputError)):
        study(HuntSettings("speed", 20.0, 40.0, points=5), load_model(str(path)))


def test_a_cycle_apart_from_the_equilibrium_is_found_by_simulation(tmp_path):
    """By averaging the swing of 2 rad is lost where push² = 8 loss limit, at 0.08."""
    path = tmp_path / "balance.yaml"
    path.write_text(ISOLATED, encoding="utf-8")
    settings = HuntSettings("push", 0.05, 0.12, points=20, disturbance=2.0)
    report = study(settings, load_model(str(path)))
    figures = report.table.figures
    assert "linear_critical" not in figures
    assert figures["nonlinear_critical"] == pytest.approx(0.08, rel=1e-2)
    assert figures["simulated_lowering"] == pytest.approx(figures["nonlinear_critical"], rel=5e-3)
    (fold,) = (row for row in report.table.cycles if row.kind == "fold")
    assert fold.amplitude[0] == pytest.approx(2.0, rel=2e-2)
    assert figures["largest_difference_amplitude"] < 0.005


APART = """\
title: A balance wheel whose small swings and large ones are joined beyond the range only
parameters: {push: 0.01 N*m*s/rad, scale: 1 rad}
gravity: [0, 0, 0]
bodies:
  wheel: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
forces:
  spring: {coordinate: wheel.angle, force: -1 N*m/rad * position}
  air:
    coordinate: wheel.angle
    force: "(push - 0.1 N*m*s/rad * (2.4 * (position / scale)**2 - 9.2 * (position / scale)**4
      + 64 / 15 * (position / scale)**6)) * rate"
"""


def test_a_simulated_cycle_on_no_branch_begins_one(tmp_path):
    """Averaged, 10 push = A³/3 - 2.1 A² + 3.2 A with A = amplitude²: folds at A = 1 and 3.2.

    The branch from the Hopf bifurcation at 0 folds at 0.143, farther off than it is followed.
    """
    path = tmp_path / "balance.yaml"
    path.write_text(APART.replace("2.4", "12.8").replace("9.2", "16.8"), encoding="utf-8")
    settings = HuntSettings("push", -0.04, 0.005, points=20, disturbance=2.0)
    report = study(settings, load_model(str(path)))
    figures, rows = report.table.figures, report.table.cycles
    assert report.status == "ok"
    assert figures["linear_critical"] == pytest.approx(0.0, abs=1e-9)
    assert {row.branch for row in rows} == {1, 2}
    assert max(row.amplitude[0] ** 2 for row in rows if row.branch == 1) < 0.3
    (fold,) = (row for row in rows if row.kind == "fold")
    assert fold.branch == 2 and fold.amplitude[0] ** 2 == pytest.approx(3.2, rel=0.03)
    assert fold.value == pytest.approx(-0.0341, rel=0.02)
    assert figures["nonlinear_critical"] == pytest.approx(fold.value, abs=1e-6)
    assert figures["simulated_lowering"] == pytest.approx(fold.value, rel=5e-3)
    assert figures["largest_difference_amplitude"] < 0.005
    assert "not found to be joined" in " ".join(report.messages)
    assert "lie on no branch" not in " ".join(report.messages)
    at_the_top = [row.amplitude**2 for row in report.table.simulated if row.value == 0.005]
    assert len(at_the_top) == 2, "the small stable cycle is simulated, too"
    assert min(at_the_top) < 0.3 and max(at_the_top) > 3.2


@pytest.mark.parametrize(
    ("first", "last", "lowest", "means"),
    [
        (-0.08, 0.03, -0.0733, "fold of branch 1"),
        (-0.05, 0.006, -0.05, "branch 1 reaches the lower end of the range with stable cycles"),
    ],
)
def test_a_branch_that_leaves_the_range_is_followed_outside(tmp_path, first, last, lowest, means):
    """Both folds, at 0.00855 and -0.0733, lie outside the narrow range."""
    path = tmp_path / "balance.yaml"
    path.write_text(APART, encoding="utf-8")
    settings = HuntSettings("push", first, last, points=20, simulate=False)
    report = study(settings, load_model(str(path)), tmp_path=tmp_path)
    table = read_hunt(tmp_path / "hunt.h5")
    folds = [row.value for row in table.cycles if row.kind == "fold"]
    assert sorted(folds) == pytest.approx([-0.0733, 0.00855], abs=5e-4)
    assert table.figures["nonlinear_critical"] == pytest.approx(lowest, abs=5e-4)
    assert table.means["nonlinear_critical"] == means and means in report.as_text()
    assert table.cycles[-1].value == last and table.cycles[-1].stable
    told = "; ".join(report.messages)
    for edge in (first, last):
        words = f"leaves the range at push = {edge:g} and comes back into it at {edge:g}"
        assert (words in told) is (first == -0.05)


def test_what_does_not_come_back_is_left_out():
    report = up_to_65()
    assert report.status == "ok" and "has not come back up to" in "; ".join(report.messages)
    assert all(50.0 <= row.value <= 65.0 for row in report.table.cycles)


TWO_FREQUENCIES = """\
title: A balance wheel, and on it a small one that swings by itself
parameters: {push: 0.01 N*m*s/rad, scale: 1 rad}
gravity: [0, 0, 0]
bodies:
  wheel: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
  small: {parent: wheel, joints: [R3 angle], mass: 1 kg, inertia: [0.1 kg*m^2, 0.1 kg*m^2,
        0.1 kg*m^2]}
forces:
  spring: {coordinate: wheel.angle, force: -1 N*m/rad * position}
  air: {coordinate: wheel.angle, force: "(push - 0.1 N*m*s/rad * (position / scale)**2) * rate"}
  hair: {coordinate: small.angle, force: -0.5 N*m/rad * position}
  clock:
    coordinate: small.angle
    force: "(0.01 N*m*s/rad - 0.1 N*m*s/rad * (position / scale)**2) * rate"
"""


def test_a_motion_of_two_frequencies_is_told_and_does_not_take_for_ever(tmp_path, monkeypatch):
    path = tmp_path / "two.yaml"
    path.write_text(TWO_FREQUENCIES, encoding="utf-8")
    windows = []
    followed = settled.Runner.window

    def counted(runner, *args, **more):
        windows.append(1)
        return followed(runner, *args, **more)

    monkeypatch.setattr(settled.Runner, "window", counted)
    monkeypatch.setattr(hunt_study.FromSimulations, "examine", lambda *_: None)
    settings = HuntSettings("push", 0.04, 0.06, points=5, disturbance=0.5, levels=3)
    report = study(settings, load_model(str(path)))
    (told,) = (message for message in report.messages if "do not repeat" in message)
    assert told.startswith("motions simulated at push = 0.06, 0.05, 0.04 last but do not repeat: ")
    assert len(windows) < 80  # of 240


def test_simulations_end_with_the_motion_that_is_allowed(tmp_path):
    """What is left is told, and what was simulated is kept."""
    settings = HuntSettings("speed", 50.0, 75.0, points=10, simulated="12 s")
    report = study(settings, tmp_path=tmp_path)
    (told,) = (m for m in report.messages if m.startswith("the check by lowering speed"))
    assert "as many as are allowed; simulated allows more" in told
    kept = read_hunt(tmp_path / "hunt.h5")
    assert "cut short" in [row.ending for row in kept.simulated]
    assert "simulated_lowering" not in kept.figures
    assert sum(row.seconds for row in kept.simulated) < 15.0  # one window more at most


def test_stopped_in_simulations(tmp_path, monkeypatch):
    settle, runs = settled.Runner.settle, []

    def cut(runner, *args):
        runs.append(1)
        if len(runs) == 4:
            raise KeyboardInterrupt
        return settle(runner, *args)

    monkeypatch.setattr(settled.Runner, "settle", cut)
    report = study(HuntSettings("speed", 50.0, 75.0, points=10), tmp_path=tmp_path)
    assert report.status == "interrupted"
    kept = read_hunt(tmp_path / "hunt.h5")
    assert [row.value for row in kept.simulated] == pytest.approx([75.0, 72.9167, 70.8333])
    assert {row.ending for row in kept.simulated} == {"settled"} and kept.cycles


def test_the_fold_is_looked_at_from_both_sides():
    """Simulated lowering lives above the fold and dies below, within 2e-4 of the range."""
    report = study(HuntSettings("speed", 50.0, 75.0, points=20, levels=6))
    figures = report.table.figures
    above = figures["simulated_lowering"] - figures["nonlinear_critical"]
    assert 0.0 < above < 2e-4 * 25.0
    assert figures["largest_difference_amplitude"] < 1e-3
    assert len(report.table.simulated) < 12


def test_angles_of_wheels_that_roll_are_no_channels():
    target = load_model(str(WHEELSET.with_name("testset_wheelset.yaml")))
    settings = HuntSettings("speed", 10.0, 12.0, points=3, simulate=False)
    names = [channel.name for channel in study(settings, target).table.channels]
    assert "wheelset.spin" not in names and "wheelset.lateral" in names
    chosen = HuntSettings("speed", 10.0, 12.0, channels=("wheelset.spin",))
    with pytest.raises(InputError, match=r"channels='wheelset\.spin': .* set apart"):
        study(chosen, target)


def test_a_branch_ends_where_it_comes_to_another(monkeypatch):
    """Simulated cycles that are taken for new ones begin branches that lie on the first."""
    monkeypatch.setattr(hunt_study.Legs, "is_known", lambda *_: False)
    report = study(HuntSettings("speed", 62.0, 75.0, points=10, levels=4))
    told = " ".join(report.messages)
    assert "branch 2 joins branch 1 near speed = " in told
    assert "not found to be joined" not in told
    further = [row for row in report.table.cycles if row.branch > 1]
    assert 0 < len(further) < 9


LEANING = """\
title: A balance wheel that swings more or less, beside which a small one begins to lean
parameters: {push: 0.01 N*m*s/rad, scale: 1 rad, second: 1 s}
gravity: [0, 0, 0]
bodies:
  wheel: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
  small: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
forces:
  spring: {coordinate: wheel.angle, force: -1 N*m/rad * position}
  air: {coordinate: wheel.angle, force: "(push - 0.1 N*m*s/rad * (position / scale)**2) * rate"}
  hair: {coordinate: small.angle, force: -1 N*m*s/rad * rate}
  link:
    coordinate: small.angle
    force: "0.02 N*m/rad * wheel.angle + 0.2 N*m/rad * position * ((wheel.angle / scale)**2
      + (wheel.angle_rate * second / scale)**2 - 1 - (position / scale)**2)"
"""


def test_a_branch_leads_off_where_cycles_cease_to_be_their_own_image(tmp_path):
    """Averaged, the wheel swings with amplitude² = 40 push; above 1 the other one leans.

    It leans by w with w² = 40 push - 1, as its mirror image does to the other side.
    """
    path = tmp_path / "leaning.yaml"
    path.write_text(LEANING, encoding="utf-8")
    settings = HuntSettings(
        "push", -0.01, 0.05, points=20, simulate=False, channels=("small.angle",)
    )
    report = study(settings, load_model(str(path)), tmp_path)
    save_standard({"": tmp_path / "hunt.h5"}, tmp_path / "plots")
    (point,) = (row for row in report.table.cycles if row.kind == "branch_point")
    assert point.branch == 1 and point.value == pytest.approx(0.025, rel=0.02)
    rows = report.table.branch(2)
    assert report.status == "ok" and len(rows) > 5 and all(row.stable for row in rows)
    middles = np.array([0.5 * (row.smallest[0] + row.greatest[0]) for row in rows])
    values = np.array([row.value for row in rows])
    assert len(set(np.sign(middles))) == 1
    assert middles**2 == pytest.approx(40.0 * (values - point.value), rel=0.05, abs=2e-3)
    place = f"branch 1 at push = {point.value:.6g}"
    origin = f"branches off {place}; its mirror image counts as the same branch"
    assert read_hunt(tmp_path / "hunt.h5").origins == {2: origin}
    assert report.as_dict()["origins"] == [{"branch": 2, "origin": origin}]
    assert origin in report.as_text() and f"branch 2 {origin}" in report.messages


def test_branches_that_lead_off_may_be_left_out(tmp_path):
    path = tmp_path / "leaning.yaml"
    path.write_text(LEANING, encoding="utf-8")
    settings = HuntSettings("push", -0.01, 0.05, points=8, simulate=False, secondary=False)
    report = study(settings, load_model(str(path)))
    assert {row.branch for row in report.table.cycles} == {1}


def test_stopped_on_a_branch_that_leads_off(tmp_path, monkeypatch):
    follow = hunt_study.follow_cycles

    def cut(*args, report, **more):
        def stop(point):
            report(point)
            if more["branch"] is not first and len(more["branch"].points) == 3:
                raise KeyboardInterrupt

        first = made[0] if made else more["branch"]
        made.append(more["branch"])
        return follow(*args, report=stop, **more)

    made = []
    monkeypatch.setattr(hunt_study, "follow_cycles", cut)
    path = tmp_path / "leaning.yaml"
    path.write_text(LEANING, encoding="utf-8")
    settings = HuntSettings("push", -0.01, 0.05, points=8, simulate=False, secondary=True)
    report = study(settings, load_model(str(path)), tmp_path)
    kept = read_hunt(tmp_path / "hunt.h5")
    assert report.status == "interrupted" and kept.status == "interrupted"
    assert len(kept.branch(2)) == 3 and len(kept.branch(1)) > 8
    assert list(kept.origins) == [2]


BENDS = """\
title: A balance wheel whose air resists as soon as it swings by more than a millionth
parameters: {push: 0.01 N*m*s/rad, resistance: 0.05 N*m*s/rad, small: 1e-6 rad, scale: 1 rad}
gravity: [0, 0, 0]
bodies:
  wheel: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
forces:
  spring: {coordinate: wheel.angle, force: -1 N*m/rad * position}
  air:
    coordinate: wheel.angle
    force: "(push - resistance * (position**2 / (position**2 + small**2)
      + (position / scale)**2)) * rate"
"""


def test_equations_that_bend_at_rest_are_named(tmp_path):
    """Above the millionth the equilibrium's Hopf bifurcation, at 0, tells nothing of cycles."""
    path = tmp_path / "balance.yaml"
    path.write_text(BENDS, encoding="utf-8")
    settings = HuntSettings("push", -0.02, 0.08, points=10, simulate=False)
    report = study(settings, load_model(str(path)))
    assert report.table.figures["linear_critical"] == pytest.approx(0.0, abs=1e-9)
    assert report.table.cycles[0].value > 0.04
    assert "not linear even in so small a motion" in "; ".join(report.messages)


TWO = """\
title: Two balance wheels, of which the second begins to swing later
parameters: {push: 0.01 N*m*s/rad, delay: 0.02 N*m*s/rad, scale: 1 rad}
gravity: [0, 0, 0]
bodies:
  first: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
  second: {joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
forces:
  spring: {coordinate: first.angle, force: -1 N*m/rad * position}
  hair: {coordinate: second.angle, force: -2 N*m/rad * position}
  air:
    coordinate: first.angle
    force: "(push - 0.1 N*m*s/rad * (position / scale)**2) * rate"
  breath:
    coordinate: second.angle
    force: "(push - delay - 0.1 N*m*s/rad * (position / scale)**2) * rate"
"""


@pytest.mark.parametrize("lost", [None, 0, 1])
def test_each_hopf_bifurcation_has_its_branch(tmp_path, monkeypatch, lost):
    """One whose first cycle is not found is named, and the others are followed all the same."""
    follow, begun = hunt_study.follow_cycles, []

    def begin(*args, **more):
        begun.append(args)
        if len(begun) - 1 == lost:
            raise NumericalError("not found")
        return follow(*args, **more)

    monkeypatch.setattr(hunt_study, "follow_cycles", begin)
    path = tmp_path / "two.yaml"
    path.write_text(TWO, encoding="utf-8")
    settings = HuntSettings("push", -0.01, 0.04, points=5, simulate=False)
    report = study(settings, load_model(str(path)))
    begins = [report.table.branch(number)[0].value for number in report.table.branches]
    wanted = [value for k, value in enumerate((0.0, 0.02)) if k != lost]
    assert begins == pytest.approx(wanted, abs=1e-5)
    assert report.status == ("ok" if lost is None else "partial")
    told = "; ".join(report.messages)
    assert ("no branch of cycles is found from" in told) is (lost is not None)


def test_laws_that_bend_at_rest_are_known():
    systems = WHEELSET.parent
    (law,) = laws_that_bend(load_model(str(systems / "shifted_wheelset.yaml")))
    assert law.startswith("creep 'polach'") and "linear_below" in law
    assert not laws_that_bend(load_model(str(systems / "rail_wheelset.yaml")))


@pytest.mark.parametrize(("first", "last"), [(0.14, 0.18), (0.16, 0.165), (0.128, 0.23)])
def test_large_cycles_do_not_depend_on_the_range(tmp_path, first, last):
    """The Hopf bifurcation, at 0.2, and both folds may lie outside; cycles lead through."""
    path = tmp_path / "balance.yaml"
    path.write_text(APART.replace("(push -", "(push - 0.2 N*m*s/rad -"), encoding="utf-8")
    settings = HuntSettings("push", first, last, points=20, simulate=False)
    report = study(settings, load_model(str(path)))
    figures, told = report.table.figures, "; ".join(report.messages)
    assert figures["linear_critical"] == pytest.approx(0.2, rel=1e-9)
    assert figures["nonlinear_critical"] == pytest.approx(first, rel=1e-9)
    assert "lower end of the range with stable" in report.table.means["nonlinear_critical"]
    assert "below the range it is stable down to 0.126" in told
    assert ("above it they do at 0.2" in told) is (last < 0.2)
