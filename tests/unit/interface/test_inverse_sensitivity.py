"""Derivatives of inverse dynamics by parameters of the model and of the laws of motion."""

from itertools import pairwise

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import AccuracyWarning, InputError, NumericalError, UnfinishedWarning

SCENARIO = "scenarios/systems/slider_crank.yaml"
SPEED = 60.0
NAMES = ["radius", "rod", "coupler.mass", "slider.mass", "gas.stiffness", "gas.free"]


def _torque(time, radius, rod, coupler, slider, stiffness, free):
    """Return the torque of an even turn, half of I'(angle) speed² and V'(angle)."""
    angle = np.radians(40.0) + SPEED * time
    s, c = np.sin(angle), np.cos(angle)
    root = np.sqrt(rod**2 - (radius * s) ** 2)
    place, rate = radius * c + root, -radius * s - radius**2 * s * c / root
    bend = -radius * c - radius**2 * ((c**2 - s**2) / root + (radius * s * c) ** 2 / root**3)
    turn, turn_bend = radius * c / root, -radius * s / root + radius**3 * s * c**2 / root**3
    middle = (rate - radius * s) * (bend - radius * c) / 4.0 - radius**2 * s * c / 4.0
    inertia = slider * rate * bend + coupler * (middle + rod**2 / 12.0 * turn * turn_bend)
    return (
        inertia * SPEED**2 + stiffness * (place - free) * rate - coupler * 9.81 * radius * c / 2.0
    )


def test_a_slider_crank_follows_its_closed_form():
    """Its derivatives by complex steps, at all samples and by all parameters."""
    found = vd.sensitivity(SCENARIO, "inverse(crank.angle_force)", duration="50 ms")
    names, times = list(found["parameter"].values), found["time"].values
    columns = [names.index(name) for name in NAMES]
    values = found["parameter_value"].values[columns]
    torque = _torque(times, *values)
    assert found["channel_value"].values[0] == pytest.approx(torque, rel=1e-9, abs=1e-10)
    for k, column in enumerate(columns):
        step = np.zeros(len(values), dtype=complex)
        step[k] = 1e-40j
        exact = _torque(times, *(values + step)).imag / 1e-40
        size = np.abs(exact).max()
        assert found["channel_slope"].values[0, :, column] == pytest.approx(exact, abs=1e-11 * size)
    others = [k for k in range(len(names)) if k not in columns]
    assert not found["channel_slope"].values[0][:, others].any()


MOTION = {"crank.angle": {"kind": "sine", "amplitude": "rod * 4 rad/m", "frequency": "3 Hz"}}


def _richardson(figure, name, value, unit):
    """Return the derivative of a key figure from separate runs."""

    def at(part):
        given = {"motion": MOTION, name: f"{value * (1.0 + part)!r} {unit}"}
        return figure(vd.inverse(SCENARIO, set=given, duration="0.1 s"))

    slopes = [(at(h) - at(-h)) / (2.0 * h * value) for h in (4e-3, 2e-3, 1e-3)]
    first = [(4.0 * b - a) / 3.0 for a, b in pairwise(slopes)]
    return (16.0 * first[1] - first[0]) / 15.0


@pytest.mark.long
@pytest.mark.parametrize(("name", "unit"), [("rod", "m"), ("coupler.mass", "kg")])
def test_laws_of_motion_follow_their_parameters(name, unit):
    """A swing that the rod's length widens; the largest power and the work follow, too."""
    of = ["inverse(crank.angle_power)", "inverse(crank.angle.power)", "inverse(crank.angle.work)"]
    found = vd.sensitivity(SCENARIO, of, name, set={"motion": MOTION}, duration="0.1 s")
    value = float(found["parameter_value"].values[0])
    names = list(found["figure"].values)

    def figures(run):
        power = run["crank.angle_power"].values
        return np.array([*power, np.abs(power).max(), np.trapezoid(power, run["time"].values)])

    *curve, largest, work = _richardson(figures, name, value, unit)
    slopes = dict(zip(names, found["figure_slope"].values[:, 0], strict=True))
    assert slopes["crank.angle.power"] == pytest.approx(largest, rel=1e-9)
    assert slopes["crank.angle.work"] == pytest.approx(work, rel=1e-9)
    size = np.abs(curve).max()
    assert found["channel_slope"].values[0, :, 0] == pytest.approx(np.array(curve), abs=1e-9 * size)


CORNERED = {"crank.angle": {"kind": "ramp", "last": "1 rad", "duration": "rod * 1 s/m"}}


def test_a_corner_has_no_derivative():
    """The end of a ramp, where the jerk jumps, moves with the parameter it is written with."""
    of = ["inverse(crank.angle_force)", "inverse(integral(crank.angle_force))"]
    given = {"motion": CORNERED, "output.interval": "10 ms"}
    integral = pytest.warns(AccuracyWarning, match="it is not finite at 0.15 s")
    with integral, pytest.warns(AccuracyWarning, match=r"corner at 0\.15 s"):
        found = vd.sensitivity(SCENARIO, of, ["rod", "radius"], set=given, duration="0.2 s")
    lost = np.isnan(found["channel_slope"].values[0])
    assert list(found["time"].values[lost[:, 0]]) == pytest.approx([0.15])
    assert not lost[:, 1].any()
    assert np.isnan(found["figure_slope"].values[-1]).all()


HIGHEST = "radius + rod - 20 mm"
SWING = {"kind": "sine", "amplitude": "20 mm", "frequency": "50 Hz", "offset": HIGHEST}
TURNING_BACK = {"slider.position": SWING}


def test_a_dead_centre_that_is_just_reached_has_no_forces():
    """The slider turns back at 5 ms where nothing says which way the crank goes on."""
    given = {"set": {"motion": TURNING_BACK}, "duration": "6 ms"}
    words = r"singular place of block 'pin' at t = 0\.005 s|did not converge"
    with pytest.warns(UnfinishedWarning, match=words):
        forces = vd.inverse(SCENARIO, **given)
    assert len(forces.time) == 10
    with pytest.raises(NumericalError, match=words):
        vd.sensitivity(SCENARIO, "inverse(slider.position_force)", **given)


@pytest.mark.parametrize(
    ("of", "to", "match"),
    [
        ("inverse(crank.angle_forse)", "*", r"did you mean 'crank\.angle_force'"),
        ("inverse(max(crank.angle_forse))", "*", r"did you mean 'crank\.angle_force'"),
        ("inverse(crank.angle.work)", "start.crank.angle", "no start values"),
        ("inverse(crank.angle.work)", "rods", "did you mean 'rod'"),
        (["inverse(crank.angle.work)", "crank.angle"], "*", "one after the other"),
    ],
)
def test_names_are_checked(of, to, match):
    """Of channels and parameters."""
    with pytest.raises(InputError, match=match):
        vd.sensitivity(SCENARIO, of, to)
