"""Derivatives of kinematic curves: channels of a mechanism at places of a drive, by parameters.

With the rows g(q, s, p) = 0 of loops and drives, coordinates q that move and s that stay at their
start, dq/dp = -(∂g/∂q)⁻¹ (∂g/∂p + ∂g/∂s ds/dp), and of a channel y(q, s, p)

    dy/dp = ∂y/∂p + ∂y/∂s ds/dp + ∂y/∂q dq/dp

A velocity ratio r = ∂y/∂q t, with the tangent t of the path from ∂g/∂q t = e, follows alike:
dr/dp = d(∂y/∂q)/dp t - ∂y/∂q (∂g/∂q)⁻¹ d(∂g/∂q)/dp t, the matrices moving with q, s and p.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.continuation import SingularPlace, Way
from vehicledyn.analyses.mechanism.driven_mechanism import Mechanism, mechanism
from vehicledyn.analyses.mechanism.kinematics import ratio_channel
from vehicledyn.analyses.mechanism.mechanism_path import Drive, run_sweep
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.names import matching
from vehicledyn.base.errors import InputError, NumericalError, unknown_name
from vehicledyn.base.ranges import read_range
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown
from vehicledyn.files.scenario.target import Target
from vehicledyn.multibody.loops.position_level import Positions
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

Floats = NDArray[np.float64]

_NAME = re.compile(r"kinematics\(([^,]+),([^,]+),([^,]+)\)")
_SINGULAR = 1e-10
"""Part of the largest singular value of the rows below which a place is singular."""


KINDS = Way, SingularPlace
"""Results of steps that a memory knows."""


def find_kinematic_sensitivity(
    target: Target, of: Sequence[str], to: Sequence[str], progress: Progress, *, memory: Memory
) -> SensitivityTable:
    """Return derivatives of channels at places of a drive; all else stays at its start.

    Parameters
    ----------
    target
        A scenario or model.
    of
        Names such as ``kinematics(wheel.toe, wheel.height, -60 mm:60 mm:4)``.
    to
        Patterns of parameters.
    progress
        Called with what is going on.
    memory
        Knows places and slopes, of :data:`KINDS`.

    Raises
    ------
    InputError
        If a name or range means nothing.
    NumericalError
        If a place is singular or cannot be reached.
    """
    asked = [_parsed(name) for name in of]
    progress("assembling the loops", None)
    system = build_subject(target).system
    positions = Positions(system)
    chosen = matching([entry.name for entry in positions.parameters], to, system.name)
    figures, values, slopes = [], [], []
    for (channel, drive, text), name in zip(asked, of, strict=True):
        machine, places = _driven(positions, drive, text, name)
        row, is_ratio = _place(positions, channel, drive, name)
        path = [Drive(drive, places)]
        swept = run_sweep(machine, path, together=False, progress=progress, memory=memory)
        if swept.failures:
            raise NumericalError(swept.failures[0].words)
        for sample, place in zip(swept.samples, places, strict=True):
            own, item = positions.channels[machine.drives[0]], positions.channels[row]
            figure = f"{channel} at {drive} = {shown(place, own.unit)}"
            about = ratio_channel(own, item) if is_ratio else item
            figures.append(Quantity(figure, about.unit, about.description))
            values.append(float(sample.ratios[0, row] if is_ratio else sample.values[row]))
            given = drive, sample.coordinates, row, is_ratio
            found = partial(_slope, machine, *given[1:])
            slopes.append(memory.recall_or_raise("slope", given, found)[chosen])
    entries = [positions.parameters[k] for k in chosen]
    return SensitivityTable(
        target.title,
        system.name,
        tuple(Quantity(e.name, e.unit, e.description) for e in entries),
        np.array([e.value for e in entries]),
        tuple(figures),
        np.array(values),
        np.array(slopes),
    )


_RATIO = "ratio."
_OF_RATIOS = "instant.", "swing.", "roll_centre.", "motion_ratio."


def _place(positions: Positions, channel: str, drive: str, name: str) -> tuple[int, bool]:
    """Return the number of a channel, and whether its velocity ratio along the drive is meant."""
    names = [c.name for c in positions.channels]
    is_ratio = channel.startswith(f"{_RATIO}{drive}.")
    own = channel.removeprefix(f"{_RATIO}{drive}.") if is_ratio else channel
    if own in names:
        return names.index(own), is_ratio
    speeds = [c.name for c in positions.speeds]
    why = ""
    if is_ratio and own in speeds:
        why = "ratios of velocities have no derivatives here; those of positions do"
    elif channel.startswith(_OF_RATIOS):
        why = f"it is drawn from several velocity ratios; ask for these, as {_RATIO}{drive}.CHANNEL"
    elif channel.startswith(_RATIO) and not is_ratio:
        why = f"velocity ratios are those along the drive, {_RATIO}{drive}.CHANNEL"
    raise InputError(f"'{name}': {why or unknown_name('channel of positions', own, names)}")


def _slope(machine: Mechanism, q: Floats, row: int, is_ratio: bool) -> Floats:
    """Return the derivative of a channel or its ratio by all parameters, (n_parameters,).

    Raises
    ------
    NumericalError
        If the place is singular, or an undetermined coordinate takes part in the loops.
    """
    positions, moving = machine.positions, list(machine.moving)
    rows = machine.equations.jacobian(q[moving])
    sizes = np.linalg.svd(rows, compute_uv=False)
    if len(sizes) < len(moving) or sizes[-1] <= _SINGULAR * sizes[0]:
        raise NumericalError("the place is singular, so no derivative exists there")
    gaps = positions.jacobian(q)
    for k, coordinate in enumerate(positions.coordinates):
        if k not in moving and coordinate.role in ("auto", "dependent") and gaps[:, k].any():
            raise NumericalError(
                f"'{coordinate.name}' is in the loops but neither they nor the drive determine "
                "it; declare it independent or driven, so that its start is given"
            )
    started = positions.start_by_parameter.copy()
    started[moving] = 0.0
    slopes = positions.slopes(q)
    by_parameter = positions.values_by_parameter(q) + slopes @ started
    driven = by_parameter[list(machine.drives)]
    moved = np.vstack([positions.residual_by_parameter(q) + gaps @ started, driven])
    follow = np.asarray(-np.linalg.lstsq(rows, moved, rcond=None)[0], dtype=float)
    if not is_ratio:
        found = by_parameter[row] + slopes[row, moving] @ follow
        return np.asarray(found, dtype=float)
    everything = started.copy()
    everything[moving] = follow
    return _ratio_slope(machine, q, row, rows, everything)


def _ratio_slope(
    machine: Mechanism, q: Floats, row: int, rows: Floats, by_parameter: Floats
) -> Floats:
    """Return the derivative of a channel's velocity ratio along the drive by all parameters.

    ``rows`` are derivatives of loops and drives by the moving coordinates, ``by_parameter`` those
    of all coordinates (n_coordinates, n_parameters).
    """
    positions, moving = machine.positions, list(machine.moving)
    tangent = np.zeros(len(q))
    unit = np.zeros(len(rows))
    unit[machine.gaps] = 1.0
    tangent[moving] = np.linalg.lstsq(rows, unit, rcond=None)[0]
    by_coordinate, direct = positions.slopes_along(q, tangent)
    turned = by_coordinate @ by_parameter + direct
    gaps, channels = turned[: machine.gaps], turned[machine.gaps :]
    right = np.vstack([gaps, channels[list(machine.drives)]])
    turning = -np.linalg.lstsq(rows, right, rcond=None)[0]
    found = channels[row] + positions.slopes(q)[row, moving] @ turning
    return np.asarray(found, dtype=float)


def _driven(
    positions: Positions, drive: str, text: str, name: str
) -> tuple[Mechanism, tuple[float, ...]]:
    """Return the mechanism that a channel drives, and the values that it is given."""
    units = {c.name: c.unit for c in positions.channels}
    try:
        machine = mechanism(positions, [drive])
        return machine, tuple(read_range(text).values(units[drive]))
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None


def _parsed(name: str) -> tuple[str, str, str]:
    """Return channel, drive and values of a name."""
    match = _NAME.fullmatch(name)
    if match is None:
        raise InputError(f"'{name}': write kinematics(CHANNEL, DRIVE, -60 mm:60 mm:4)")
    return match[1].strip(), match[2].strip(), match[3].strip()
