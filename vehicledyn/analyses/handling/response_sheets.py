"""Transfer functions from the steering wheel as sheets of a report (ISO 7401)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.tables.columns import Column
from vehicledyn.results.tables.handling_table import Sheet
from vehicledyn.road.standards.frequency_response import transient_response
from vehicledyn.road.standards.signals import Signals

Responses = dict[str, NDArray[np.complex128]]

ANSWERS = {
    "yaw_rate": ("1/s", "Yaw rate", "body.yaw_rate"),
    "lateral_acceleration": ("m/s^2/rad", "Lateral acceleration", "accelerometer.lateral"),
}
"""Answers with units of their gains, words, and the channels they are read from."""


def measured_responses(signals: Signals, frequencies: NDArray[np.float64]) -> Responses:
    """Return answers over steering-wheel angle of a transient test at frequencies [Hz].

    Raises
    ------
    InputError
        If the test does not excite a frequency.
    """
    found: Responses = {}
    for name in ANSWERS:
        values = getattr(signals, name)
        response = transient_response(
            signals.time, signals.steering, values - values[0], frequencies=frequencies
        )
        found[name] = response.response
    return found


def response_sheet(frequencies: NDArray[np.float64], responses: Responses) -> Sheet:
    """Return gains and phases over frequency, columns of shape (n_frequencies,)."""
    sheet: Sheet = {"frequency": Column("Hz", "Frequency", frequencies)}
    for name, (unit, text, _) in ANSWERS.items():
        gain, phase = np.abs(responses[name]), np.unwrap(np.angle(responses[name]))
        words = f"{text} over steering-wheel angle"
        sheet[f"{name}_gain"] = Column(unit, words, gain)
        sheet[f"{name}_phase"] = Column("rad", f"{words}: phase", phase)
    return sheet
