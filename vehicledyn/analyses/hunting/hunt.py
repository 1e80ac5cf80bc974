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
from vehicledyn.analyses.preparation.prepare import prepare
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.hdf5.output import check_output


def find_limit_cycles(
    target: Target,
    settings: HuntSettings,
    *,
    backend: Backend,
    output: Path | None = None,
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
        return HuntReport(before, (words,))
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
    return HuntReport(table, tuple(study.messages))
