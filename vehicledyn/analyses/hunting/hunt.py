"""The verb "hunt": where a motion begins to oscillate, and the limit cycles it then has."""

from __future__ import annotations

import math
from pathlib import Path

from vehicledyn.analyse.settling.cached_types import CYCLE_KINDS
from vehicledyn.analyses.hunting.bent_motions import bent_motions
from vehicledyn.analyses.hunting.refusals import check_subject
from vehicledyn.analyses.hunting.report import HuntReport
from vehicledyn.analyses.hunting.saving import Saving, finished
from vehicledyn.analyses.hunting.start import HuntSettings, check_settings
from vehicledyn.analyses.hunting.study import Study
from vehicledyn.analyses.hunting.undisturbed import without_disturbances
from vehicledyn.analyses.preparation.model_hash import model_facts
from vehicledyn.analyses.preparation.prepare import prepare
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.hdf5.kept_work import KeptWork, identity_of


def find_limit_cycles(
    target: Target,
    settings: HuntSettings,
    *,
    backend: Backend,
    progress: Progress,
    output: Path | None = None,
    kept: KeptWork | None = None,
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
        Result file to write, also while the study goes.
    kept
        What is kept beside it.

    Raises
    ------
    InputError
        If the parameter, its range or a channel is not usable, or a file cannot be written.
    NumericalError
        If there is no equilibrium at the first value.
    """
    kept = kept or KeptWork()
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
    kernel = prepared.kernel
    facts = model_facts(prepared.equations, kernel.parameters), kernel.backend, settings
    identity = identity_of(*facts)
    before = finished(output, identity) if output is not None and kept.resume else None
    if before is not None:
        words = f"{output}: is finished; nothing was left to do"
        return HuntReport(before, (words,))
    study = Study.of(prepared, target, settings, progress)
    study.messages += remarks
    study.model.memory = kept.memory(*facts, kinds=CYCLE_KINDS)
    saving = None if output is None else Saving(output, identity, kept)
    if saving is not None:
        study.write_to(saving)
    study.examine()
    study.messages += bent_motions(prepared, study.model, study.balances, study.branches)
    table = study.table()
    if saving is not None:
        saving.write(table)
    return HuntReport(table, tuple(study.messages))
