"""Names of the key figures of a run, found by a plain run before any derivative is prepared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.sensitivity.names import RequestedNames, wanted
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.analyses.simulation.wanted_outputs import needed_channels
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.symbolic.equations import Equations

Matrix = NDArray[np.float64]


_FIRST_SAMPLES = 500
"""Samples of a long run in whose first part figures are looked for before the whole is run."""
_PATTERN = frozenset("*?[]")
_IN_NO_NAME = frozenset(" ,;:=/\\\"'\t\n")
"""Signs that patterns are known by, and those that stand in no name of a figure."""


def is_figure_of_run(name: str, equations: Equations) -> bool:
    """Return whether a name can only be a key figure: no channel, and no figure of one."""
    return "(" not in name and all(name != channel.name for channel in equations.channels)


def check_names(loaded: LoadedScenario, of: Sequence[str], progress: Progress) -> None:
    """Refuse names that are neither channels nor figures of the run.

    Which key figures there are depends on the run, which is simulated for it by the scenario's
    own method, its first part alone where that shows them; that needs no compiler. It is not
    simulated where other names mean nothing.

    Parameters
    ----------
    loaded
        The scenario.
    of
        Names, see :mod:`vehicledyn.analyses.sensitivity.names`.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If a name means nothing; the nearest one is suggested.
    NumericalError
        If the run fails.
    """
    for words in _looked_up(loaded, of, progress)[1].values():
        raise InputError(words, argument="of")


def wrong_figures(loaded: LoadedScenario, of: Sequence[str], progress: Progress) -> dict[str, str]:
    """Return what is wrong with names that are no figures, by name; curves are none.

    The arguments and errors of runs are those of :func:`check_names`.
    """
    found, wrong = _looked_up(loaded, of, progress)
    for name, asked in found.items():
        if asked.curves:
            curve = asked.curves[0]
            wrong[name] = f"'{curve}' is a curve; take a figure of it, such as rms({curve})"
    return wrong


def _looked_up(
    loaded: LoadedScenario, of: Sequence[str], progress: Progress
) -> tuple[dict[str, RequestedNames], dict[str, str]]:
    """Return what each name asks for, and what is wrong with those that mean nothing."""
    prepared, start = prepare_run(loaded, backend="auto", progress=progress)
    equations = prepared.equations
    doubtful = [name for name in of if is_figure_of_run(name, equations)]
    taken = {name: [name] for name in doubtful if not set(name) & _IN_NO_NAME}
    found, wrong = _meant(equations, {name: taken.get(name, []) for name in of})
    if not doubtful or wrong:
        return found, wrong
    progress("finding the key figures of the run", None)
    whole, interval = loaded.scenario.duration, loaded.scenario.output.interval
    known: list[str] = []
    if whole > _FIRST_SAMPLES * interval and not any(set(name) & _PATTERN for name in doubtful):
        known = _figures_of_run(loaded, prepared, start, _FIRST_SAMPLES * interval)
    if not set(doubtful) <= set(known):
        known = _figures_of_run(loaded, prepared, start, whole)
    return _meant(equations, dict.fromkeys(of, known))


def _meant(
    equations: Equations, of: Mapping[str, Sequence[str]]
) -> tuple[dict[str, RequestedNames], dict[str, str]]:
    """Return what names ask for by the figures there are, and what is wrong with the others."""
    found, wrong = {}, {}
    for name, known in of.items():
        try:
            found[name] = wanted(equations, [name], known)
        except InputError as error:
            wrong[name] = str(error)
    return found, wrong


def _figures_of_run(
    loaded: LoadedScenario, prepared: Prepared, start: AssembledPoint, stop: float
) -> list[str]:
    """Return the names of the key figures that have derivatives, of a run to a time [s]."""
    chosen, channels = needed_channels(prepared), prepared.equations.channels
    solver: Any = loaded.scenario.solver
    times: list[Matrix] = []
    rows: list[Matrix] = []

    def take(at: Matrix, states: Matrix, unknowns: Matrix, outputs: Matrix) -> None:
        times.append(np.array(at))
        rows.append(np.array(outputs)[:, chosen])

    simulate_monitored(
        prepared.subject.system,
        prepared.kernel,
        solver,
        start=0.0,
        stop=stop,
        state=start.state,
        unknowns=start.unknowns,
        interval=loaded.scenario.output.interval,
        sink=take,
        progress=lambda *_: None,
        happened=lambda *_: None,
        watch=lambda: prepared.watch,
    )
    columns = np.concatenate(rows).T
    names, units = [channels[k].name for k in chosen], [channels[k].unit for k in chosen]
    recording = Recording(
        np.concatenate(times),
        dict(zip(names, columns, strict=True)),
        dict(zip(names, units, strict=True)),
    )
    entries = prepared.subject.summarise(recording)
    return [entry.name for entry in entries if isinstance(entry.value, float)]
