"""Comfort weightings and assessed quantities against tables, closed forms and a second way."""

from __future__ import annotations

import math

import numpy as np
from scipy import signal

from reference_cases.comparison import Group, deviation, figure
from reference_cases.tables import read_columns
from vehicledyn.results.assessment.comfort import assess_comfort
from vehicledyn.results.assessment.curve_transitions import assess_transitions, find_transitions
from vehicledyn.results.assessment.even_samples import even_samples
from vehicledyn.results.assessment.filters import butterworth, filtered
from vehicledyn.results.assessment.running_safety import assess_axle, assess_wheel
from vehicledyn.results.assessment.signal import signal_of
from vehicledyn.results.assessment.stability import assess_stability, band
from vehicledyn.results.assessment.weighting import (
    VERTICAL,
    W_B,
    W_B_ISO,
    W_C,
    W_D,
    W_K,
)

TABLE, METER = "ISO 2631-1, one-third octaves", "ISO 8041, at 100 rad/s"
HALF_DIGIT = 0.005
"""Half the third digit of a factor that begins with 1.00, relative."""
TIME = np.arange(0.0, 300.0025, 5e-3)


def compare():
    """Return the comparisons."""
    note = (
        "Bands of the weightings: half the last digit printed; of the others 0.1 %, for filters "
        "that settle. W_b of EN 12299 and of ISO 2631-4 differ by up to "
        f"{100.0 * _apart():.0f} %; the program takes the first."
    )
    rows = (*_weightings(), *_comfort(), _low_pass(), _track_shift(), _instability(), _transition())
    return Group("Assessment of vehicles on rails", note, rows)


def _weightings():
    table = read_columns("frequency_weightings.csv")
    exact = 10.0 ** (np.round(10.0 * np.log10(table["frequency_Hz"])) / 10.0)
    for name, weighting in (("W_k", W_K), ("W_d", W_D)):
        apart = np.abs(weighting(exact)) / table[name] - 1.0
        yield deviation(
            TABLE,
            f"{name} at 0.1 to 80 Hz",
            reference="30 factors",
            largest=np.abs(apart).max(),
            band=HALF_DIGIT,
            unit="(relative)",
        )
    place = np.array([100.0 / (2.0 * math.pi)])
    for weighting, gain in ((W_B_ISO, 0.8126), (W_C, 0.5145), (W_D, 0.1261)):
        yield figure(
            METER,
            f"{weighting.name} of ISO",
            reference=gain,
            computed=abs(weighting(place))[0],
            band=5e-5,
            unit="",
            digits=4,
        )


def _comfort():
    """Sines of known weighted root mean square, with whole half periods in 5 s."""
    tones = {"longitudinal": (1.0, 0.3), "lateral": (0.8, 0.5), "vertical": (7.7, 0.7)}
    values = {
        f"floor.{name}": amplitude * np.sin(2.0 * np.pi * f * TIME)
        for name, (f, amplitude) in tones.items()
    }
    found = assess_comfort("floor", even_samples(TIME, values))
    filters = {"longitudinal": W_D, "lateral": W_D, "vertical": W_B}
    squares = [
        (a * abs(filters[name](np.array([f])))[0]) ** 2 / 2.0 for name, (f, a) in tones.items()
    ]
    mean = 6.0 * math.sqrt(sum(squares))
    yield figure(
        "closed form",
        "mean comfort N_MV of three sines",
        reference=mean,
        computed=found.mean,
        band=0.004,
        unit="",
    )
    f, amplitude = tones["vertical"]
    above = 1.911 * f**2 + (0.25 * f**2) ** 2
    below = (1.0 - 0.277 * f**2) ** 2 + (1.563 * f - 0.0368 * f**3) ** 2
    index = (100.0 * amplitude * VERTICAL * math.sqrt(above / below)) ** 0.3
    yield figure(
        "closed form",
        "Sperling's ride index of a sine",
        reference=index,
        computed=found.sperling["vertical"],
        band=0.002,
        unit="",
    )


def _low_pass():
    step = 1e-4
    forces = 5e4 + 1e3 * np.cumsum(np.random.default_rng(3).normal(size=20001)) * step**0.5
    sos = signal.butter(4, 20.0, fs=1.0 / step, output="sos")
    expected = signal.sosfilt(sos, forces, zi=signal.sosfilt_zi(sos) * forces[0])[0]
    found = filtered(forces, step, butterworth(20.0, 4))
    return deviation(
        "SciPy, digital filter at 10 kHz",
        "forces behind the low-pass filter of 20 Hz, over their range",
        reference="2 s of noise",
        largest=np.abs(found - expected).max() / np.ptp(forces),
        band=1e-3,
        unit="(relative)",
    )


def _track_shift():
    """The mean of a wave over 2 m and its percentiles have closed forms."""
    speed, wave = 20.0, 2.0 * np.pi / 13.7
    guiding = 1e4 * np.sin(wave * speed * TIME)
    values = {"w.left.Y": guiding, "w.left.Q": np.full_like(TIME, 5e4)}
    samples, distance = even_samples(TIME, values), signal_of(speed * TIME)
    axle = assess_axle("w", samples, distance, 5e4, ("w.left",))
    wheel = assess_wheel("w.left", samples, distance, 5e4)
    # A sine is below its 99.85 % percentile in that part of its period.
    part = math.sin(math.pi * (0.9985 - 0.5))
    gain = abs(butterworth(20.0, 4)(np.array([speed / 13.7])))[0]
    mean = gain * math.sin(wave) / wave * part
    apart = max(abs(abs(axle.track_shift) / 1e4 - mean), abs(abs(wheel.derailment) - 0.2 * mean))
    return deviation(
        "closed form",
        "99.85 % of the sum of Y and of Y/Q over 2 m, of a wave along the track",
        reference=f"{mean:.4f}",
        largest=apart / mean,
        band=1e-3,
        unit="(relative)",
    )


def _instability():
    """An oscillation that grows with the way has a known root mean square over its last 100 m."""
    way, frequency = 20.0 * TIME, 5.5
    guiding = 5.0 * way * np.sin(2.0 * np.pi * frequency * TIME)
    values = {f"w.{side}.Y": guiding for side in ("left", "right")}
    samples, wheels = even_samples(TIME, values), ("w.left", "w.right")
    found = assess_stability("w", samples, signal_of(way), 5e4, wheels)
    last, first = 10.0 * way[-1], 10.0 * (way[-1] - 100.0)
    rms = math.sqrt((last**2 + last * first + first**2) / 6.0)
    gain = abs(band(frequency)(np.array([frequency])))[0]
    return figure(
        "closed form",
        "root mean square of a growing sum of Y over 100 m",
        reference=1e-3 * gain * rms,
        computed=1e-3 * found.rms,
        band=1e-5 * rms,
        unit="kN",
    )


def _transition():
    """Acceleration that grows evenly over 4 s, without roll: the jerk is constant."""
    largest = 1.2
    part = np.clip((TIME - 100.0) / 4.0, 0.0, 1.0)
    values = {"floor.lateral": largest * part, "floor.roll_rate": 0.0 * part}
    transitions = find_transitions(*map(signal_of, (TIME, 1e-3 * part, 30.0 * TIME)))
    (found,) = assess_transitions("floor", even_samples(TIME, values), transitions)
    return figure(
        "closed form",
        "P_CT of standing passengers, acceleration to 1.2 m/s² in 4 s",
        reference=28.54 * largest + 20.69 * largest / 4.0 - 11.1,
        computed=found.standing,
        band=0.1,
        unit="%",
    )


def _apart():
    frequencies = np.linspace(0.5, 80.0, 2000)
    return np.abs(np.abs(W_B(frequencies)) / np.abs(W_B_ISO(frequencies)) - 1.0).max()
