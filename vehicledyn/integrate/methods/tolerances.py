"""Settings that methods share: tolerances, which rounding bounds from below, and fixed steps."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from vehicledyn.base.parameters import quantity

SMALLEST_RELATIVE = 3e-14
"""About a hundred units of rounding: what a step of several stages can hold [1]."""

SMALLEST_ABSOLUTE = 1e-16
"""About the rounding of a state of order one, in the state's own unit."""


def relative_tolerance() -> Any:
    """Declare the local error allowed for each state, as a part of its value."""
    text = "Local error allowed for each state, part of its value"
    return quantity("1", text, ge=SMALLEST_RELATIVE, lt=1)


def absolute_tolerance() -> Any:
    """Declare the local error allowed for each state in its own unit."""
    text = "Local error allowed for each state, in its own unit"
    return quantity("1", text, ge=SMALLEST_ABSOLUTE)


def fixed_step() -> Any:
    """Declare the step of a method, which may be left to the program."""
    text = "Step size; divides the sampling interval; chosen from the model's start if left out"
    return quantity("s", text, default=None, gt=0)


def required_step() -> Any:
    """Declare the step of an implicit method, which stability does not bound."""
    return quantity("s", "Step size; divides the sampling interval", gt=0)


def how_constraints_are_met() -> Any:
    """Declare how the steps of an implicit method treat constraints."""
    text = (
        "How loops close: 'reduced' within the accelerations, 'index3' by multipliers of each "
        "step, 'stabilised_index2' by these and multipliers of the velocities; the last two need "
        "a system with 'constraint_method: multipliers', or without loops"
    )
    return Field(default="reduced", description=text)


def shown_velocities() -> Any:
    """Declare which velocities and multipliers steps with multipliers show."""
    text = (
        "What results show with 'index3' or 'stabilised_index2': the method's 'own' velocities, "
        "accelerations and multipliers, or those of the nearest motion on the constraints, "
        "'projected'"
    )
    return Field(default="own", description=text)


def local_tolerance() -> Any:
    """Declare the local error that shortens the steps of an implicit method."""
    text = (
        "Local error allowed for each state, for one plus its size; halves steps from 'step' on; "
        "steps of one size if left out"
    )
    return quantity("1", text, default=None, ge=SMALLEST_RELATIVE, lt=1)
