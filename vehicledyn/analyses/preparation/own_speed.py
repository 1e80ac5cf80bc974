"""Reads a system again at another value of one of its parameters, such as its speed."""

from __future__ import annotations

from vehicledyn.analyses.preparation.prepared import Derived
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario.target import Target

_NAME = "speed"


def at_speed(target: Target, speed: float | None) -> tuple[Target, float | None]:
    """Return a target at a speed, and the speed it has.

    Start rates and further parameters of a system may be calculated from its parameter "speed",
    so the system is read again with that changed. Vehicles, and systems without such a parameter,
    are returned as they are, with the speed as it is.

    Parameters
    ----------
    target
        A scenario or a model.
    speed
        Forward speed [m/s]; None for the target's own.

    Raises
    ------
    InputError
        If the file cannot be read any more, or the parameter may not have this value.
    """
    own = own_speed(target)
    if own is None:
        return target, speed
    if speed is None or speed == own:
        return target, own
    return at_value(target, _NAME, speed, "m/s"), speed


def at_value(target: Target, name: str, value: float, unit: str) -> Target:
    """Return a target whose system is read again with another value of a parameter.

    What its file calculates from the parameter follows: further parameters, start coordinates and
    start rates.

    Parameters
    ----------
    target
        A scenario or a model that has a system file.
    name, value, unit
        The parameter, its value in SI, and its SI unit.

    Raises
    ------
    InputError
        If the file cannot be read any more, or the parameter may not have this value.
    """
    change = f"parameters.{name}={float(value)!r}" + ("" if unit in ("", "1") else f" {unit}")
    return target.with_overrides((change,))


def own_speed(target: Target) -> float | None:
    """Return the parameter "speed" [m/s] of a system that drives no manoeuvre, None without one."""
    written = target.written
    if written.file is None or written.is_vehicle or written.units.get(_NAME) != "m/s":
        return None
    return written.resolved.get(_NAME)


def speed_matters(subject: Subject) -> bool:
    """Return whether a speed says something about a model."""
    return bool(subject.parameters_at(1.0))


def refuse_idle_speed(derived: Derived) -> None:
    """Raise InputError if a speed that was given says nothing about a system."""
    if not speed_matters(derived.subject):
        raise InputError(
            f"{argument('speed')}: nothing in '{derived.subject.system.name}' depends on a "
            "speed of this name; "
            "set the parameter or the start rate that says how fast it moves"
        )
