"""Identification from a model's own noisy data."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyse.identify import estimate
from vehicledyn.base.errors import InputError
from vehicledyn.interface.targets import read_scenario
from vehicledyn.studies.identification.identify import MeasuredChannel, identify


def test_intervals_hold_the_truth_as_often_as_they_say():
    """A line through noisy points: 95 of 100, within the scatter of such a count."""
    times, truth = np.linspace(0.0, 1.0, 40), np.array([2.0, -1.0])
    jacobian = np.stack([np.ones(40), times], axis=1) / 0.1
    bounds = np.full(2, -10.0), np.full(2, 10.0)
    held = 0
    for seed in range(100):
        noise = np.random.default_rng(seed).normal(size=40)

        def residuals(x, noise=noise):
            return jacobian @ (x - truth) - noise, jacobian

        found = estimate(residuals, start=np.zeros(2), bounds=bounds)
        held += found.intervals[0, 0] <= truth[0] <= found.intervals[0, 1]
    assert 88 <= held <= 100
    expected = found.variance * np.linalg.inv(jacobian.T @ jacobian)
    assert found.covariance == pytest.approx(expected, rel=1e-9)


def test_a_blind_combination_is_named():
    """Only the sum of two parameters is seen."""
    jacobian = np.ones((10, 2))
    bounds = np.zeros(2), np.ones(2)
    found = estimate(lambda x: (jacobian @ x - 1.0, jacobian), start=np.full(2, 0.2), bounds=bounds)
    assert np.abs(found.blind[0]) == pytest.approx(np.full(2, np.sqrt(0.5)))
    assert np.isinf(found.intervals).all()


@pytest.mark.long
def test_a_pendulum_tells_its_length_but_not_its_mass():
    """From own data with 1 % noise."""
    loaded = read_scenario("double_pendulum", ["duration=1 s"])
    bounds = {"length": {"from": "0.7 m", "to": "1.4 m"}}
    rng, times = np.random.default_rng(5), np.linspace(0.0, 1.0, 51)
    from vehicledyn.analyses.sensitivity.motion_study import MotionStudy

    study = MotionStudy.of(loaded, ["upper.angle"], lambda *_: None).moved({"length": 1.1})
    motion = study.plain(lambda *_: None)
    names = [study.prepared.equations.channels[k].name for k in study.channels]
    clean = np.interp(times, motion.times, motion.values[:, names.index("upper.angle")])
    data = {"upper.angle": (times, clean + 0.01 * rng.normal(size=51), "0.01 rad")}
    report = vd.identify("double_pendulum", data, bounds, duration="1 s")
    noisy = MeasuredChannel("upper.angle", *data["upper.angle"][:2], 0.01)
    low, high = report.found.intervals[0]
    middle, reach = 0.5 * (low + high), 0.5 * (high - low)
    assert abs(middle - 1.1) < 2.0 * reach < 0.02
    assert report.found.variance == pytest.approx(1.0, abs=0.6)
    assert "length = 1.1" in report.as_text() or "length = 1.0" in report.as_text()
    both = identify(
        loaded, [noisy], bounds | {"mass": {"from": "0.5 kg", "to": "2 kg"}}, lambda *_: None
    )
    assert "cannot tell" in both.as_text()
    with pytest.raises(InputError, match="did you mean 'length'"):
        identify(loaded, [noisy], {"lenght": bounds["length"]}, lambda *_: None)
    gap = MeasuredChannel("upper.angle", times, np.full(51, np.nan), 0.01)
    with pytest.raises(InputError, match="gaps"):
        identify(loaded, [gap], bounds, lambda *_: None)


def test_start_values_that_were_given_stay_when_parameters_move():
    """Else runs that confirm derivatives begin elsewhere than the one that they confirm."""
    from vehicledyn.analyses.sensitivity.motion_study import MotionStudy

    loaded = read_scenario("quarter_car", ["duration=1 s"])
    study = MotionStudy.of(loaded, ["body.height"], lambda *_: None)
    begun = study.moved({"start.body.height": 0.02})
    assert begun.moved({"body.stiffness": 3e4}).start.state == pytest.approx(begun.start.state)
    further = begun.moved({"start.wheel.height": 0.01}).start.state
    assert sorted(further)[-2:] == pytest.approx([0.01, 0.02])
