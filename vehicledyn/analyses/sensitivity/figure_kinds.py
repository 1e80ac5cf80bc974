"""What a figure is of, read from its name."""

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

_RESPONSE = re.compile(r"(gain|phase|real|imaginary|peak_gain|peak_frequency)\(.*\)")


def is_linear(name: str) -> bool:
    """Return whether a name asks for a figure of the linearised model."""
    return name in (EIGENVALUES, CRITICAL) or name.startswith(BALANCE) or is_mode_shape(name)


def is_mode_shape(name: str) -> bool:
    """Return whether a name asks for mode shapes, of all states or of those of a pattern."""
    return name == MODE_SHAPES or name.startswith(f"{MODE_SHAPES}.")


def is_cycle(name: str) -> bool:
    """Return whether a name asks for a figure of limit cycles."""
    return name == NONLINEAR or name in WHOLE or CYCLE_FIGURE.fullmatch(name) is not None


def is_response(name: str) -> bool:
    """Return whether a name asks for a frequency response, such as ``gain(y, u, 2 Hz)``."""
    return _RESPONSE.fullmatch(name) is not None and "," in name
