"""Derivatives of inverse dynamics: forces and channels along a prescribed motion, by parameters.

With states x(t, p) that the motion gives, loops 0 = g(x, z, p) and channels y(x, z, p)

    dy/dp = ∂y/∂p + ∂y/∂x dx/dp - ∂y/∂z (∂g/∂z)⁻¹ (∂g/∂p + ∂g/∂x dx/dp)
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.key_figures import FigureSlope, figure_slope, unit_of
from vehicledyn.analyses.mechanism.drive_columns import DriveColumns, DriveFigure
from vehicledyn.analyses.mechanism.inverse import channel_rows
from vehicledyn.analyses.mechanism.inverse_report import prepared_motion, sample_times
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.names import (
    START,
    Directions,
    RequestedNames,
    directions,
    wanted,
)
from vehicledyn.analyses.sensitivity.steps import check_size
from vehicledyn.analyses.sensitivity.subjects.motion_law import GivenMotion
from vehicledyn.base.errors import InputError
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody.equations.inverse_dynamics import InverseDynamics
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

Floats = NDArray[np.float64]

_NAME = re.compile(r"inverse\((.+)\)")
_CHUNK = 64
_STEP, _CORNER = 1e-9, 1e-5
"""Part of the parameters by which they are moved to both sides, and part of a channel's largest
derivative by which those at both sides may differ, where there is no corner."""


def find_inverse_sensitivity(
    loaded: LoadedScenario,
    of: Sequence[str],
    to: Sequence[str],
    progress: Progress,
    *,
    memory: Memory,
) -> SensitivityTable:
    """Return derivatives of channels and key figures of inverse dynamics, laws of motion included.

    Parameters
    ----------
    loaded
        A scenario with a motion, as for :func:`vehicledyn.inverse`.
    of
        Names such as ``inverse(crank.angle_force)``, ``inverse(max(crank.angle_force))`` or, of a
        key figure, ``inverse(crank.angle.work)``.
    to
        Patterns of parameters.
    progress
        Called with what is going on.
    memory
        Knows the rows and slopes found.

    Raises
    ------
    InputError
        If the motion is missing, or a name means nothing.
    NumericalError
        If a loop cannot be closed, or is singular.
    """
    if any(name.startswith(START) for name in to):
        raise InputError(
            "inverse dynamics have no start values: the motion is given; name parameters"
        )
    progress("deriving the inverse dynamics", None)
    times = sample_times(loaded)
    motion, inverse = prepared_motion(loaded, build_subject(loaded).system, None)
    book, e = DriveColumns.of(inverse), inverse.equations
    figures = {figure.name: figure for figure in book.figures()}
    offered = replace(e, channels=book.channels)
    asked = wanted(offered, [_inner(name) for name in of], list(figures))
    kernel = compile_kernel(e, backend="auto", progress=progress)
    start = np.array([state.start for state in e.states])
    chosen = directions(e, kernel.parameters, start, to)
    names = _needed(asked, figures)
    check_size(len(times), len(names) * len(chosen.values))
    given = GivenMotion(motion, loaded.written, [p.name for p in e.parameters])
    path = _Path(inverse, kernel, book, given, chosen, times, tuple(names), memory)
    return _table(loaded, path, asked, figures, progress)


def _inner(name: str) -> str:
    match = _NAME.fullmatch(name)
    if match is None:
        raise InputError(f"'{name}': write inverse(CHANNEL) or inverse(max(CHANNEL))")
    return match[1].strip()


def _needed(asked: RequestedNames, figures: dict[str, DriveFigure]) -> list[str]:
    """Return the channels behind everything that is asked for."""
    own = [figures[name].channel for name in asked.others]
    return list(dict.fromkeys([*asked.curves, *[name for _, name in asked.figures], *own]))


@dataclass(frozen=True)
class _Path:
    """Inverse dynamics along their motion, with derivatives of the channels ``names``."""

    inverse: InverseDynamics
    kernel: Kernel
    book: DriveColumns
    given: GivenMotion
    chosen: Directions
    times: Floats
    names: tuple[str, ...]
    memory: Memory

    @cached_property
    def _rows(self) -> list[tuple[int, ...]]:
        """Places among the equations' channels of each name: its own, or a force and its rate."""
        places = {channel.name: k for k, channel in enumerate(self.book.channels)}
        first = len(self.book.channels) - len(self.book.forces)
        found = []
        for name in self.names:
            k = places[name]
            own = (k,) if k < first else self.book.forces[k - first]
            found.append(tuple(self.book.kept[item] for item in own))
        return found

    @cached_property
    def _derivatives(self) -> tuple[Derivatives, list[int]]:
        """Derivatives of the channels needed alone, and their places among all."""
        e = self.inverse.equations
        needed = sorted({k for row in self._rows for k in row})
        less = replace(e, output=e.output[needed], channels=tuple(e.channels[k] for k in needed))
        moving = [e.parameters[k].name for k in self._moving]
        return Derivatives(less, moving), needed

    @property
    def _moving(self) -> list[int]:
        return [int(k) for k in np.flatnonzero(self.chosen.by_parameter.any(axis=1))]

    def found(self, progress: Progress) -> tuple[Floats, Floats]:
        """Return channels (n_times, n_names) and slopes (n_times, n_names, n_directions).

        Slopes are not a number where they jump when all parameters move by a little.
        """
        parts, unknowns = [], None
        for first in range(0, len(self.times), _CHUNK):
            find = partial(self._part, first, unknowns)
            *part, unknowns = self.memory.recall_or_raise("part", (first, unknowns), find)
            parts.append(part)
            progress("differentiating the forces", min(1.0, (first + _CHUNK) / len(self.times)))
        values, slopes, jumps = (np.concatenate(items) for items in zip(*parts, strict=True))
        size = np.max(np.abs(slopes), axis=0, initial=0.0)
        slopes[jumps > _CORNER * size] = np.nan
        return values, slopes

    def _part(
        self, first: int, unknowns: Floats | None
    ) -> tuple[Floats, Floats, Floats, Floats | None]:
        """Return channels, slopes and their jumps at some times, and the last unknowns."""
        kernel = self.kernel.with_parameters(self.kernel.parameters)
        times = self.times[first : first + _CHUNK]
        tables = self.given.at(times, kernel.parameters)
        found = list(channel_rows(self.inverse, kernel, times, tables, unknowns))
        rows = np.array([row for row, _ in found]), np.array([known for _, known in found])
        values, slopes = self._differentiated(kernel, times, rows)
        sides = []
        for sign in (1.0, -1.0):
            kernel.set_parameters(self.kernel.parameters + sign * self._nudge)
            moved = self._solved(kernel, times, rows[1])
            sides.append(self._differentiated(kernel, times, moved)[1])
        return values, slopes, np.abs(sides[0] - sides[1]), rows[1][-1]

    def _solved(self, kernel: Kernel, times: Floats, near: Floats) -> tuple[Floats, Floats]:
        """Return channels and unknowns at some times, from unknowns nearby."""
        tables = self.given.at(times, kernel.parameters)
        rows, unknowns = [], []
        for k, (time, guess) in enumerate(zip(times, near, strict=True)):
            state = self.inverse.state(*(table[k] for table in tables))
            unknowns.append(kernel.solve_unknowns(float(time), state, guess))
            rows.append(kernel.outputs(float(time), state, unknowns[-1]))
        return np.array(rows), np.array(unknowns)

    def _differentiated(
        self, kernel: Kernel, times: Floats, solved: tuple[Floats, Floats]
    ) -> tuple[Floats, Floats]:
        """Return the channels wanted and their slopes, from all channels and the unknowns."""
        parameters, by_parameter = kernel.parameters, self.chosen.by_parameter
        tables = self.given.at(times, parameters)
        moved = [item @ by_parameter for item in self.given.slopes(times, parameters)]
        derivatives, needed = self._derivatives
        places, moving = {k: place for place, k in enumerate(needed)}, self._moving
        values = np.zeros((len(times), len(self.names)))
        slopes = np.zeros((*values.shape, by_parameter.shape[1]))
        for k, (row, unknowns) in enumerate(zip(*solved, strict=True)):
            state = self.inverse.state(*(table[k] for table in tables))
            total = derivatives.total(float(times[k]), state, unknowns, parameters)
            by_state = self.inverse.state_tangents(*(item[k] for item in moved))
            own = total.outputs @ by_state + total.outputs_by_parameter @ by_parameter[moving]
            for column, parts in enumerate(self._rows):
                factors = row[list(parts)]
                values[k, column] = np.prod(factors)
                for place, part in enumerate(parts):
                    others = np.prod(np.delete(factors, place))
                    slopes[k, column] += others * own[places[part]]
        return values, slopes

    @cached_property
    def _nudge(self) -> Floats:
        """A small change of all parameters that derivatives are by, in proportions at random."""
        numbers, values = np.random.default_rng(1), self.chosen.values
        parts = numbers.uniform(0.5, 1.0, len(values)) * numbers.choice([-1.0, 1.0], len(values))
        sizes = np.where(values != 0.0, np.abs(values), 1.0)
        return np.asarray(self.chosen.by_parameter @ (_STEP * parts * sizes))


def _table(
    loaded: LoadedScenario,
    path: _Path,
    asked: RequestedNames,
    figures: dict[str, DriveFigure],
    progress: Progress,
) -> SensitivityTable:
    values, slopes = path.found(progress)
    about = {channel.name: channel for channel in path.book.channels}
    places = {name: k for k, name in enumerate(path.names)}
    notes = [
        f"warning: '{name}' has a corner at {path.times[lost[0]]:g} s, where no derivative exists"
        for k, name in enumerate(path.names)
        if (lost := np.flatnonzero(~np.isfinite(slopes[:, k]).all(axis=1))).size
    ]
    found: list[tuple[Quantity, FigureSlope]] = []
    for name in asked.others:
        figure, k = figures[name], places[figures[name].channel]
        slope = _drive_slope(figure, path.times, values[:, k], slopes[:, k])
        found.append((Quantity(name, figure.unit, figure.description), slope))
    for kind, name in asked.figures:
        k, channel = places[name], about[name]
        slope = figure_slope(kind, path.times, values[:, k], slopes[:, k])
        words = f"{kind} of {channel.description}"
        found.append((Quantity(f"{kind}({name})", unit_of(kind, channel.unit), words), slope))
    notes += [
        f"warning: '{quantity.name}' has no derivative: {slope.trouble}"
        for quantity, slope in found
        if slope.trouble
    ]
    shape = len(found), len(path.chosen.values)
    rows = [np.full(shape[1], np.nan) if s.trouble else s.slope for _, s in found]
    curves = [places[name] for name in asked.curves]
    return SensitivityTable(
        loaded.title,
        path.inverse.equations.name,
        path.chosen.quantities,
        path.chosen.values,
        tuple(quantity for quantity, _ in found),
        np.array([slope.value for _, slope in found]),
        np.array(rows).reshape(shape),
        tuple(Quantity(n, about[n].unit, about[n].description) for n in asked.curves),
        path.times,
        values[:, curves].T,
        slopes[:, curves].transpose(1, 0, 2),
        tuple(notes),
    )


def _drive_slope(figure: DriveFigure, times: Floats, values: Floats, slopes: Floats) -> FigureSlope:
    """Return a key figure of a drive with its derivatives."""
    if figure.is_integral:
        return figure_slope("integral", times, values, slopes)
    return figure_slope("max", times, np.abs(values), np.sign(values)[:, None] * slopes)
