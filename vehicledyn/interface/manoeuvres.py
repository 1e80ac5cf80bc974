"""Optimal manoeuvres from Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import NumericalError
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.library import locate
from vehicledyn.results.labelled.data import LabelledData


@checked
def optimise_manoeuvre(
    study: str | Path,
    *,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the controls over time that make a motion quickest or cheapest, and the motion.

    Parameters
    ----------
    study
        Path or name of a study of an optimal manoeuvre.
    set, settings
        Changes of its model or scenario, as for :func:`vehicledyn.simulate`.
    save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        ``state_value`` and ``state_simulated`` over time and state, ``control_value`` over time
        and control, ``channel_value`` over time and channel; on a path ``path_distance``,
        ``path_offset`` and the sides of its corridor; attributes ``duration``, ``objective`` and
        ``simulation_error``.

    Raises
    ------
    InputError
        If the study, its model or a setting cannot be used.
    NumericalError
        If the model has no start, or no optimum was found; ``save_to`` then holds the
        best motion that keeps all conditions, else the last point.
    """
    from vehicledyn.results.tables.manoeuvre_table import write_manoeuvre
    from vehicledyn.studies.manoeuvre_optimisation.file import load_manoeuvre
    from vehicledyn.studies.manoeuvre_optimisation.run import run_manoeuvre

    loaded = load_manoeuvre(locate(str(study), ("study",)), override_texts(set, settings))
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = run_manoeuvre(loaded, kept=place.kept, progress=reporter(progress))
        write_manoeuvre(place.path, report.table)
        if report.table.status != "ok":
            what = "the best motion found" if report.table.is_checked else "the last point"
            hints = [f"\n{note}" for note in report.messages if note.startswith("warning: ")]
            where = "" if save_to is None else f"; '{save_to}' holds {what}"
            raise NumericalError(
                f"{loaded.title}: no optimum was found: {report.table.message} (largest scaled "
                f"violation {report.table.violation:.2g}){where}. Loosen limits, begin nearer by "
                f"duration.guess, or use more intervals{''.join(hints)}"
            )
        return place.value(report)
