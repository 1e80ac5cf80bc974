"""Stability and comfort on curve transitions against closed forms."""

import numpy as np
import pytest

from vehicledyn.results.assessment.assess import assess
from vehicledyn.results.assessment.curve_transitions import SEATED, STANDING, find_transitions
from vehicledyn.results.assessment.even_samples import even_samples
from vehicledyn.results.assessment.running_safety import track_shift_limit
from vehicledyn.results.assessment.signal import signal_of
from vehicledyn.results.assessment.stability import assess_stability, band
from vehicledyn.results.assessment.summary import summarise_assessment

STEP, SPEED = 5e-3, 40.0
TIME = np.arange(0.0, 40.0 + STEP / 2, STEP)
WAY = SPEED * TIME


def vehicle(**changes):
    """Return the channels of a wheelset and a floor, with their units."""
    still = np.zeros_like(TIME)
    values = {
        "front.left.Q": ("N", 5e4 + still),
        "front.right.Q": ("N", 5e4 + still),
        "front.left.Y": ("N", 5e3 + still),
        "front.right.Y": ("N", -5e3 + still),
        "runner.track_position": ("m", WAY),
        "runner.curvature": ("1/m", still),
        "floor.lateral": ("m/s^2", still),
        "floor.roll_rate": ("rad/s", still),
    }
    values |= {name: (values[name][0], column) for name, column in changes.items()}
    channels = {name: column for name, (_, column) in values.items()}
    return TIME, channels, {name: unit for name, (unit, _) in values.items()}


def ramp(begin, end, low, high):
    return low + (high - low) * np.clip((TIME - begin) / (end - begin), 0.0, 1.0)


def test_instability_of_a_growing_oscillation():
    """a(x) sin ωt, a growing as x: the last 100 m have (a(x₁)² + a(x₁)a(x₀) + a(x₀)²)/6 = rms².

    A constant, a slow and a fast part lie outside the band.
    """
    amplitude = 10.0 * WAY
    total = amplitude * np.sin(2.0 * np.pi * 5.5 * TIME) + 8e3
    total += 2e3 * np.sin(2.0 * np.pi * 0.3 * TIME) + 2e3 * np.sin(2.0 * np.pi * 19.0 * TIME)
    values = {"w.left.Y": 0.5 * total, "w.right.Y": 0.5 * total}
    found = assess_stability(
        "w", even_samples(TIME, values), signal_of(WAY), 6e4, ("w.left", "w.right")
    )
    last, first = amplitude[-1], amplitude[-1] - 1e3
    rms = np.sqrt((last**2 + last * first + first**2) / 6.0)
    gain = abs(band(5.5)(np.array([5.5])))[0]
    assert found.frequency == pytest.approx(5.5, abs=0.03)
    assert found.rms == pytest.approx(gain * rms, rel=0.01)
    assert 0.98 < gain < 1.0
    assert found.limit == pytest.approx(0.5 * track_shift_limit(6e4))
    assert found.place == pytest.approx(WAY[-1] - 50.0, abs=1e-6)


def test_a_short_way_has_no_instability():
    time, channels, units = vehicle()
    part = time < 2.0
    found = assess(time[part], {n: c[part] for n, c in channels.items()}, units)
    assert found.axles and not found.stability
    assert any("shorter than a window of 100 m" in remark for remark in found.remarks)


def test_comfort_on_a_linear_transition():
    """Acceleration from 0 to a in T and roll rate ω between: jerk a/T.

    The filter overshoots a little after corners.
    """
    begin, end, a, roll = 10.0, 14.0, 1.2, 0.05
    time, channels, units = vehicle(
        **{
            "runner.curvature": ramp(begin, end, 0.0, 1.0 / 800.0),
            "floor.lateral": ramp(begin, end, 0.0, -a),
            "floor.roll_rate": roll * (ramp(10.0, 11.0, 0.0, 1.0) - ramp(13.0, 14.0, 0.0, 1.0)),
        }
    )
    found = assess(time, channels, units)
    (one,) = found.transitions
    assert (one.begin, one.end) == pytest.approx((begin, end), abs=2 * STEP)
    assert one.acceleration == pytest.approx(a, rel=1e-3)
    assert one.jerk == pytest.approx(a / (end - begin), rel=2e-3)
    assert one.roll_rate == pytest.approx(roll, rel=2e-3)
    standing = 28.54 * a + 20.69 * a / 4.0 - 11.1 + 0.185 * np.degrees(roll) ** 2.283
    seated = 8.97 * a + 9.68 * a / 4.0 - 5.9 + 0.12 * np.degrees(roll) ** 1.626
    assert one.standing == pytest.approx(standing, rel=4e-3)
    assert one.seated == pytest.approx(seated, rel=4e-3)
    entries = {entry.name: entry.value for entry in summarise_assessment(found)}
    assert entries["floor.p_ct_standing"] == pytest.approx(standing, rel=4e-3)


def test_gentle_transitions_disturb_by_their_roll_only():
    assert STANDING.disturbed(0.1, 0.1, 0.0) == 0.0
    assert SEATED.disturbed(0.0, 0.0, 1.0 / 0.916) == pytest.approx(100.0)


def test_transitions_enter_curves_or_change_their_side():
    """Into a curve to the left, over into one to the right, out of it, and into it by a jump."""
    curvature = ramp(5.0, 8.0, 0.0, 2e-3) + ramp(15.0, 20.0, 0.0, -4e-3)
    curvature = curvature + ramp(25.0, 28.0, 0.0, 2e-3) + np.where(TIME > 33.0, 1e-3, 0.0)
    found = find_transitions(*map(signal_of, (TIME, curvature, WAY)))
    spans = [(t.begin, t.end) for t in found]
    assert spans[0] == pytest.approx((5.0, 8.0), abs=2 * STEP)
    assert spans[1] == pytest.approx((15.0, 20.0), abs=2 * STEP)
    assert len(spans) == 3 and spans[2] == pytest.approx((33.0, 33.0), abs=2 * STEP)


@pytest.mark.parametrize("begin", [0.0, 0.5, 37.0])
def test_transitions_at_the_ends_are_left_out(begin):
    time, channels, units = vehicle(**{"runner.curvature": ramp(begin, begin + 3.0, 0.0, 1e-3)})
    assert not assess(time, channels, units).transitions


def test_without_a_floor_it_is_told():
    time, channels, units = vehicle(**{"runner.curvature": ramp(10.0, 13.0, 0.0, 1e-3)})
    units.pop("floor.roll_rate")
    channels.pop("floor.roll_rate")
    found = assess(time, channels, units)
    assert not found.transitions
    assert any("kind 'floor'" in remark for remark in found.remarks)
