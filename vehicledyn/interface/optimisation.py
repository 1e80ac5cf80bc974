"""Optimisation from Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.checked_arguments import checked
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.found_systems import only_model, write_found_system
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.library import locate
from vehicledyn.results.labelled.data import LabelledData


@checked
def optimise(
    study: str | Path,
    *,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    system_file: str | Path | None = None,
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the values of parameters that make figures of runs best, found with gradients.

    Parameters
    ----------
    study
        Path or name of an optimisation study.
    set, settings
        Changes of all scenarios, as for :func:`vehicledyn.simulate`.
    save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.
    system_file
        Where to write the system with the values found, as a system file; None for nowhere. Values
        that do not keep the constraints are not written.

    Returns
    -------
    LabelledData
        ``variable_best`` over variable, ``figure_best`` and ``figure_slope`` there, and the runs:
        ``point``, ``objective``, ``violation``. Its status is "infeasible" where no point was found
        that keeps all constraints; ``status_message`` names those that are missed, and by how much.
        It is "stopped" where the search took all runs that it may before it was at its end; with
        more of them (most_runs) and ``resume`` it goes on.

    Raises
    ------
    InputError
        If the study, a scenario or a setting cannot be used.
    NumericalError
        If the start has no motion or no derivatives.
    """
    from vehicledyn.results.tables.optimum_table import write_optimum
    from vehicledyn.studies.optimisation.file import load_optimisation
    from vehicledyn.studies.optimisation.run import run_optimisation

    tell, texts = reporter(progress), override_texts(set, settings)
    loaded = load_optimisation(locate(str(study), ("study",)), texts, tell)
    model = None
    if system_file is not None:
        ends = {item.name: item.low for item in loaded.variables}
        model = only_model(loaded.scenarios.values(), system_file, ends)
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = run_optimisation(loaded, kept=place.kept, progress=tell)
        write_optimum(place.path, report.table)
        if model is not None and system_file is not None and not report.missed:
            write_found_system(system_file, model, report.as_dict()["set"])
        return place.value(report, goes_on=report.was_stopped)
