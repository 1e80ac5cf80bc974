"""Base of tests that end in transfer functions from the steering wheel (ISO 7401)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle

FREQUENCIES = tuple(0.2 + 0.05 * k for k in range(37))
"""Frequencies of the response [Hz]."""

_SHOWN = (0.2, 0.5, 1.0, 2.0)
_ANSWERS = {
    "yaw_rate": ("Yaw rate", "1/s"),
    "lateral_acceleration": ("Lateral acceleration", "m/s^2/rad"),
}


class FrequencyTest(DrivingTest):
    """Base: the summary has gains and phases at 0.2, 0.5, 1 and 2 Hz, the peak, and the bandwidth.

    The bandwidth is where the gain of the yaw rate is 3 dB below that at 0.2 Hz.
    """

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Steering and answers"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield gains, phases, peak and bandwidth."""
        import numpy as np

        from vehicledyn.road.standards.frequency_response import transient_response

        frequencies = np.array(FREQUENCIES)
        for name, (text, unit) in _ANSWERS.items():
            try:
                found = transient_response(
                    signals.time, signals.steering, getattr(signals, name), frequencies=frequencies
                )
            except InputError:
                return
            for frequency in _SHOWN:
                k = int(np.argmin(np.abs(frequencies - frequency)))
                label = f"{frequency:g}".replace(".", "_")
                words = f"{text} over steering angle at {frequency:g} Hz"
                yield from entry(f"{name}_gain_{label}_hz", found.magnitude[k], unit, words)
                words = f"{text}: phase before the steering angle at {frequency:g} Hz"
                yield from entry(f"{name}_phase_{label}_hz", found.phase[k], "rad", words)
            if name == "yaw_rate":
                words = "Frequency of the largest gain of the yaw rate"
                yield from entry("peak_frequency", found.peak_frequency, "Hz", words)
                ratio = float(found.magnitude.max() / found.magnitude[0])
                words = "Largest gain of the yaw rate over that at 0.2 Hz"
                yield from entry("peak_ratio", ratio, "1", words)
                words = "Frequency at which the gain of the yaw rate has fallen by 3 dB"
                yield from entry("bandwidth", found.bandwidth(found.magnitude[0]), "Hz", words)
