"""Names that ask for derivatives of steady cornering: ``steady(QUANTITY, METHOD, VALUES)``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from vehicledyn.analyses.handling.circle import QUANTITIES
from vehicledyn.analyses.handling.response_sheets import ANSWERS
from vehicledyn.analyses.handling.steady import GRADIENTS, SteadyRequest
from vehicledyn.analyses.handling.turn_slopes import TURNED
from vehicledyn.analyses.sensitivity.called import called_parts
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.ranges import read_range
from vehicledyn.base.units import shown, to_si

LIMIT, EIGENVALUES, YAW_ACCELERATION = "limit", "eigenvalues", "yaw_acceleration"
BRAKING, DRIVING = "braking", "driving"
LINES = {name: (quantity, words) for quantity, name, words in GRADIENTS}
"""Gradients: the quantity of each, and what it means."""

PHASE = "_phase"
_RESPONSES = tuple(f"{name}{kind}" for name in ANSWERS for kind in ("_gain", PHASE))
_TOWN = 80.0 / 3.6
_FORM = "steady(QUANTITY, METHOD, VALUES), such as steady(limit, constant_speed, speed=80 km/h)"

_SPEED: dict[str, tuple[str, float | None]] = {"speed": ("m/s", SteadyRequest.speed)}
_LATERAL = "m/s^2", "lateral accelerations, such as 4 m/s^2"


@dataclass(frozen=True)
class SteadyMethod:
    """A test: the quantities at its values and those of the whole, and its settings.

    ``unit`` is that of its values, ``words`` what they are; ``settings`` are units and usual
    values, None where it follows from the car; ``is_signed`` says whether values may be negative.
    """

    unit: str
    words: str
    quantities: tuple[str, ...]
    whole: tuple[str, ...]
    settings: Mapping[str, tuple[str, float | None]]
    is_signed: bool = False


METHODS = {
    "constant_speed": SteadyMethod(*_LATERAL, (*QUANTITIES, EIGENVALUES), (*LINES, LIMIT), _SPEED),
    "constant_radius": SteadyMethod(
        *_LATERAL, tuple(QUANTITIES), (*LINES, LIMIT), {"radius": ("m", SteadyRequest.radius)}
    ),
    "constant_steering": SteadyMethod(
        "m/s",
        "speeds, such as 80 km/h",
        tuple(QUANTITIES),
        tuple(LINES),
        {"steering": ("rad", None), **_SPEED},
    ),
    "response": SteadyMethod(
        "Hz", "frequencies, such as 1 Hz", _RESPONSES, (), {"speed": ("m/s", _TOWN)}
    ),
    "yaw_moments": SteadyMethod(
        "rad",
        "side-slip angles, such as 4 deg",
        (YAW_ACCELERATION, *TURNED),
        (),
        {"steering": ("rad", 0.0), **_SPEED},
        is_signed=True,
    ),
    "acceleration_limits": SteadyMethod(
        "m/s^2",
        "accelerations along the path, such as -4 m/s^2",
        (LIMIT,),
        (BRAKING, DRIVING),
        _SPEED,
        is_signed=True,
    ),
}
"""Tests by name."""


@dataclass(frozen=True)
class Asked:
    """What a name asks for: a quantity of a method, at values or of the whole if there are none.

    ``given`` are the settings; None for the steering-wheel angle of the test at constant speed.
    """

    quantity: str
    method: str
    values: tuple[float, ...]
    given: Mapping[str, float | None]

    def of(self, setting: str) -> float:
        """Return a setting that has a value."""
        return float(self.given[setting] or 0.0)

    @property
    def where(self) -> str:
        """The method and its settings, as a person reads them."""
        settings = METHODS[self.method].settings
        method = self.method.replace("_", " ")
        if self.method == "constant_steering" and self.given["steering"] is None:
            return f"{method}, that at 4 m/s^2 and {shown(self.given['speed'] or 0.0, 'm/s')}"
        first, *others = [
            (name, shown(value, settings[name][0]))
            for name, value in self.given.items()
            if value is not None and not (name == "speed" and self.method == "constant_steering")
        ]
        text = f"{method} of {first[1]}" if first[0] in method else f"{method}, {' '.join(first)}"
        return ", ".join([text, *(f"{name} {value}" for name, value in others)])

    def at(self, value: float) -> str:
        """Return the name of the figure at a value."""
        return f"{self.quantity} at {shown(value, METHODS[self.method].unit)}, {self.where}"


def parsed(name: str) -> Asked:
    """Return what a name asks for.

    Raises
    ------
    InputError
        If a part is missing or means nothing.
    """
    settings = list(dict.fromkeys(key for method in METHODS.values() for key in method.settings))
    parts, options = called_parts(name, _FORM, (2, 3), settings)
    quantity, method = parts[:2]
    if method not in METHODS:
        raise InputError(f"'{name}': {unknown_name('method', method, METHODS)}")
    own = METHODS[method]
    known = list(dict.fromkeys([*own.quantities, *own.whole]))
    if quantity not in known:
        raise InputError(f"'{name}': {unknown_name('quantity', quantity, known)}")
    if len(parts) > 2 and quantity not in own.quantities:
        raise InputError(f"'{name}': {quantity} is of the whole curve: give no values")
    if len(parts) < 3 and quantity not in own.whole:
        raise InputError(f"'{name}': {quantity} needs {own.words}")
    wrong = [key for key in options if key not in own.settings]
    if wrong:
        raise InputError(f"'{name}': {unknown_name('setting', wrong[0], own.settings)}")
    try:
        given = {
            key: float(to_si(options[key], unit)) if key in options else usual
            for key, (unit, usual) in own.settings.items()
        }
        values = read_range(parts[2]).values(own.unit) if len(parts) > 2 else ()
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None
    for key in ("speed", "radius"):
        if key in given and not (given[key] or 0.0) > 0.0:
            raise InputError(f"'{name}': {key} must be above zero")
    if not own.is_signed and min(values, default=1.0) <= 0.0:
        raise InputError(f"'{name}': {own.words.partition(',')[0]} must be above zero")
    return Asked(quantity, method, values, given)
