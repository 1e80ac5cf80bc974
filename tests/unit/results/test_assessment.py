"""Assessment of rail vehicles: filters, means and percentiles against closed forms and SciPy."""

import json
import math
import tracemalloc

import numpy as np
import pytest
from scipy import signal

from vehicledyn.base.errors import InputError
from vehicledyn.results.assessment.assess import assess
from vehicledyn.results.assessment.comfort import assess_comfort, mean_comfort
from vehicledyn.results.assessment.even_samples import LazyChannels, even_samples
from vehicledyn.results.assessment.filters import butterworth, filtered, high_pass
from vehicledyn.results.assessment.report import assess_result
from vehicledyn.results.assessment.running_behaviour import assess_acceleration
from vehicledyn.results.assessment.running_safety import (
    assess_axle,
    assess_wheel,
    nadal_limit,
    static_load,
    static_samples,
    track_shift_limit,
)
from vehicledyn.results.assessment.signal import signal_of
from vehicledyn.results.assessment.sliding import block_rms, sliding_mean
from vehicledyn.results.assessment.summary import summarise_assessment
from vehicledyn.results.assessment.wear import assess_wear
from vehicledyn.results.assessment.weighting import (
    VERTICAL,
    W_B,
    W_B_ISO,
    W_C,
    W_D,
    Sperling,
)
from vehicledyn.results.store.layout import SampleAxis

STEP = 5e-3
TIME = np.arange(0.0, 300.0 + STEP / 2, STEP)
DIRECTIONS = ("longitudinal", "lateral", "vertical")


def sine(frequency, amplitude, time=TIME):
    return amplitude * np.sin(2.0 * np.pi * frequency * time)


def cabin(x=0.0, y=0.0, z=0.0, time=TIME):
    values = {"longitudinal": x, "lateral": y, "vertical": z}
    return {f"cabin.{name}": value + 0.0 * time for name, value in values.items()}


def ride(speed=20.0, step=STEP, duration=60.0, **changes):
    """Two wheels at 50 kN that press outwards with 5 kN and 3 kN, and a cabin."""
    time = np.arange(0.0, duration + step / 2, step)
    still = np.zeros_like(time)
    channels = {
        "front.left.Q": 5e4 + still,
        "front.right.Q": 5e4 + still,
        "front.left.Y": 5e3 + still,
        "front.right.Y": -3e3 + still,
        "front.left.wear_number": 40.0 + still,
        "front.right.wear_number": 10.0 + still,
        "front.track_position": speed * time,
        **cabin(0.1 * np.sin(2 * np.pi * time), sine(1.0, 0.5, time), sine(5.0, 0.4, time), time),
        **changes,
    }
    channels = {name: values for name, values in channels.items() if values is not None}
    ends = {"Q": "N", "Y": "N", "wear_number": "N", "track_position": "m"}
    units = {name: ends.get(name.rpartition(".")[2], "m/s^2") for name in channels}
    return time, channels, units


@pytest.mark.parametrize("weighting", [W_B, W_B_ISO, W_C, W_D], ids=["b", "b_iso", "c", "d"])
def test_weighted_noise_is_that_of_digital_filters(weighting):
    """Second way: each analogue part made digital at 4 kHz by the bilinear transform."""
    step, low, high, flat = 2.5e-4, 2.0 * np.pi * 0.4, 2.0 * np.pi * 100.0, math.sqrt(2.0)
    noise = np.random.default_rng(7).normal(size=40001)
    smooth = signal.sosfilt(signal.butter(6, 60.0, fs=1 / step, output="sos"), noise)
    w3 = 2.0 * np.pi * weighting.transition
    parts = [
        ([1.0, 0.0, 0.0], [1.0, flat * low, low**2]),
        ([high**2], [1.0, flat * high, high**2]),
        ([1.0 / w3, 1.0], [1.0 / w3**2, 1.0 / (weighting.quality * w3), 1.0]),
    ]
    if weighting.step is not None:
        s = weighting.step
        w5, w6 = 2.0 * np.pi * s.low, 2.0 * np.pi * s.high
        above = [s.gain / w5**2, s.gain / (s.low_quality * w5), s.gain]
        parts.append((above, [1.0 / w6**2, 1.0 / (s.high_quality * w6), 1.0]))
    expected = smooth
    for above, below in parts:
        expected = signal.lfilter(*signal.bilinear(above, below, fs=1 / step), expected)
    found = filtered(smooth, step, weighting)
    assert found == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("weighting", "gain"), [(W_B_ISO, 0.8126), (W_C, 0.5145), (W_D, 0.1261)], ids=["b", "c", "d"]
)
def test_gain_at_the_reference_frequency_of_iso_8041(weighting, gain):
    """100 rad/s, four digits, as a maker of vibration meters prints them."""
    found = abs(weighting(np.array([100.0 / (2.0 * np.pi)])))[0]
    assert found == pytest.approx(gain, abs=0.5e-4)


def test_low_pass_is_that_of_scipy():
    """At 20 Hz -3 dB, one octave above 24 dB; in time as SciPy's filter at a high rate."""
    gains = abs(butterworth(20.0, 4)(np.array([0.0, 20.0, 40.0])))
    assert gains == pytest.approx([1.0, math.sqrt(0.5), 1.0 / math.sqrt(257.0)], rel=1e-12)
    step = 1e-4
    noise = np.cumsum(np.random.default_rng(7).normal(size=20001)) + 100.0
    sos = signal.butter(4, 20.0, fs=1 / step, output="sos")
    expected = signal.sosfilt(sos, noise, zi=signal.sosfilt_zi(sos) * noise[0])[0]
    found = filtered(noise, step, butterworth(20.0, 4))
    assert found == pytest.approx(expected, abs=1e-3 * np.ptp(noise))


def test_high_pass_mirrors_the_low_pass():
    frequencies = np.array([0.0, 0.1, 0.4, 3.0])
    found = abs(high_pass(0.4, 4)(frequencies))
    assert found == pytest.approx([0.0, *abs(butterworth(0.4, 4)(0.16 / frequencies[1:]))])
    assert abs(signal.freqs(*signal.butter(4, 0.4, "high", analog=True), frequencies)[1]) == (
        pytest.approx(found, abs=1e-12)
    )


def test_running_behaviour_of_a_sine_on_a_curve():
    """2 Hz pass, 0.02 Hz and the constant only behind the low-pass, 50 Hz nowhere."""
    values = 0.7 + sine(2.0, 0.5) + sine(0.02, 0.1) + sine(50.0, 2.0)
    found = assess_acceleration("c", "lateral", even_samples(TIME, {"c.lateral": values}))
    assert found.rms == pytest.approx(0.5 / math.sqrt(2.0), rel=5e-3)
    assert abs(found.largest) == pytest.approx(0.5, rel=1e-2)
    assert found.quasi_static == pytest.approx(0.7, abs=0.02)


def test_a_constant_passes_the_low_pass_and_not_the_weightings():
    constant = np.full(4001, 3.0)
    assert filtered(constant, STEP, butterworth(20.0, 4)) == pytest.approx(constant, rel=1e-12)
    assert filtered(constant, STEP, W_D) == pytest.approx(0.0, abs=1e-12)


def test_sliding_mean_of_a_sine_in_distance():
    """The mean over L of sin(ks) is sinc(kL/2) times the sine in the middle."""
    distance = np.linspace(0.0, 40.0, 4001)
    wave = 2.0 * np.pi / 7.0
    found = sliding_mean(
        *map(signal_of, (distance, np.sin(wave * distance))), window=2.0, every=0.5
    )
    places = np.arange(1.0, 39.01, 0.5)
    assert [found.place(k) for k in range(found.mean.count)] == pytest.approx(places)
    expected = np.sin(wave) / wave * np.sin(wave * places)
    assert found.mean.part(0, 77) == pytest.approx(expected, abs=1e-5)


def test_sliding_mean_is_exact_between_uneven_samples_and_passes_a_stop():
    distance = np.array([0.0, 0.7, 0.7, 2.9, 5.0])
    found = sliding_mean(*map(signal_of, (distance, 3.0 * distance)), window=2.0, every=0.5)
    assert found.mean.part(0, 9) == pytest.approx(3.0 * np.arange(1.0, 4.01, 0.5))
    assert found.mean.count == 7
    short = signal_of(distance[:3])
    assert not sliding_mean(short, short, window=2.0, every=0.5).mean.count


def test_mean_comfort_of_sines():
    """Each root mean square is a |W(f)| / √2, the same in every window."""
    values = cabin(sine(1.0, 0.3), sine(0.8, 0.5), sine(8.0, 0.7))
    found = assess_comfort("cabin", even_samples(TIME, values))
    expected = {
        "longitudinal": 0.3 * abs(W_D(np.array([1.0])))[0] / math.sqrt(2.0),
        "lateral": 0.5 * abs(W_D(np.array([0.8])))[0] / math.sqrt(2.0),
        "vertical": 0.7 * abs(W_B(np.array([8.0])))[0] / math.sqrt(2.0),
    }
    for direction, value in expected.items():
        assert len(found.continuous[direction]) == 60
        assert found.continuous[direction][2:-2] == pytest.approx(value, rel=1e-3)
    assert found.mean == pytest.approx(6.0 * math.hypot(*expected.values()), rel=2e-3)


def test_mean_comfort_takes_the_95th_percentile():
    windows = np.arange(101.0)
    assert mean_comfort({"x": windows, "y": 0.0 * windows, "z": 0.0 * windows}) == 6.0 * 95.0


def test_rms_of_windows():
    values = np.concatenate([np.full(1000, 2.0), np.full(1000, -3.0), np.full(500, 9.0)])
    assert block_rms(signal_of(values), STEP, 5.0) == pytest.approx([2.0, 3.0])


@pytest.mark.parametrize(("direction", "factor"), [("lateral", 0.737), ("vertical", 0.588)])
def test_ride_index_of_a_sine(direction, factor):
    """W_z = (a B)^0.3 with a in cm/s², B by its own formula; 4.42 times the rms to 0.3."""
    f, amplitude = 5.3, 0.6
    above = 1.911 * f**2 + (0.25 * f**2) ** 2
    below = (1.0 - 0.277 * f**2) ** 2 + (1.563 * f - 0.0368 * f**3) ** 2
    weight = factor * math.sqrt(above / below)
    values = {f"cabin.{direction}": sine(f, amplitude)}
    found = assess_comfort("cabin", even_samples(TIME, values)).sperling[direction]
    assert found == pytest.approx((100.0 * amplitude * weight) ** 0.3, rel=1e-4)
    assert found == pytest.approx(4.42 * (amplitude * weight / math.sqrt(2.0)) ** 0.3, rel=1e-3)


def test_ride_index_of_noise_against_its_spectrum():
    """Second way: 2 ∫ B² G df over 0.5 to 30 Hz with SciPy's power spectral density."""
    noise = np.random.default_rng(7).normal(size=len(TIME))
    frequency, density = signal.welch(noise, fs=1 / STEP, nperseg=4000)
    inside = (frequency >= 0.5) & (frequency <= 30.0)
    weight = abs(Sperling(VERTICAL)(frequency))
    power = np.trapezoid((weight**2 * density)[inside], frequency[inside])
    found = assess_comfort("cabin", even_samples(TIME, {"cabin.vertical": noise}))
    assert found.sperling["vertical"] == pytest.approx((2e4 * power) ** 0.15, rel=2e-3)
    assert found.mean is None


def test_forces_of_a_wheel_are_percentiles_of_slow_signals():
    """Slow ramps pass the filter: percentiles of evenly spread values are known."""
    ramp = TIME / TIME[-1]
    values = {"w.left.Q": 4e4 + 2e4 * ramp, "w.left.Y": 1e4 * ramp}
    samples, distance = even_samples(TIME, values), signal_of(15.0 * TIME)
    wheel = assess_wheel("w.left", samples, distance, 5e4)
    assert wheel.vertical_quasi_static == pytest.approx(5e4, rel=1e-4)
    assert wheel.guiding_quasi_static == pytest.approx(5e3, rel=1e-3)
    assert wheel.vertical_largest == pytest.approx(4e4 + 0.9985 * 2e4, rel=1e-4)
    assert wheel.unloading == pytest.approx(0.2, abs=1e-4)
    assert wheel.lifted == 0.0
    assert wheel.derailment == pytest.approx(0.9985 / (4.0 + 2.0 * 0.9985), rel=1e-3)
    axle = assess_axle("w", samples, distance, 5e4, ("w.left", "w.left"))
    assert axle.track_shift == pytest.approx(2.0 * 0.9985e4, rel=1e-3)
    assert axle.limit == pytest.approx(10e3 + 1e5 / 3.0)


def test_forces_near_20_hz_lose_3_db():
    """19.7 Hz are no whole part of the sampling rate, so that a sample meets each peak."""
    values = {"w.left.Q": 5e4 + sine(19.7, 1e4), "w.left.Y": 0.0 * TIME}
    wheel = assess_wheel("w.left", even_samples(TIME, values), None, 5e4)
    smallest = 5e4 - 1e4 / math.sqrt(1.0 + (19.7 / 20.0) ** 8)
    assert wheel.vertical_smallest == pytest.approx(smallest, rel=2e-3)
    assert wheel.derailment is None


def test_extremes_keep_their_sign():
    samples = even_samples(TIME, {"w.left.Y": -1e4 * TIME / TIME[-1]})
    axle = assess_axle("w", samples, signal_of(15.0 * TIME), 5e4, ("w.left",))
    assert axle.track_shift == pytest.approx(-0.9985e4, rel=1e-3)


def test_static_loads_are_those_on_straight_track():
    """A wheel of 20 kN carries 30 kN in the curve that takes nine tenths of the run."""
    bent = 0.1 * TIME[-1] < TIME
    values = {"w.left.Q": np.where(bent, 3e4, 2e4)}
    samples = even_samples(TIME, values)
    curvature = np.where(bent, 0.05, 0.0)

    def load(samples, curvature):
        curvature = None if curvature is None else signal_of(curvature)
        return static_load(samples, ("w.left",), static_samples(samples, "w", curvature))

    assert load(samples, curvature) == 2e4
    assert load(samples, None) == 3e4
    assert load(samples, np.full_like(TIME, 0.05)) == 3e4
    assert load(even_samples(TIME, values, begin=0.5 * TIME[-1]), curvature) == 2e4


def test_each_axle_takes_its_static_load_where_itself_is_on_straight_and_level_track():
    """The runner is in a curve for most of the run; the last axle enters it at the end."""
    late, ramped = 0.9 * TIME[-1] < TIME, 0.3 * TIME[-1] > TIME
    channels = {
        "runner.track_frame.curvature": np.where(0.1 * TIME[-1] < TIME, 0.05, 0.0),
        "last.left.Q": np.where(late, 3e4, np.where(ramped, 2.5e4, 2e4)),
        "last.left.Y": 0.0 * TIME,
        "last.curvature": np.where(late, 0.05, 0.0),
        "last.cant": np.where(ramped, 0.05, 0.0),
        "never.left.Q": 0.0 * TIME + 1e4,
        "never.left.Y": 0.0 * TIME,
        "never.curvature": 0.0 * TIME + 0.05,
    }
    units = {
        name: "1/m" if name.endswith("curvature") else "m" if name.endswith("cant") else "N"
        for name in channels
    }
    found = assess(TIME, channels, units)
    assert {wheel.name: wheel.static for wheel in found.wheels} == {
        "last.left": pytest.approx(2e4),
        "never.left": pytest.approx(1e4),
    }
    told = [remark for remark in found.remarks if "static loads" in remark]
    assert told == [
        "static loads of never are medians of the section, as these axles are on straight, "
        "level track for less than 0.2 s: let the run begin there"
    ]


def test_limits():
    """At 70° and a friction of 0.36 Nadal's limit is 1.2; Prud'homme bears 43 kN at 50 kN."""
    assert nadal_limit(math.radians(70.0), 0.36) == pytest.approx(1.2, abs=0.005)
    assert nadal_limit(math.atan(2.0), 0.0) == pytest.approx(2.0)
    assert track_shift_limit(4.95e4, 0.85) == pytest.approx(0.85 * 43e3)
    with pytest.raises(InputError, match="flange angle of 90°"):
        nadal_limit(0.5 * math.pi, 0.3)


def test_wear_over_the_distance():
    """Tγ = 2 s over 100 m: 10 kJ, half of them mean, parts of 10 m in the middle of each."""
    distance = np.linspace(0.0, 100.0, 333)
    wear = assess_wear("w", signal_of(distance), signal_of(2.0 * distance))
    assert (wear.work, wear.mean, wear.largest) == pytest.approx((1e4, 100.0, 200.0))
    assert wear.parts == pytest.approx(np.arange(10.0, 200.0, 20.0))


def test_a_ride_as_a_whole():
    found = assess(*ride())
    assert found.way == pytest.approx(1200.0)
    assert [w.derailment for w in found.wheels] == pytest.approx([0.1, 0.06])
    assert [w.static for w in found.wheels] == pytest.approx([5e4, 5e4])
    (axle,) = found.axles
    assert axle.track_shift == pytest.approx(2e3)
    assert sum(w.work for w in found.wear) == pytest.approx(6e4)
    assert found.remarks == ["comfort: 12 windows of 5 s; EN 12299 asks for 60"]
    entries = {e.name: e.value for e in summarise_assessment(found)}
    assert entries["largest_y_over_q"] == pytest.approx(0.1)
    assert entries["largest_y_over_q_at"] == "front.left"
    assert entries["wear_number"] == pytest.approx(50.0)
    assert {"cabin.n_mv", "cabin.wz_lateral", "cabin.wz_vertical"} <= set(entries)


def test_a_section_sees_filters_that_have_settled():
    time, channels, units = ride(**{"front.left.Y": None})
    channels["front.left.Y"] = np.where(time < 20.0, 2e4, 5e3)
    units["front.left.Y"] = "N"
    found = assess(time, channels, units, begin=30.0, end=50.0)
    assert (found.begin, found.end, found.way) == pytest.approx((30.0, 50.0, 400.0))
    left = next(w for w in found.wheels if w.name == "front.left")
    assert left.derailment == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "gone", "words"),
    [
        ({"step": 0.05}, "wheels axles comfort", "20 samples a second are too few"),
        ({"duration": 4.9}, "comfort", "4.9 s are shorter than a window of 5 s"),
        ({"front.track_position": None}, "axles wear", "no channel gives the distance run"),
        ({"speed": 0.03}, "axles", "only 1.8 m were run"),
        ({"cabin.vertical": None}, "", "N_MV of cabin is left out: there is no cabin.vertical"),
        (dict.fromkeys(f"cabin.{d}" for d in DIRECTIONS), "comfort", "there is no accelerometer"),
        ({"step": 0.01}, "", "100 samples a second; EN 12299 asks for 200"),
        ({"front.left.Q": np.full(12001, np.nan)}, "axles", "front.left.Q holds values that"),
    ],
)  # fmt: skip
def test_what_cannot_be_told_is_left_out(changes, gone, words):
    found = assess(*ride(**changes))
    assert words in "; ".join(found.remarks)
    for name in ("wheels", "axles", "comfort", "wear"):
        assert bool(getattr(found, name)) == (name not in gone.split())


def test_a_wheel_that_lifts_has_no_ratio():
    time, channels, units = ride()
    channels["front.left.Q"] = np.where((time > 10.0) & (time < 11.0), 0.0, 5e4)
    found = assess(time, channels, units)
    assert [w.derailment is None for w in found.wheels] == [True, False]
    assert found.wheels[0].unloading == pytest.approx(1.0, abs=0.15)
    assert "front.left has no load for 1." in "; ".join(found.remarks)


def test_instants_that_are_told_twice_and_a_last_odd_step():
    time, channels, units = ride()
    plain = assess(time, channels, units)
    doubled = np.insert(np.append(time, time[-1] + 0.0017), 500, time[500])
    more = {n: np.insert(np.append(v, v[-1]), 500, v[500]) for n, v in channels.items()}
    found = assess(doubled, more, units)
    assert found.rate == pytest.approx(plain.rate)
    assert found.comfort[0].mean == pytest.approx(plain.comfort[0].mean, rel=1e-9)


def test_a_file_as_text_and_json(make_result):
    time, channels, units = ride()
    path = make_result(time=time, values={n: (units[n], v) for n, v in channels.items()})
    report = assess_result(path)
    text = report.as_text()
    for words in ("0 to 60 s, 1200 m, 200 samples a second", "front.left", "N_MV", "limit kN"):
        assert words in text
    found = json.loads(json.dumps(report.as_dict(), default=lambda array: array.tolist()))
    assert found["axles"][0]["limit"] == pytest.approx(10e3 + 1e5 / 3.0)
    with pytest.raises(InputError, match="nothing to assess there: the run holds 0 to 60 s"):
        assess_result(path, begin=70.0)


def test_files_that_hold_nothing_to_assess(make_result):
    with pytest.raises(InputError, match="neither forces of wheels on rails"):
        assess_result(make_result())
    counted = make_result("counted.h5", axis=SampleAxis("1", "Sample"))
    with pytest.raises(InputError, match="its samples are not taken in time"):
        assess_result(counted)


def test_a_partial_file_says_so_first(make_result):
    time, channels, units = ride()
    values = {n: (units[n], v) for n, v in channels.items()}
    path = make_result(time=time, values=values, status="failed", message="derailed")
    assert assess_result(path).as_text().startswith("PARTIAL RESULT: failed at t = 60 s: derailed")


def most_memory(axles):
    """Return the most memory of an assessment of so many axles, whose channels are on a disk."""
    time, load = np.linspace(0.0, 100.0, 100_001), np.full(100_001, 5e4)
    forces = [
        f"axle_{n}.{side}.{f}" for n in range(axles) for side in ("left", "right") for f in "YQ"
    ]
    units = dict.fromkeys(forces, "N") | {"body.x": "m"}

    def read(name):
        return 20.0 * time if name == "body.x" else load + 1e3 * np.sin(time)

    tracemalloc.start()
    found = assess(time, LazyChannels(units, read), units)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(found.wheels) == 2 * axles
    return most


def test_memory_does_not_grow_with_the_channels():
    assert most_memory(6) - most_memory(2) < 8 * 100_001  # one of the 16 further columns
