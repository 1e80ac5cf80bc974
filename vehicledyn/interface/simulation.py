"""Simulation from Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vehicledyn.analyses.simulation.simulation import run_scenario
from vehicledyn.base.checked_arguments import checked
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_scenario
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.labelled.data import LabelledData


@checked
def simulate(
    scenario: Source,
    *,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    restart: str | Path | LabelledData | None = None,
    backend: Backend = "auto",
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the simulated motion of a scenario or model.

    Parameters
    ----------
    scenario
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
        A model without scenario runs for ten seconds, a road vehicle straight ahead.
    set
        Values of the scenario by dotted keys, such as ``{"solver.step": "1 ms"}``.
    save_to
        File to keep the result in while it is written; a temporary one if None.
    overwrite
        Whether ``save_to`` may exist; it is replaced.
    restart
        Result, partial or whole, to continue from.
    backend
        "auto", "compiled" or "interpreted".
    progress
        Whether to show on standard error what is done, or a function that gets text and part.
    settings
        Values of the scenario by field, such as ``speed="20 m/s"``.

    Returns
    -------
    LabelledData
        Every channel by name. A run that failed or ended early warns and has what it computed.

    Raises
    ------
    InputError
        If the scenario, a setting or a file cannot be used.
    NumericalError
        If the run cannot start.
    """
    loaded = read_scenario(scenario, override_texts(set, settings))
    before = restart.path if isinstance(restart, LabelledData) else restart
    with result_place(save_to, may_exist=overwrite) as place:
        outcome = run_scenario(
            loaded,
            output=place.path,
            backend=backend,
            progress=reporter(progress),
            restart=None if before is None else Path(before),
        )
        return place.value(outcome)
