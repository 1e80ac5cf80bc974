"""The verb "hunt": where a motion begins to oscillate, and the limit cycles it then has."""

from __future__ import annotations

import math
from pathlib import Path

from vehicledyn.analyses.hunting.refusals import check_subject
from vehicledyn.analyses.hunting.report import HuntReport
from vehicledyn.analyses.hunting.saving import Saving, finished, identity_of
from vehicledyn.analyses.hunting.start import HuntSettings, check_settings
from vehicledyn.analyses.hunting.study import Study
from vehicledyn.analyses.hunting.undisturbed import without_disturbances
from vehicledyn.analyses.preparation.build_model import Target
from vehicledyn.analyses.preparation.prepare import prepare
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.kernel.kernel import Backend
from vehicledyn.results.hdf5.output import check_folder, check_output
from vehicledyn.results.plots.hunt_figures import hunt_figures
from vehicledyn.results.plots.picture_files import save_figures


def find_limit_cycles(
    target: Target,
    settings: HuntSettings,
    *,
    backend: Backend,
    output: Path | None = None,
    plots: Path | None = None,
    progress: Progress,
    resume: bool = False,
) -> HuntReport:
    """Return where a motion begins to oscillate and the limit cycles along a parameter.

    Parameters
    ----------
    target
        A scenario or a model.
    settings
        What is asked.
    backend, progress
        As for a run.
    output
        Result file to write.
    plots
        Folder for the figures.
    resume
        Whether to go on with what a killed study left beside the output; the result is the same
        as without the kill.

    Raises
    ------
    InputError
        If the parameter, its range or a channel is not usable, or a file cannot be written.
    NumericalError
        If there is no equilibrium at the first value.
    """
    if output is not None:
        check_output(output)
    if plots is not None:
        check_folder(plots)
    check_settings(settings)
    target, remarks = without_disturbances(target, settings)
    prepared = prepare(
        target,
        backend=backend,
        progress=progress,
        check=lambda derived: check_subject(derived, settings),
        varies_states=True,
        evaluations=math.inf,
    )
    identity = "" if output is None else identity_of(prepared, settings)
    before = finished(output, identity) if output is not None and resume else None
    if before is not None:
        words = f"{output}: is finished; nothing was left to do"
        return HuntReport(before, (words,), 0 if before.status == "ok" else 3)
    study = Study.of(prepared, target, settings, progress)
    study.messages += remarks
    if output is None:
        study.examine()
        table = study.table()
    else:
        with Saving(output, identity, resume=resume) as saving:
            study.keep_in(saving)
            study.examine()
            table = study.table()
            saving.finish(table)
    if plots is not None:
        progress("drawing", None)
        save_figures(hunt_figures(table), plots, ("png", "svg"))
    return HuntReport(table, tuple(study.messages), study.exit_code)
