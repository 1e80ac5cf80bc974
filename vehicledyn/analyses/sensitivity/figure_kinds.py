"""Which analysis a figure belongs to, told from its name, so that only that analysis is loaded."""

from __future__ import annotations

import re

EIGENVALUES, CRITICAL, BALANCE = "eigenvalues", "critical_speed", "equilibrium."
MODE_SHAPES = "mode_shapes"
NONLINEAR = "nonlinear_critical_speed"
WHOLE = ("cycle_period", "cycle_frequency")
CYCLE_WORDS = {
    "cycle_amplitude": "Half the range of {}",
    "cycle_max": "Maximum of {}",
    "cycle_min": "Minimum of {}",
    "cycle_mean": "Mean of {}",
    "cycle_rms": "Root mean square of {}",
}
CYCLE_FIGURE = re.compile(rf"({'|'.join(CYCLE_WORDS)})\((.+)\)")

_KINEMATIC = re.compile(r"kinematics\(.*\)")
_INVERSE = re.compile(r"inverse\(.*\)")
_RESPONSE = re.compile(r"(gain|phase|peak_gain|peak_frequency)\(.*\)")


def is_linear(name: str) -> bool:
    """Return whether a name asks for a figure of the linearised model."""
    return name in (EIGENVALUES, CRITICAL) or name.startswith(BALANCE) or is_mode_shape(name)


def is_mode_shape(name: str) -> bool:
    """Return whether a name asks for mode shapes, of all states or of those of a pattern."""
    return name == MODE_SHAPES or name.startswith(f"{MODE_SHAPES}.")


def is_cycle(name: str) -> bool:
    """Return whether a name asks for a figure of limit cycles."""
    return name == NONLINEAR or name in WHOLE or CYCLE_FIGURE.fullmatch(name) is not None


def is_kinematic(name: str) -> bool:
    """Return whether a name asks for a kinematic curve, ``kinematics(CHANNEL, DRIVE, VALUES)``."""
    return _KINEMATIC.fullmatch(name) is not None


def is_inverse(name: str) -> bool:
    """Return whether a name asks for inverse dynamics, ``inverse(CHANNEL)``."""
    return _INVERSE.fullmatch(name) is not None


def is_response(name: str) -> bool:
    """Return whether a name asks for a frequency response, such as ``gain(y, u, 2 Hz)``."""
    return _RESPONSE.fullmatch(name) is not None and "," in name


def analysis_of(name: str) -> str:
    """Return the analysis a name belongs to.

    "linear", "response", "cycle", "kinematic", "inverse" or, for all others, "run".

    >>> analysis_of("inverse(crank.angle_force)"), analysis_of("max(chassis.roll)")
    ('inverse', 'run')
    """
    known = {
        "linear": is_linear,
        "response": is_response,
        "cycle": is_cycle,
        "kinematic": is_kinematic,
        "inverse": is_inverse,
    }
    return next((kind for kind, is_one in known.items() if is_one(name)), "run")
