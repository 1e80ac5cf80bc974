"""Names of the key figures of a run, found by a plain run before any derivative is prepared."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepare import Point
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.sensitivity.names import Wanted, wanted
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_watched
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.analyses.simulation.wanted_outputs import needed_channels
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.symbolic.equations import Equations

Matrix = NDArray[np.float64]


def is_figure_of_run(name: str, equations: Equations) -> bool:
    """Return whether a name can only be a key figure: no channel, and no figure of one."""
    return "(" not in name and all(name != channel.name for channel in equations.channels)


def check_figures(loaded: LoadedScenario, of: Sequence[str], progress: Progress) -> None:
    """Refuse names that are no figures; raises as :func:`check_names`, and for curves."""
    curves = check_names(loaded, of, progress).curves
    if curves:
        raise InputError(f"'{curves[0]}' is a curve; take a figure of it, such as rms({curves[0]})")


def check_names(loaded: LoadedScenario, of: Sequence[str], progress: Progress) -> Wanted:
    """Return what names ask for; refuse those that are neither channels nor figures of the run.

    Which key figures there are depends on the run, which is simulated for it by the scenario's
    own method; that needs no compiler.

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
    prepared, start = prepare_run(loaded, backend="auto", progress=progress)
    doubtful = [name for name in of if is_figure_of_run(name, prepared.equations)]
    found = wanted(prepared.equations, of, doubtful)
    if doubtful:
        progress("finding the key figures of the run", None)
        found = wanted(prepared.equations, of, _figures_of_run(loaded, prepared, start))
    return found


def _figures_of_run(loaded: LoadedScenario, prepared: Prepared, start: Point) -> list[str]:
    """Return the names of the key figures that have derivatives."""
    chosen, channels = needed_channels(prepared), prepared.equations.channels
    solver: Any = loaded.scenario.solver
    times: list[Matrix] = []
    rows: list[Matrix] = []

    def take(at: Matrix, states: Matrix, unknowns: Matrix, outputs: Matrix) -> None:
        times.append(np.array(at))
        rows.append(np.array(outputs)[:, chosen])

    simulate_watched(
        prepared.subject.system,
        prepared.kernel,
        solver,
        start=0.0,
        stop=loaded.scenario.duration,
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
