"""The verb "eig": eigenmodes and mode shapes about straight running, or of a system."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from vehicledyn.analyse.linearise import Linearisation, linearise
from vehicledyn.analyse.modes import Mode, eigenmodes
from vehicledyn.analyse.small_motions import varied_states
from vehicledyn.analyses.linear.mode_report import ModesAtSpeed, ModesReport
from vehicledyn.analyses.preparation.own_speed import at_speed, refuse_idle_speed, speed_matters
from vehicledyn.analyses.preparation.prepare import Start, prepare, reference_start, start_point
from vehicledyn.analyses.preparation.prepared import Check, Prepared, Progress
from vehicledyn.analyses.preparation.steadiness import unsteadiness
from vehicledyn.analyses.preparation.target_digest import digests_to_keep
from vehicledyn.analyses.preparation.validity.points import beam_warnings, validity_warnings
from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import shown
from vehicledyn.files.scenario.sets import Scenario
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.mode_table import ModeCase, ModeTable

__all__ = ["ModesAtSpeed", "ModesReport", "find_modes"]

_EQUAL = 1e-6
"""Part by which two participations may differ and count as equal [1]."""


def find_modes(
    target: Target | Sequence[tuple[str, Target]],
    *,
    speeds: Sequence[float],
    start: Start | None = None,
    backend: Backend,
    progress: Progress,
    kept: KeptWork | None = None,
) -> ModesReport:
    """Return the modes of a vehicle about its steady motion straight ahead, or of a system.

    A system is linearised about the start that its scenario names, else about the equilibrium
    near its start values.

    Parameters
    ----------
    target
        A scenario or a model, or several variants of one with a text each that says what is
        changed; each goes through all speeds.
    speeds
        Forward speeds [m/s]; empty for the scenario's own.
    start
        Point to linearise about, see :func:`vehicledyn.analyses.preparation.prepare.start_point`;
        None for the usual one.
    backend, progress
        As for a run.
    kept
        What is kept while they are found.

    Raises
    ------
    InputError
        If speeds are given to a system that has none.
    NumericalError
        If there is no steady motion at a speed.
    """
    variants = [("", target)] if not isinstance(target, Sequence) else list(target)
    kept = kept or KeptWork()
    memory = kept.memory("eig", list(speeds), start, backend, kinds=_KINDS)
    subjects = _Subjects(backend, progress, refuse_idle_speed if speeds else None)
    found: list[_Found] = []
    for setting, variant, speed in _cases(variants, speeds):
        digests = digests_to_keep(kept, [variant])
        find = partial(_found, subjects, variant, speed, start)
        own = memory.recall_or_raise("modes", (digests, speed), find)
        if found and own.table.states != found[0].table.states:
            raise InputError(f"{given('cases', setting)}: changes which states the model has")
        found.append(own.called(setting))
    whole = replace(found[0].table, cases=tuple(item.case for item in found))
    return ModesReport(whole.model, [item.entry for item in found], whole, found[-1].has_speed)


class _Found(NamedTuple):
    """What is found of a case: a table without cases, the modes, and the case of the table."""

    table: ModeTable
    has_speed: bool
    entry: ModesAtSpeed
    case: ModeCase

    def called(self, setting: str) -> _Found:
        """Return the same with what was changed."""
        return self._replace(
            entry=replace(self.entry, setting=setting), case=replace(self.case, setting=setting)
        )


@dataclass
class _Subjects:
    """Prepares targets, each once if they come one after the other."""

    backend: Backend
    progress: Progress
    check: Check | None
    last: tuple[Target, Prepared] | None = None

    def prepared(self, target: Target) -> Prepared:
        """Return a target made ready."""
        if self.last is None or self.last[0] is not target:
            made = prepare(
                target,
                backend=self.backend,
                progress=self.progress,
                check=self.check,
                varies_states=True,
            )
            self.last = target, made
        return self.last[1]


def _found(subjects: _Subjects, target: Target, speed: float, start: Start | None) -> _Found:
    """Return the modes of a target at a speed [m/s]."""
    prepared = subjects.prepared(target)
    has_speed = speed_matters(prepared.subject)
    place = f" at {shown(speed, 'm/s')}" if has_speed else ""
    subjects.progress(f"linearising{place}", None)
    entry, linear = _modes_at(prepared, speed, start, target.choices)
    table = _empty_table(prepared, target)
    return _Found(table, has_speed, entry, _case(table, entry, linear))


_KINDS = _Found, ModeTable, ModeCase, ModesAtSpeed, Mode, Quantity


def _cases(
    variants: Sequence[tuple[str, Target]], speeds: Sequence[float]
) -> Iterator[tuple[str, Target, float]]:
    """Yield what is changed, the target and its speed of each case [m/s]."""
    for setting, variant in variants:
        own: Sequence[float | None] = [None]
        for wanted in speeds or own:
            target, speed = at_speed(variant, wanted)
            if speed is None and target.choices is not None:
                speed = target.choices.speed
            yield setting, target, speed or 0.0


def _modes_at(
    prepared: Prepared, speed: float, wanted: Start | None, scenario: Scenario | None
) -> tuple[ModesAtSpeed, Linearisation]:
    """Return the modes about the reference motion at a speed."""
    if wanted is None:
        start = scenario.start if scenario else None
        kind = reference_start(prepared.subject, speed, start)
    else:
        kind = _checked(prepared, wanted, speed)
    point = start_point(prepared, speed, kind, slopes=prepared.derivatives)
    linear = linearise(
        prepared.equations,
        prepared.kernel.parameters,
        prepared.subject.balance_time,
        point.state,
        point.unknowns,
        derivatives=prepared.derivatives,
    )
    remarks = [] if kind == "steady" else [unsteadiness(prepared, point)]
    if kind == "nominal":
        remarks += beam_warnings(prepared, point)
    else:
        remarks += [point.remark, *validity_warnings(prepared, point)]
    remark = "\n".join(filter(None, remarks))
    return ModesAtSpeed(speed, eigenmodes(linear.matrix, linear.names), "", remark), linear


def _checked(prepared: Prepared, wanted: Start, speed: float) -> Start:
    """Return a start that the subject can have; a vehicle that stands is steady at rest."""
    if wanted != "steady":
        return wanted
    if prepared.subject.usual_start != "steady":
        raise InputError(f"{given('start', 'steady')}: is for vehicles; take 'nominal' or 'static'")
    return "steady" if speed > 0.0 else "static"


def _empty_table(prepared: Prepared, target: Target) -> ModeTable:
    """Return a table without cases."""
    e = prepared.equations
    names = {channel.name for channel in e.channels}
    return ModeTable(
        target.title,
        e.name,
        tuple(Quantity(s.name, s.unit, s.description) for s in varied_states(e)),
        tuple(Quantity(c.name, c.unit, c.description) for c in e.channels),
        tuple(j.name for j in prepared.subject.system.joints() if j.name in names),
        (),
    )


def _case(table: ModeTable, entry: ModesAtSpeed, linear: Linearisation) -> ModeCase:
    """Return the modes with their shapes in all channels, scaled."""
    shapes = [_scaled(table, mode, linear) for mode in entry.modes]
    return ModeCase(
        entry.speed,
        entry.setting,
        np.array([mode.eigenvalue for mode in entry.modes], dtype=complex),
        tuple(mode.kind for mode in entry.modes),
        _stacked([state for state, _ in shapes], len(table.states)),
        _stacked([channel for _, channel in shapes], len(table.channels)),
        _stacked([mode.participation for mode in entry.modes], len(table.states)).real,
    )


def _scaled(table: ModeTable, mode: Mode, linear: Linearisation) -> tuple[Any, Any]:
    """Return the shape in states and channels, 1 at the coordinate that takes part most."""
    channels = linear.output_matrix @ mode.shape
    if mode.is_zero:
        return mode.shape, channels
    shares = table.shares(mode.participation)
    moving = [(shares[name], name) for name in table.coordinates if shares.get(name, 0.0) > 0.0]
    if not moving:
        return mode.shape, channels
    most = max(moving)[0]
    leading = next(name for share, name in moving if share >= most - _EQUAL)
    scale = channels[table.columns([leading])[0]]
    if abs(scale) <= np.finfo(float).tiny:
        return mode.shape, channels
    return mode.shape / scale, channels / scale


def _stacked(rows: list[Any], width: int) -> Any:
    return np.stack(rows).astype(complex) if rows else np.zeros((0, width), dtype=complex)
