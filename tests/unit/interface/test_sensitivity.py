"""Derivatives of runs by parameters, from Python."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError

pytestmark = pytest.mark.usefixtures("needs_compiler")

SETTINGS = {"duration": "0.5 s"}
OF = ["max(lower.angle)", "upper.angle"]


@pytest.fixture(scope="module")
def found():
    """Derivatives of a double pendulum by all parameters and a start value."""
    to = ["parameters.*", "start.upper.angle"]
    return vd.sensitivity("double_pendulum", OF, to, **SETTINGS)


def test_derivatives_are_labelled(found):
    """Figures over parameters, curves over time as well."""
    assert found.kind == "sensitivity"
    slopes = found["figure_slope"]
    assert slopes.dims == ("figure", "parameter")
    assert found["channel_slope"].dims == ("channel", "time", "parameter")
    figures = list(found["figure"].values)
    assert figures[0] == "max(lower.angle)"
    names = list(found["parameter"].values)
    assert names[-1] == "start.upper.angle"
    run = vd.simulate("double_pendulum", **SETTINGS)
    assert found["channel_value"].values[0] == pytest.approx(run["upper.angle"].values, abs=1e-6)
    report = found.report.as_text()
    assert "length" in report
    assert "no effect" in report


def test_derivatives_agree_with_runs(found):
    """By the length, against Richardson's differences of the same steps."""

    def curve(length):
        changed = {"parameters.length": f"{length!r} m"}
        data = vd.sensitivity("double_pendulum", OF, "mass", set=changed, **SETTINGS)
        return data["channel_value"].values[0]

    names = list(found["parameter"].values)
    wide, near = ((curve(1.0 + h) - curve(1.0 - h)) / (2.0 * h) for h in (2e-3, 1e-3))
    slopes = found["channel_slope"].values[0][:, names.index("length")]
    assert slopes == pytest.approx((4.0 * near - wide) / 3.0, abs=1e-9)


@pytest.mark.parametrize(
    ("of", "to", "match"),
    [
        ("max(lower.angel)", "parameters.*", r"did you mean 'lower\.angle'"),
        ("upper.angle", "parameters.lenght", "did you mean 'length'"),
        ("upper.angle", "start.upper.angel", r"did you mean 'upper\.angle'"),
        ("upper.angle.larges", "parameters.*", r"did you mean 'upper\.angle\.largest'"),
        ("nosuch", "parameters.*", "'nosuch' is neither a key figure nor a channel"),
    ],
)
def test_unknown_names_are_refused(of, to, match, monkeypatch):
    """The nearest name is suggested, before a compiler is missed."""
    monkeypatch.setenv("VEHICLEDYN_CC", "none")
    with pytest.raises(InputError, match=match):
        vd.sensitivity("double_pendulum", of, to, **SETTINGS)


def test_a_figure_of_samples_that_tie_has_no_derivative():
    """The largest height of a periodic motion that is reached twice is a corner."""
    from vehicledyn.analyse.gradients.key_figures import figure_slope, sampled_slopes

    time = np.linspace(0.0, 1.0, 5)
    values, slopes = (
        np.array([0.0, 1.0, 0.0, 1.0, 0.0]),
        np.array([[0.0], [1.0], [0.0], [2.0], [0.0]]),
    )
    assert "as extreme" in figure_slope("max", time, values, slopes).trouble
    corner = sampled_slopes(
        lambda y: {"size": float(np.abs(y).max())}, values[:, None], slopes[:, None]
    )
    assert corner["size"].trouble
    smooth = sampled_slopes(
        lambda y: {"sum": float((y**3).sum())}, values[:, None], slopes[:, None]
    )
    assert smooth["sum"].slope == pytest.approx([3.0 + 6.0], rel=1e-12)
    far = {"ratio": lambda y: float(y.max() / y.min()), "one": lambda y: float(y[3, 0])}
    raised = sampled_slopes(lambda y: {n: f(y) for n, f in far.items()}, *_raised(values, slopes))
    assert raised["one"].slope == pytest.approx([2e-3], rel=1e-9)
    assert raised["ratio"].slope == pytest.approx([1e-3 / 100.0], rel=1e-9)


def _raised(values, slopes):
    """Return samples far above zero that move little; the second is the largest."""
    return 100.0 + values[:, None] + 0.1 * (np.arange(5) == 1)[:, None], 1e-3 * slopes[:, None]


def test_a_derivative_that_is_not_finite_is_no_derivative():
    """Such as that of a root at zero."""
    from vehicledyn.analyse.gradients.key_figures import KINDS, figure_slope, sampled_slopes

    time, values = np.linspace(0.0, 1.0, 3), np.array([0.0, 1.0, 2.0])
    slopes = np.array([[np.inf], [1.0], [np.nan]])
    for kind in KINDS:
        assert figure_slope(kind, time, values[::-1], slopes).trouble, kind
    assert "finite at 0 s" in figure_slope("mean", time, values, slopes).trouble
    lost = sampled_slopes(lambda y: {"sum": float(y.sum())}, values[:, None], slopes[:, None])
    assert "finite" in lost["sum"].trouble


@pytest.mark.long
def test_jumps_that_are_no_events_move_with_the_parameters():
    """The pin of a Geneva drive enters and leaves its slot: the acceleration jumps."""
    settings = {"duration": "1 s", "solver": {"kind": "rk4", "step": "1 ms"}}
    found = vd.sensitivity("geneva_drive", "driver.angle_rate", "motor.*", **settings)
    assert not any("warning" in note for note in found.notes)
    assert any("corners of laws" in note for note in found.notes)
    before = settings | {"duration": "0.05 s"}
    smooth = vd.sensitivity("geneva_drive", "driver.angle_rate", "motor.*", **before)
    assert not any("divided" in note for note in smooth.notes)


RATTLING = """\
title: A block comes to rest by dry friction
gravity: [0, 0, 0]
parameters: {stiffness: 100 N/m, friction: 5 N}
bodies: {block: {joints: [T1 x], mass: 1 kg}}
forces:
  f: {coordinate: block.x, force: "-stiffness*position - friction*where(rate > 0 m/s, 1, -1)"}
initial: {block.x_rate: 1 m/s}
"""


def test_jumps_that_rattle_are_reported(tmp_path):
    """A force that holds the block changes its sign in every step."""
    path = tmp_path / "rattling.yaml"
    path.write_text(RATTLING, encoding="utf-8")
    settings = {"duration": "1 s", "solver": {"kind": "rk4", "step": "1 ms"}}
    with pytest.warns(vd.AccuracyWarning, match="do not confirm"):
        vd.sensitivity(path, "block.x", **settings)


def test_steps_that_stand_for_another_method_are_judged():
    """Those that suit the start are halved until the motion no longer moves."""
    found = vd.sensitivity("double_pendulum", "upper.angle", "length", **SETTINGS)
    run = vd.simulate("double_pendulum", **SETTINGS)
    error = np.abs(found["channel_value"].values[0] - run["upper.angle"].values).max()
    assert error < 1e-5 * np.ptp(run["upper.angle"].values)
    (note,) = [item for item in found.notes if "derivatives are those of rk4 steps" in item]
    assert "warning" not in note


def test_rounding_of_constraints_is_no_error_of_the_steps():
    """The gap of the cam's drive is some 1e-25 m, which halved steps do not keep."""
    found = vd.sensitivity(
        "cam_follower", "final(follower.height)", "restitution", duration="0.1 s"
    )
    assert not any("warning" in note for note in found.notes)


def critical(mass, inertia, gauge, radius, conicity, lateral, yaw, creep):
    """Return critical speed and frequency of the single wheelset, by Routh's condition."""
    square = (yaw + gauge**2 * lateral) / (inertia + gauge**2 * mass)
    springs = (lateral - mass * square) * (yaw - inertia * square)
    speed = 2.0 * creep * gauge * np.sqrt(square)
    speed = speed / np.sqrt(springs + 4.0 * creep**2 * gauge * conicity / radius)
    return np.array([speed, np.sqrt(square) / (2.0 * np.pi)])


def test_the_critical_speed_has_the_gradient_of_its_closed_form():
    """A wheelset on springs, by all its parameters."""
    found = vd.sensitivity("simple_wheelset", "critical_speed", "*", speed="40 m/s")
    names = ["mass", "yaw_inertia", "half_gauge", "radius", "conicity", "lateral_stiffness"]
    names += ["yaw_stiffness", "creep_coefficient"]
    known = list(found["parameter"].values)
    places = [known.index(name) for name in names]
    values = found["parameter_value"].values[places].astype(float)
    assert found["figure_value"].values == pytest.approx(critical(*values), rel=1e-10)
    columns = []
    for k in range(len(values)):
        moved = values.astype(complex)
        moved[k] += 1e-25j
        columns.append(np.imag(critical(*moved)) / 1e-25)
    error = found["figure_slope"].values[:, places] - np.array(columns).T
    parts = error * values[None, :] / critical(*values)[:, None]
    assert parts == pytest.approx(0.0, abs=1e-10)
    assert not found["figure_slope"].values[:, known.index("clearance")].any()


def test_eigenvalues_and_equilibrium_follow_parameters():
    """Two masses on springs, against differences."""

    def figures(stiffness):
        changed = {"parameters.upper.stiffness": f"{stiffness!r} N/m"}
        of = ["eigenvalues", "equilibrium.*"]
        return vd.sensitivity("double_spring_mass", of, "upper.stiffness", set=changed)

    at = 18_000.0
    found = figures(at)
    near, wide = (
        (figures(at + h)["figure_value"].values - figures(at - h)["figure_value"].values) / (2 * h)
        for h in (100.0, 200.0)
    )
    slopes = found["figure_slope"].values[:, 0]
    scale = np.abs(found["figure_value"].values) / at + 1e-12
    assert np.abs(slopes - (4.0 * near - wide) / 3.0) / scale == pytest.approx(0.0, abs=1e-6)


def test_linear_names_are_checked():
    """Kinds are not mixed, and names and speeds must mean something."""
    with pytest.raises(InputError, match="one after the other"):
        vd.sensitivity("double_pendulum", ["eigenvalues", "upper.angle"])
    with pytest.raises(InputError, match="no parameter 'speed'"):
        vd.sensitivity("double_pendulum", "critical_speed")
    with pytest.raises(InputError, match=r"did you mean 'upper\.angle'"):
        vd.sensitivity("double_pendulum", "equilibrium.upper.angel")
    with pytest.raises(InputError, match="linearised"):
        vd.sensitivity("double_pendulum", "upper.angle", speed="3 m/s")


DRIVEN = """\
title: A slide that is driven to a sum
parameters: {a: {value: 0.3}, b: {value: 0.4}}
bodies:
  slide: {joints: [{kind: T1, name: x}], mass: 1 kg}
drives:
  push: {coordinate: slide.x, law: {kind: expression, position: (2 * a - 3 * b**2 + 1) * 1 m}}
"""


def test_a_motion_without_states_has_derivatives(tmp_path):
    """Where all is driven nothing is integrated, and there are no modes."""
    path = tmp_path / "driven.yaml"
    path.write_text(DRIVEN, encoding="utf-8")
    run = {"solver": {"kind": "rk4", "step": "1 ms"}, "output": {"interval": "1 ms"}}
    run["duration"] = "2 ms"
    found = vd.sensitivity(path, ["slide.x", "final(slide.x)"], **run)
    assert found["figure_slope"].values[0] == pytest.approx([2.0, -2.4], rel=1e-14)
    assert found["channel_slope"].values[0] == pytest.approx(np.full((3, 2), [2.0, -2.4]))
    bent = vd.sensitivity(path, "final(slide.x)", along={"b": 1.0}, **run)
    assert bent["figure_curvature"].values[0] == pytest.approx([0.0, -6.0])
    with pytest.raises(InputError, match="no modes but zeros"):
        vd.sensitivity(path, "eigenvalues")


DROP = """\
title: A ball falls to the ground, where the run ends
parameters: {height: {value: 1 m}}
bodies: {ball: {joints: [T3 z], mass: 1 kg}}
events: {ground: {when: ball.z, direction: falling, terminal: true}}
initial: {ball.z: height}
"""


def test_figures_know_that_an_event_ends_the_run_at_another_time(tmp_path):
    """A ball that falls from h for T = (2 h / g)^(1/2): the rate has mean -h / T, integral -h."""
    path = tmp_path / "drop.yaml"
    path.write_text(DROP, encoding="utf-8")
    run = {"solver": {"kind": "rk4", "step": "1 ms"}, "output": {"interval": "10 ms"}}
    of = ["integral(ball.z_rate)", "mean(ball.z_rate)", "rms(ball.z_rate)", "mean_square(ball.z)"]
    slopes, values = [], []
    for height in (1.0, 1.0 + 1e-4, 1.0 - 1e-4):
        with pytest.warns(vd.AccuracyWarning, match="ended the run"):
            found = vd.sensitivity(path, of, height=f"{height!r} m", **run)
        slopes.append(found["figure_slope"].values[:, 0])
        values.append(found["figure_value"].values)
    assert slopes[0][:2] == pytest.approx([-1.0, -0.5 * (9.81 / 2.0) ** 0.5], rel=1e-9)
    assert slopes[0] == pytest.approx((values[1] - values[2]) / 2e-4, rel=1e-7)
