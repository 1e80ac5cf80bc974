"""Derivatives of kinematic curves: channels of a mechanism at places of a drive, by parameters.

With the rows g(q, s, p) = 0 of loops and drives, coordinates q that move and s that stay at their
start, dq/dp = -(∂g/∂q)⁻¹ (∂g/∂p + ∂g/∂s ds/dp), and of a channel y(q, s, p)

    dy/dp = ∂y/∂p + ∂y/∂s ds/dp + ∂y/∂q dq/dp

A velocity ratio r = ∂y/∂q t, with the tangent t of the path from ∂g/∂q t = e, follows alike:
dr/dp = d(∂y/∂q)/dp t - ∂y/∂q (∂g/∂q)⁻¹ d(∂g/∂q)/dp t, the matrices moving with q, s and p.
Instant axes, roll centres and motion ratios are drawn from values and ratios, through which a step
into the complex plane carries these derivatives.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.continuation import PathOutcome, SingularPlace
from vehicledyn.analyses.mechanism.axle_characteristics import axle_columns
from vehicledyn.analyses.mechanism.driven_mechanism import Mechanism, mechanism
from vehicledyn.analyses.mechanism.instant_axes import (
    axis_channels,
    axis_values,
    swing_channels,
    swing_values,
)
from vehicledyn.analyses.mechanism.kinematics import moving_wheels, ratio_channel
from vehicledyn.analyses.mechanism.mechanism_path import PathDrive, run_sweep
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.names import matching
from vehicledyn.base.errors import InputError, NumericalError, unknown_name
from vehicledyn.base.ranges import read_range
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown
from vehicledyn.files.scenario.target import Target
from vehicledyn.multibody.elements.wheel_angles import WheelAngles
from vehicledyn.multibody.loops.position_level import Positions
from vehicledyn.multibody.model.system import System
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.symbolic.equations import Channel

Floats = NDArray[np.float64]
Numbers = NDArray[Any]

_NAME = re.compile(r"kinematics\(([^,]+),([^,]+),([^,=]+)((?:,[^,=]+=[^,=]+)*)\)")
_FORM = "kinematics(CHANNEL, DRIVE, -60 mm:60 mm:4), and further drives such as rack=0 mm behind it"
_SINGULAR = 1e-10
"""Part of the largest singular value of the rows below which a place is singular."""

_ASIDE = 1e-40j
"""Step into the complex plane, so small that its square is nothing."""

_SWINGING = 2
"""Drives between whose motions a swing axis lies."""

KINDS = PathOutcome, SingularPlace
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
        Names such as ``kinematics(wheel.toe, wheel.height, -60 mm:60 mm:4)``, with further drives
        and the values that they are held at, such as ``rack=0 mm``.
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
    for item in asked:
        machine, drives = _driven(positions, item)
        drawn = _Drawn.of(system, machine, item.channel, item.name)
        swept = run_sweep(machine, drives, together=False, progress=progress, memory=memory)
        if swept.failures:
            raise NumericalError(swept.failures[0].words)
        own = positions.channels[machine.drives[0]]
        also = "".join(f", {name} = {text}" for name, text in item.held)
        for sample, place in zip(swept.samples, drives[0].values, strict=True):
            figure = f"{item.channel} at {own.name} = {shown(place, own.unit)}{also}"
            figures.append(Quantity(figure, drawn.channel.unit, drawn.channel.description))
            given = [d.channel for d in drives], sample.coordinates, drawn.has_ratios
            find = partial(_slopes, machine, *given[1:])
            moved = memory.recall_or_raise("slopes", given, find)
            value, slope = drawn.at(sample.values, sample.ratios, *moved)
            values.append(value)
            slopes.append(slope[chosen])
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


@dataclass(frozen=True)
class _Drawn:
    """A figure of a place: its channel, and what it is drawn from.

    ``value`` takes the channels (n_channels,) and, if ``has_ratios``, their velocity ratios and
    those of the speeds by each drive (n_drives, n_channels + n_speeds), and is analytic in them.
    """

    channel: Channel
    value: Callable[[Numbers, Numbers], complex]
    has_ratios: bool = True

    @classmethod
    def of(cls, system: System, machine: Mechanism, channel: str, name: str) -> _Drawn:
        """Return the figure that a name means.

        Raises
        ------
        InputError
            If it means none.
        """
        positions = machine.positions
        driven = [positions.channels[k] for k in machine.drives]
        names = [c.name for c in positions.channels]
        if channel in names:
            row = names.index(channel)
            return cls(positions.channels[row], lambda values, _: values[row], False)
        known: dict[str, _Drawn] = {}

        def offer(abouts: Iterable[Channel], family: Callable[..., Any]) -> None:
            for k, about in enumerate(abouts):
                known[about.name] = cls(about, lambda *at, k=k: complex(family(*at)[k]))

        sensors = [part for part in system.parts if isinstance(part, WheelAngles)]
        axles = axle_columns([s.name for s in sensors], positions.channels, positions.speeds)
        wheels = moving_wheels(sensors, positions)
        everything = (*positions.channels, *positions.speeds)
        for d, drive in enumerate(driven):
            offer((ratio_channel(drive, c) for c in everything), lambda _, r, d=d: r[d])
            for w in wheels:
                offer(axis_channels(drive.name, w), lambda v, r, d=d, w=w: axis_values(w, v, r[d]))
            offer(axles.channels(drive.name), lambda v, r, d=d: axles.values(v, r[d]))
        for w in wheels if len(driven) == _SWINGING else ():
            offer(swing_channels(w), lambda v, r, w=w: swing_values(w, v, *r))
        if channel in known:
            return known[channel]
        why = unknown_name("channel of positions", channel, [*names, *known])
        if channel.startswith("swing.") and len(driven) != _SWINGING:
            why = "a swing axis needs two drives; name another one with its value behind the values"
        elif channel.startswith("ratio."):
            why = (
                f"velocity ratios are those along the drive, ratio.{driven[0].name}.CHANNEL; {why}"
            )
        raise InputError(f"'{name}': {why}")

    def at(
        self, values: Floats, ratios: Floats, by_parameter: Floats, turning: Floats
    ) -> tuple[float, Floats]:
        """Return the value and its derivatives by all parameters.

        ``by_parameter`` (n_channels, n_parameters) and ``turning`` (n_parameters, n_drives, n) are
        those of the channels, and of the velocity ratios.

        Raises
        ------
        NumericalError
            If there is no such value at the place.
        """
        value = float(np.real(self.value(values, ratios)))
        if not np.isfinite(value):
            raise NumericalError(f"'{self.channel.name}' has no value at this place")
        moved = zip(by_parameter.T, turning, strict=True)
        slopes = [
            self.value(values + _ASIDE * first, ratios + _ASIDE * second) for first, second in moved
        ]
        return value, np.imag(slopes) / _ASIDE.imag


def _slopes(machine: Mechanism, q: Floats, has_ratios: bool) -> tuple[Floats, Floats]:
    """Return the derivatives of channels and velocity ratios by all parameters.

    Shapes (n_channels, n_parameters), and (n_parameters, n_drives, n_channels + n_speeds), the
    latter not numbers where they are not wanted.

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
    found = np.asarray(by_parameter + slopes[:, moving] @ follow, dtype=float)
    if not has_ratios:
        n = len(slopes) + len(positions.speeds)
        return found, np.full((found.shape[1], len(machine.drives), n), np.nan)
    everything = started.copy()
    everything[moving] = follow
    every = range(len(machine.drives))
    turning = [_ratio_slopes(machine, q, rows, everything, drive=drive) for drive in every]
    return found, np.stack(turning).transpose(2, 0, 1)


def _ratio_slopes(
    machine: Mechanism, q: Floats, rows: Floats, by_parameter: Floats, *, drive: int
) -> Floats:
    """Return the derivatives of all velocity ratios along a drive by all parameters.

    ``rows`` are derivatives of loops and drives by the moving coordinates, ``by_parameter`` those
    of all coordinates (n_coordinates, n_parameters).
    """
    positions, moving = machine.positions, list(machine.moving)
    tangent = np.zeros(len(q))
    unit = np.zeros(len(rows))
    unit[machine.gaps + drive] = 1.0
    tangent[moving] = np.linalg.lstsq(rows, unit, rcond=None)[0]
    by_coordinate, direct = positions.slopes_along(q, tangent)
    turned = by_coordinate @ by_parameter + direct
    gaps, channels = turned[: machine.gaps], turned[machine.gaps :]
    right = np.vstack([gaps, channels[list(machine.drives)]])
    turning = -np.linalg.lstsq(rows, right, rcond=None)[0]
    slopes = np.vstack([positions.slopes(q), positions.speed_slopes(q)])[:, moving]
    return np.asarray(channels + slopes @ turning, dtype=float)


@dataclass(frozen=True)
class _Asked:
    """What a name asks for: a channel at values of a drive, further drives held at a value."""

    name: str
    channel: str
    drive: str
    values: str
    held: tuple[tuple[str, str], ...]


def _driven(positions: Positions, asked: _Asked) -> tuple[Mechanism, list[PathDrive]]:
    """Return the mechanism that channels drive, and the values that they are given."""
    units = {c.name: c.unit for c in positions.channels}
    try:
        machine = mechanism(positions, [asked.drive, *(name for name, _ in asked.held)])
        drives = [
            PathDrive(asked.drive, tuple(read_range(asked.values).values(units[asked.drive])))
        ]
        for name, text in asked.held:
            values = read_range(text).values(units[name])
            if len(values) > 1:
                raise InputError(f"{name}: give one value; only the first drive takes a range")
            drives.append(PathDrive(name, tuple(values)))
        return machine, drives
    except InputError as error:
        raise InputError(f"'{asked.name}': {error}") from None


def _parsed(name: str) -> _Asked:
    """Return channel, drive and values of a name, and further drives."""
    match = _NAME.fullmatch(name)
    if match is None:
        raise InputError(f"'{name}': write {_FORM}")
    channel, drive, values, others = (part.strip() for part in match.groups())
    held = [part.partition("=") for part in others.split(",") if part.strip()]
    pairs = tuple((key.strip(), value.strip()) for key, _, value in held)
    if len({drive, *(key for key, _ in pairs)}) <= len(pairs):
        raise InputError(f"'{name}': a drive is given twice")
    return _Asked(name, channel, drive, values, pairs)
