"""Exact derivatives of analyses from Python."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import texts
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_scenario
from vehicledyn.results.labelled.data import LabelledData


def sensitivity(
    scenario: Source,
    of: str | Iterable[str],
    to: str | Iterable[str] = "parameters.*",
    *,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return exact derivatives of a run's channels and key figures by parameters.

    Parameters
    ----------
    scenario
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    of
        Key figures of the run, channels, or figures of channels such as ``max(chassis.roll)``.
    to
        Parameters, by patterns such as ``parameters.front.*``, and start values of states, such
        as ``start.chassis.y``.
    set, settings, save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    LabelledData
        ``figure_value`` over figure, ``figure_slope`` over figure and parameter, not a number
        where no derivative exists, ``figure_change_per_percent``; of channels ``channel_value``
        over channel and time and ``channel_slope`` over channel, time and parameter.

    Raises
    ------
    InputError
        If the scenario, a name or a setting cannot be used.
    NumericalError
        If the run fails or its derivative does not exist.
    """
    from vehicledyn.analyses.sensitivity.motion import find_motion_sensitivity
    from vehicledyn.analyses.sensitivity.report import SensitivityReport
    from vehicledyn.results.tables.sensitivity_table import write_sensitivity

    loaded = read_scenario(scenario, override_texts(set, settings))
    with result_place(save_to, may_exist=overwrite) as place:
        table = find_motion_sensitivity(
            loaded, texts("of", of), texts("to", to), reporter(progress)
        )
        write_sensitivity(place.path, table)
        return place.value(SensitivityReport(table))
