"""Settings of drivers who want an angle of the front wheels, see the part that steers for them."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.road.drivers.driver import Driver


class SteeringDriver(Driver):
    """Base of drivers who want an angle of the front wheels and turn the rack towards it.

    The rack follows as a damped second-order system; with limits of its speed and acceleration,
    the latter that of a steering robot's torque, it is a robot.
    """

    lag_frequency: float = quantity("rad/s", "Bandwidth of hands or robot ω", gt=0)
    lag_damping: float = quantity("1", "Damping ratio of hands or robot ζ", gt=0)
    rack_stop: float = quantity("m", "Largest rack displacement", gt=0)
    rack_speed: float | None = quantity("m/s", "Largest rack speed", default=None, gt=0)
    rack_acceleration: float | None = quantity(
        "m/s^2", "Largest rack acceleration, of the torque's limit", default=None, gt=0
    )
