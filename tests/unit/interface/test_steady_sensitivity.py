"""Derivatives of steady cornering by parameters of a car."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.sensitivity.subjects.cornering_figures import CorneringSlopes
from vehicledyn.base.errors import InputError, NumericalError

GRAVITY = 9.81
LOAD, FRONT, REAR = 2500.0, 30e3, 42e3
LINEAR = f"""\
title: A small car on linear tyres
model: small_car
tyres:
  front: {{kind: linear, nominal_load: {LOAD} N, longitudinal_stiffness: 60 kN,
    cornering_stiffness: {FRONT} N/rad, friction: 1}}
  rear: {{kind: linear, nominal_load: {LOAD} N, longitudinal_stiffness: 60 kN,
    cornering_stiffness: {REAR} N/rad, friction: 1}}
wheel_spin: free
road: {{kind: flat}}
speed: 25 m/s
duration: 1 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 10 ms}}
manoeuvre: {{kind: straight}}
"""


@pytest.mark.long
def test_a_car_on_linear_tyres_follows_the_single_track_model(tmp_path):
    """K = F0/g (1/C_front - 1/C_rear): each axle's slip by its own stiffness, at small angles."""
    of = [
        "steady(understeer_angle, constant_speed, 0.1 m/s^2, speed=25 m/s)",
        "steady(understeer_gradient, constant_speed, speed=25 m/s)",
    ]
    (tmp_path / "linear.yaml").write_text(LINEAR)
    found = vd.sensitivity(tmp_path / "linear.yaml", of, "tyres.*.cornering_stiffness")
    names = list(found["parameter"].values)
    for end, sign, stiffness in (("front", -1.0, FRONT), ("rear", 1.0, REAR)):
        exact = sign * LOAD / GRAVITY / stiffness**2
        angle, gradient = found["figure_slope"].values[
            :, names.index(f"tyres.{end}.cornering_stiffness")
        ]
        assert angle / 0.1 == pytest.approx(exact, rel=0.01)
        assert gradient == pytest.approx(exact, rel=0.05)


@pytest.mark.long
def test_places_of_a_curve_are_found_in_one_go(monkeypatch):
    """As a study names those of a measured curve one by one: about straight running once."""
    count, about = [], CorneringSlopes.about
    monkeypatch.setattr(CorneringSlopes, "about", lambda *a: count.append(a) or about(*a))
    names = [f"steady(yaw_rate_gain, response, {f} Hz)" for f in (2, 1)]
    names.insert(1, "steady(yaw_rate_phase, response, 1 Hz:2 Hz:1)")
    found = vd.sensitivity("small_car", names, "body.mass")["figure_value"].values
    assert len(count) == 2
    assert found[0] < found[3]
    assert found[2] < found[1] < 0.0


@pytest.mark.parametrize(
    ("of", "to", "match"),
    [
        ("steady(understeer_gradient)", "*", "write steady"),
        ("steady(understeer_gradiant, constant_radius)", "*", "did you mean 'understeer_gradient'"),
        ("steady(steering_angle, constant_radios, 1 m/s^2)", "*", "did you mean 'constant_radius'"),
        ("steady(understeer_gradient, constant_speed, 1 m/s^2)", "*", "give no values"),
        ("steady(limit, constant_speed, 1 m/s^2)", "*", "give no values"),
        ("steady(steering_angle, constant_speed)", "*", "needs lateral accelerations"),
        ("steady(steering_angle, constant_speed, 1 m)", "*", "m/s"),
        ("steady(steering_angle, constant_speed, -1 m/s^2)", "*", "above zero"),
        ("steady(steering_angle, constant_speed, 1 m/s^2, radius=9 m)", "*", "Known: speed"),
        ("steady(steering_angle, constant_speed, 1 m/s^2)", "start.body.x", "no start values"),
    ],
)
def test_names_are_checked(of, to, match):
    with pytest.raises(InputError, match=match):
        vd.sensitivity("small_car", of, to)


@pytest.mark.long
def test_limits_follow_the_track():
    """The fold of the curve of turns, by differences of folds found anew."""
    of = "steady(limit, constant_speed, speed=20 m/s)"

    def limit(track):
        return vd.sensitivity("small_car", of, "track", set={"parameters.track": f"{track!r} m"})

    found = limit(1.4)
    wide, near = (
        float(np.diff([limit(1.4 + d)["figure_value"].values[0] for d in (-h, h)])[0]) / (2.0 * h)
        for h in (4e-3, 2e-3)
    )
    exact = (4.0 * near - wide) / 3.0
    assert found["figure_slope"].values[0, 0] == pytest.approx(exact, rel=1e-8)


@pytest.mark.long
def test_turns_beyond_the_limit_have_no_derivative():
    of = "steady(steering_angle, constant_speed, 30 m/s^2, speed=20 m/s)"
    with pytest.raises(NumericalError, match=r"the turns end at [0-9.]+ m/s\^2.*before 30"):
        vd.sensitivity("small_car", of)


@pytest.mark.long
def test_each_name_has_figures_of_its_own(tmp_path):
    """Circles of nearly one radius are not one, and studies count figures."""
    (tmp_path / "linear.yaml").write_text(LINEAR)
    of = [f"steady(speed, constant_radius, 1 m/s^2, radius={r} m)" for r in (100.0, 100.001)]
    found = vd.sensitivity(tmp_path / "linear.yaml", of, "tyres.front.cornering_stiffness")
    assert found["figure_value"].values == pytest.approx([10.0, 10.00005], rel=1e-7)
