"""Limit cycles along a parameter from Python."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from vehicledyn.base.checked_arguments import checked
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import texts
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.labelled.data import LabelledData


@checked
def hunt(
    model: Source,
    first: float | str,
    last: float | str,
    *,
    parameter: str = "speed",
    points: int | None = None,
    channels: str | Iterable[str] = (),
    amplitude: float = 1e-4,
    disturbance: float = 1e-3,
    simulate: bool = True,
    simulated: float | str | None = None,
    secondary: bool | None = None,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    backend: Backend = "auto",
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return critical speeds and limit cycles along a speed or any other parameter.

    Parameters
    ----------
    model
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    first, last
        Lowest and highest value, such as "5 m/s", or numbers in SI.
    parameter
        What is varied.
    points
        About as many cycles on each way through the range; what suits the model if None.
    channels
        Channels whose amplitudes are kept; the first is watched in simulations.
    amplitude, disturbance
        First amplitude of a branch, and that with which simulations start [m or rad].
    simulate, simulated
        Whether to check by simulation, and how much motion to simulate at most [s].
    secondary
        Whether to follow cycles that branch off; where no stable cycle is found if None.
    set, settings, save_to, overwrite, backend, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        ``cycle_parameter``, ``cycle_period``, ``cycle_stable``, ``cycle_greatest`` and more over
        the cycles, ``eigenvalue`` over the equilibria; critical values are in ``summary``.

    Raises
    ------
    InputError
        If the model, the parameter, its range or a setting cannot be used.
    NumericalError
        If there is no equilibrium at the first value.
    """
    from vehicledyn.analyses.hunting.hunt import find_limit_cycles
    from vehicledyn.analyses.hunting.start import HuntSettings

    wanted = HuntSettings(
        parameter,
        first,
        last,
        points=points,
        channels=tuple(texts("channels", channels)) if channels else (),
        amplitude=amplitude,
        disturbance=disturbance,
        simulate=simulate,
        simulated=simulated,
        secondary=secondary,
    )
    target = read_target(model, override_texts(set, settings))
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = find_limit_cycles(
            target,
            wanted,
            backend=backend,
            progress=reporter(progress),
            output=place.path,
            kept=place.kept,
        )
        return place.value(report)
