"""Measured run: a car is driven again by the steering, speed and brakes of a table of time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field, model_validator

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.base.units import shown
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Situation
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.manoeuvres.channel_recorder import Recording
    from vehicledyn.road.manoeuvres.run_record import RunRecord
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar

_COMPARED = {
    "speed": ("forward_speed", "m/s", "forward speed"),
    "yaw_rate": ("yaw_rate", "rad/s", "yaw rate"),
    "lateral_acceleration": ("lateral_acceleration", "m/s^2", "lateral acceleration"),
    "longitudinal_acceleration": ("longitudinal_acceleration", "m/s^2", "acceleration along"),
    "sideslip_angle": ("sideslip", "rad", "side-slip angle"),
    "roll_angle": ("roll", "rad", "roll angle"),
}
"""Measured signals that a run is compared with: the signal of the run, unit and words."""

_SPEED_APART = 2.0 / 3.6
_LATE = 1e-6


@register("manoeuvre", "measured_run")
class MeasuredRun(DrivingTest):
    """Drive as a measured car was driven, by a CSV file of time whose head states units.

    Columns are ``time`` and any of ``steering_wheel_angle`` or ``road_wheel_angle`` (of the front
    wheels), which the car has exactly; ``brake_torque`` of all wheels together; ``speed``, held
    by the ``speed_control`` or by a towing force at the chassis's origin where one is given. The
    run is compared with ``speed`` and any of ``yaw_rate``, ``lateral_acceleration``,
    ``longitudinal_acceleration``, ``sideslip_angle`` and ``roll_angle``: the summary has the rms
    and the largest difference. Straight lines join the samples; outside of them the first and the
    last value are held. Further columns are passed over.
    """

    file: str = Field(description="CSV file of the run, in the scenario's folder")
    begin: float = quantity("s", "Time of the record at which the run begins", default=0.0)
    towing_gain: float | None = quantity(
        "N*s/m", "Towing force over the error of speed; none without", default=None, gt=0
    )

    @model_validator(mode="after")
    def _has_one_drive(self) -> MeasuredRun:
        """Refuse two that hold the speed."""
        if self.towing_gain is not None and self.speed_control is not None:
            raise ValueError(
                "towing_gain: leave it or speed_control out; one of them holds the speed"
            )
        return self

    def placed(self, folder: Path) -> MeasuredRun:
        """Return the same run, its file looked for in a folder."""
        return self.model_copy(update={"file": str(folder / self.file)})

    def problems_beside(self, folder: Path) -> list[str]:
        """Return what is wrong with the file, one line each."""
        try:
            _ = self.placed(folder).record
        except InputError as error:
            lines = str(error).splitlines()
            return lines[:-1] if len(lines) > 1 else lines
        return []

    @property
    def record(self) -> RunRecord:
        """What was measured.

        Raises
        ------
        InputError
            If the file cannot be read.
        """
        from vehicledyn.road.manoeuvres.run_record import read_record

        return read_record(Path(self.file), self.begin)

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with steering, pedals and towing force by the record."""
        from vehicledyn.multibody.elements.drives import TimeLaw
        from vehicledyn.road.manoeuvres.robot import Towing

        record, per_rack = self.record, vehicle.steering_gain
        if "road_wheel_angle" in record.curves:
            angle = record.law("road_wheel_angle")
        else:
            angle, per_rack = record.law("steering_wheel_angle"), per_rack * vehicle.steering_ratio
        steer = TimeLaw("steer", vehicle.rack, lambda time: angle(time) / per_rack)
        found = self.with_pedals(vehicle).with_parts(steer)
        if self.towing_gain is None:
            return found
        gain = vehicle.system.table.add(
            "record.towing_gain", self.towing_gain, "N*s/m", "Towing force over the error of speed"
        )
        target = self.target_speed(vehicle, lambda _: 0.0)
        return found.with_parts(Towing("towing", vehicle.chassis, target, gain))

    def target_speed(
        self, vehicle: RoadVehicle, change: Callable[[Scalar], Scalar]
    ) -> Callable[[Situation], Scalar]:
        """Return the measured speed; that of the start before the run and where none is [m/s].

        A start is balanced before the run, at rest where it is static: nothing drives there.
        """
        from vehicledyn.symbolic import ops

        if "speed" not in self.record.curves:
            return super().target_speed(vehicle, change)
        speed = self.record.law("speed")
        return lambda seen: ops.where(seen.time < 0.0, vehicle.speed, speed(seen.time))

    def braking(
        self, vehicle: RoadVehicle, target: Callable[[Situation], Scalar]
    ) -> Callable[[Situation], Scalar] | None:
        """Return the measured brake torque, if there is one [N m]."""
        if "brake_torque" not in self.record.curves:
            return None
        torque = self.record.law("brake_torque")
        return lambda seen: torque(seen.time)

    def holds_speed(self) -> bool:
        """Return whether the run keeps the speed of its start."""
        names = self.record.curves
        return super().holds_speed() and not {"speed", "brake_torque"} & set(names)

    def input_at(self) -> float | None:
        """Return that the input begins at no certain time."""
        return None

    def conditions(self, signals: Signals) -> list[str]:
        """Return also where the run starts at another speed than the record, or outlasts it."""
        found, record = super().conditions(signals), self.record
        if float(signals.time[-1]) > record.last + _LATE:
            words = f"the record ends {shown(record.last, 's')} after its begin"
            found.append(f"{words}; from there the run holds its last values")
        if "speed" in record.curves:
            measured, own = record.value("speed", 0.0), float(signals.forward_speed[0])
            if abs(own - measured) > _SPEED_APART:
                words = shown(measured, "m/s")
                found.append(f"the run starts at {shown(own, 'm/s')}, the record at {words}")
        return found

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield how far the run is from each measured signal, and from the measured way."""
        import numpy as np

        record = self.record
        for name, (times, _) in record.curves.items():
            within = (signals.time >= times[0]) & (signals.time <= times[-1])
            if name not in _COMPARED or not within.any():
                continue
            time = signals.time[within]
            attribute, unit, words = _COMPARED[name]
            apart = getattr(signals, attribute)[within] - record.values(name, time)
            rms = float(np.sqrt(np.mean(apart**2)))
            yield from entry(f"{name}_rms_apart", rms, unit, f"Rms of the {words} less measured")
            largest = float(np.abs(apart).max())
            text = f"Largest difference of the {words} from measured"
            yield from entry(f"{name}_largest_apart", largest, unit, text)
            if name == "speed":
                text = "Way of the run less the integral of the measured speed"
                yield from entry("way_apart", float(np.trapezoid(apart, time)), "m", text)
