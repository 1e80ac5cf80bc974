"""Base of the standards' open-loop tests: steering, pedals and wind by time, all parameters.

All of them put the same parts into a vehicle and differ in numbers only, so that one kernel serves
them all; :meth:`DrivingTest.settings` gives the numbers of one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.parameters import field_unit, quantity
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Situation
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar

PREFIX = "test"


class DrivingTest(RoadManoeuvre):
    """Base of the open-loop tests; by itself it holds steering wheel and speed.

    Steering angles are those of the steering wheel, or of the front wheels where the vehicle has
    no ``steering_ratio``; they are positive to the left.
    """

    front_brake_share: float = quantity(
        "1", "Part of the brake torque at the front wheels", default=0.65, ge=0, le=1
    )

    def problems(self, *, free_wheels: bool) -> list[str]:
        """Return also that wheels of a given rate cannot be driven or braked."""
        found = super().problems(free_wheels=free_wheels)
        torques = self.drive_torque().values + self.brake_torque().values
        if not free_wheels and any(torques):
            found.append(
                "drive and brake torques need 'wheel_spin: free'; prescribed wheels keep their rate"
            )
        return found

    def steering(self) -> SteeringSignal:
        """Return the steering angle by time."""
        return SteeringSignal()

    def speed_change(self) -> TimeTable:
        """Return by how much the target speed differs from that of the start, by time [m/s]."""
        return TimeTable()

    def throttle(self) -> TimeTable:
        """Return the part of the speed control that acts, by time: 0 is a released throttle."""
        return TimeTable((0.0,), (1.0,))

    def drive_torque(self) -> TimeTable:
        """Return the drive torque beside that of the speed control, by time [N m]."""
        return TimeTable()

    def brake_torque(self) -> TimeTable:
        """Return the brake torque of all wheels together, by time [N m]."""
        return TimeTable()

    def side_wind(self) -> TimeTable:
        """Return the lateral force on the chassis, by time [N]."""
        return TimeTable()

    @property
    def wind_ahead(self) -> float:
        """Distance of that force ahead of the chassis's origin [m]."""
        return 0.0

    def settings(self) -> dict[str, float]:
        """Return the parameters of the test by name, which a kernel of any other test has too."""
        control = self.speed_control
        gains = (
            (0.0, 0.0) if control is None else (control.proportional_gain, control.integral_gain)
        )
        return {
            **dict(self.steering().settings(f"{PREFIX}.steering")),
            **dict(self.speed_change().settings(f"{PREFIX}.speed_change")),
            **dict(self.throttle().settings(f"{PREFIX}.throttle")),
            **dict(self.drive_torque().settings(f"{PREFIX}.drive_torque")),
            **dict(self.brake_torque().settings(f"{PREFIX}.brake_torque")),
            **dict(self.side_wind().settings(f"{PREFIX}.side_wind")),
            f"{PREFIX}.wind_ahead": self.wind_ahead,
            f"{PREFIX}.front_brake_share": self.front_brake_share,
            f"{PREFIX}.proportional_gain": gains[0],
            f"{PREFIX}.integral_gain": gains[1],
        }

    def settings_for(self, vehicle: RoadVehicle) -> dict[str, float]:
        """Return the parameters of the test on a vehicle, whose size may decide some."""
        return self.settings()

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with steering, pedals, wind and the sensors of the tests."""
        from vehicledyn.multibody.elements.drives import TimeLaw

        angle = self.steering().enter(vehicle.system.table, f"{PREFIX}.steering")
        per_rack = vehicle.steering_gain * vehicle.steering_ratio
        steer = TimeLaw("steer", vehicle.rack, lambda time: angle(time) / per_rack)
        return self.with_pedals(vehicle).with_parts(steer)

    def with_pedals(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with pedals, wind and the sensor of the steering, not yet steered."""
        from vehicledyn.road.manoeuvres.foot import Foot
        from vehicledyn.road.manoeuvres.pedals import Pedals
        from vehicledyn.road.manoeuvres.side_wind import SideWind
        from vehicledyn.road.manoeuvres.steering_angle import SteeringAngle

        table, numbers = vehicle.system.table, self.settings()

        def number(name: str, unit: str, text: str) -> Any:
            return table.add(f"{PREFIX}.{name}", numbers[f"{PREFIX}.{name}"], unit, text)

        def law(name: str, item: TimeTable, unit: str, text: str) -> Any:
            return item.enter(table, f"{PREFIX}.{name}", unit, text)

        change = law("speed_change", self.speed_change(), "m/s", "change of the target speed")
        throttle = law("throttle", self.throttle(), "1", "share of the speed control")
        torque = law("drive_torque", self.drive_torque(), "N*m", "drive torque")
        brake = law("brake_torque", self.brake_torque(), "N*m", "brake torque")
        force = law("side_wind", self.side_wind(), "N", "side wind")
        ahead = number("wind_ahead", "m", "Side wind ahead of the chassis's origin")
        share = number("front_brake_share", "1", "Part of the brake torque at the front wheels")
        gains = (
            number("proportional_gain", "N*s", "Drive torque a speed error"),
            number("integral_gain", "N", "Growth of torque a speed error"),
        )
        sensor = SteeringAngle(
            "steering_angle",
            vehicle.chassis,
            vehicle.rack,
            vehicle.steering_gain,
            vehicle.steering_ratio,
            vehicle.wheelbase,
        )
        wind = SideWind("wind", vehicle.chassis, force, ahead)
        if not vehicle.free_wheels:
            return vehicle.with_parts(wind, sensor)
        own = vehicle.brake
        target = self.target_speed(vehicle, change)
        braking = self.braking(vehicle, target) or (lambda seen: brake(seen.time))
        if own is not None:
            foot = Foot(own.switch, lambda seen: braking(seen) / own.torque)
            vehicle = vehicle.with_parts(foot)
        pedals = Pedals(
            "drive",
            vehicle.chassis,
            vehicle.corners,
            target,
            throttle,
            torque,
            braking if own is None else None,
            share,
            *gains,
            vehicle.drive,
            vehicle.throttle is not None,
            self.brakes_to_rest(),
        )
        pedal = vehicle.throttle
        if pedal is not None:
            foot = Foot(pedal.switch, lambda seen: pedals.wanted(seen) / pedal.torque)
            vehicle = vehicle.with_parts(foot)
        return vehicle.with_parts(pedals, wind, sensor)

    def target_speed(
        self, vehicle: RoadVehicle, change: Callable[[Scalar], Scalar]
    ) -> Callable[[Situation], Scalar]:
        """Return the speed that is held, as a function of the motion [m/s]."""
        return lambda seen: vehicle.speed + change(seen.time)

    def braking(
        self, vehicle: RoadVehicle, target: Callable[[Situation], Scalar]
    ) -> Callable[[Situation], Scalar] | None:
        """Return a brake torque by the motion in place of that by time, or None [N m]."""
        return None

    def brakes_to_rest(self) -> bool:
        """Return whether the test brakes by time, so that the car may stop and must stand then."""
        return any(self.brake_torque().values)

    def input_at(self) -> float | None:
        """Return when the test's input begins [s], None where that is no time."""
        for name in ("brake_at", "release_at", "begin"):
            if name in type(self).model_fields and field_unit(type(self), name) == "s":
                return float(getattr(self, name))
        return None

    def holds_speed(self) -> bool:
        """Return whether the test keeps the speed of its start."""
        changes = *self.speed_change().values, *self.drive_torque().values
        is_held = self.speed_control is not None and all(self.throttle().values)
        return is_held and not any((*changes, *self.brake_torque().values))

    def conditions(self, signals: Signals) -> list[str]:
        """Return where the test leaves the conditions of ISO 15037-1, one sentence each."""
        from vehicledyn.road.standards.conditions import speed_remarks, start_remarks

        at = self.input_at()
        found = [] if at is None else list(start_remarks(signals, at))
        if self.holds_speed():
            found.extend(speed_remarks(signals))
        return found

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return the channels of the test's quantities and of the general key figures."""
        from vehicledyn.road.standards.signals import signal_channels

        own = signal_channels(vehicle.chassis)
        return list(dict.fromkeys([*own, *super().channels(vehicle)]))

    def summarise(self, recording: Recording, vehicle: RoadVehicle) -> list[SummaryEntry]:
        """Return the quantities of the test's standard and the general key figures.

        A single sample has no quantities.
        """
        from vehicledyn.road.standards.signals import Signals

        general = super().summarise(recording, vehicle)
        if recording.count < 2:
            return general
        signals = Signals.of(recording.time[:], recording.channels, vehicle.chassis)
        entries = [*self.quantities(signals, recording, vehicle), *general]
        remarks = "; ".join(self.conditions(signals))
        if remarks:
            words = "Departures from the conditions of ISO 15037-1"
            entries.extend(entry("test_conditions", remarks, "", words))
        return entries

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield the quantities of the test's standard."""
        yield from ()
