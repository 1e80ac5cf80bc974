"""One driving test of a car, from a steady motion, in memory."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from vehicledyn.analyses.handling.tested_car import CarPoint, TestedCar
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.integrate.simulate import simulate
from vehicledyn.results.tables.columns import Column
from vehicledyn.results.tables.handling_table import TRUTH, KeyFigure, Sheet
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.standards.signals import Signals

INTERVAL, STEP = 0.01, 1e-3
"""Distance of samples and step [s]."""


@dataclass(frozen=True)
class DriveRecord:
    """Times [s], channels of shape (n_times, n_channels), and what ended the test early."""

    times: np.ndarray
    outputs: np.ndarray
    ended_by: str


@dataclass(frozen=True)
class DrivenTest:
    """What a test recorded; ``ended_by`` names what ended it early, such as "overturned"."""

    test: DrivingTest
    recording: Recording
    signals: Signals
    ended_by: str = ""

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return float(self.signals.time[-1])

    def note(self) -> str:
        """Return where and when the car was lost, empty if it was not."""
        if not self.ended_by:
            return ""
        place = f"x = {self.signals.x[-1]:.4g} m, y = {self.signals.y[-1]:.4g} m"
        return f"{self.ended_by} at t = {self.end:.4g} s, {place}"


@dataclass
class _Samples:
    times: list[np.ndarray] = field(default_factory=list)
    outputs: list[np.ndarray] = field(default_factory=list)

    def take(self, t: np.ndarray, x: np.ndarray, z: np.ndarray, y: np.ndarray) -> None:
        self.times.append(t.copy())
        self.outputs.append(y.copy())


def drive(
    car: TestedCar,
    test: DrivingTest,
    start: CarPoint,
    duration: float,
    changes: dict[str, float] | None = None,
) -> DrivenTest:
    """Return what a test records that starts from a steady motion.

    Parameters
    ----------
    car
        The car; its kernel runs every open-loop test.
    test
        The test, whose numbers become the kernel's parameters.
    start
        Where it starts.
    duration
        How long it takes [s].
    changes
        Further parameters by name.

    A run that cannot go on, as after a roll-over, keeps what it recorded.
    """
    car.kernel.set_parameters(start.parameters)
    car.set({**test.settings_for(car.vehicle), **(changes or {})})
    whole = round(duration / INTERVAL) * INTERVAL
    given = car.digest, car.kernel.parameters, start.state, start.unknowns, whole
    driven = car.memory.recall("drive", given, lambda: _driven(car, start, whole))
    channels = {name: driven.outputs[:, k] for name, k in car.channel.items()}
    recording = Recording(driven.times, channels)
    signals = Signals.of(driven.times, channels, car.vehicle.chassis)
    return DrivenTest(test, recording, signals, driven.ended_by)


def _driven(car: TestedCar, start: CarPoint, duration: float) -> DriveRecord:
    """Return what the car does from its start with the parameters that are set."""
    samples, ended_by = _Samples(), ""
    try:
        statistics = simulate(
            car.kernel,
            find("solver", "rk4")(step=STEP),
            start=0.0,
            stop=duration,
            state=start.state,
            unknowns=start.unknowns,
            interval=INTERVAL,
            sink=samples.take,
            watched=False,
        )
        ended_by = statistics.ended_by or ""
    except NumericalError as error:
        ended_by = str(error)
    return DriveRecord(np.concatenate(samples.times), np.vstack(samples.outputs), ended_by)


def figures_of(car: TestedCar, name: str, run: DrivenTest) -> list[KeyFigure]:
    """Return the quantities of a test's standard."""
    return [
        KeyFigure(
            name,
            entry.name,
            float(entry.value),
            TRUTH if isinstance(entry.value, bool) else entry.unit,
            entry.description,
        )
        for entry in run.test.quantities(run.signals, run.recording, car.vehicle)
        if not isinstance(entry.value, str)
    ]


def sheet_of(run: DrivenTest) -> Sheet:
    """Return the signals of a test by time."""
    return {
        name: Column(unit, text, getattr(run.signals, name)) for name, (unit, text) in SHOWN.items()
    }


SHOWN = {
    "time": ("s", "Time"),
    "steering": ("rad", "Steering-wheel angle"),
    "yaw_rate": ("rad/s", "Yaw rate"),
    "lateral_acceleration": ("m/s^2", "Lateral acceleration"),
    "sideslip": ("rad", "Side-slip angle"),
    "roll": ("rad", "Roll angle"),
    "forward_speed": ("m/s", "Forward speed"),
    "x": ("m", "Position x"),
    "y": ("m", "Position y"),
}
"""Signals that a sheet of a test holds."""
