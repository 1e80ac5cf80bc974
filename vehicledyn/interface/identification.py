"""Identification of parameters from Python."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.argument_names import argument
from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.found_systems import only_model, write_found_system
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_scenario
from vehicledyn.results.labelled.data import LabelledData
from vehicledyn.studies.identification.experiments import MeasuredChannel
from vehicledyn.studies.identification.identify import IdentificationReport
from vehicledyn.studies.identification.identify import identify as find
from vehicledyn.studies.known_names import KnownNames


@checked
def identify(
    scenario: Source,
    measured: Mapping[str, tuple[Any, Any, float | str]],
    parameters: Mapping[str, Mapping[str, Any]],
    *,
    figures: Mapping[str, Mapping[str, Any]] | None = None,
    set: Settings | None = None,
    progress: Progress = False,
    **settings: Any,
) -> IdentificationReport:
    """Return the parameters with which a run comes closest to measured channels and figures.

    Parameters
    ----------
    scenario
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    measured
        By channel the times [s], the values in SI and the standard deviation of their noise, a
        text with unit or a number in SI.
    parameters
        For each parameter "from" and "to"; the search begins at its own value.
    figures
        By name of a figure its measured "value", or for a curve the places that it is "over"
        with their "over_unit", and the "values" there with their "unit", SI if it is left out;
        and its "noise", "relative_noise" or both, as in a study file.
    set, settings, progress
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    IdentificationReport
        ``found`` with values, covariance, 95 % intervals and what the data cannot tell;
        ``as_text()``.

    Raises
    ------
    InputError
        If a name, a bound or a measurement cannot be used.
    NumericalError
        If a run fails.
    """
    loaded = read_scenario(scenario, override_texts(set, settings))
    tell, items = reporter(progress), []
    known = KnownNames.of(loaded, tell) if measured else None
    for channel, parts in measured.items():
        if len(parts) != 3:
            raise InputError(f"{argument('measured')}: {channel}: give times, values and noise")
        times, values = (
            _real(channel, what, part)
            for what, part in zip(("times", "values"), parts, strict=False)
        )
        noise = parts[2]
        assert known is not None  # there is a channel
        unit = known.channel_unit(channel)
        try:
            size = to_si(noise, unit)
        except InputError as error:
            raise InputError(f"{argument('measured')}: {channel}: noise: {error}") from None
        items.append(MeasuredChannel(channel, times, values, size))
    if not items and not figures:
        raise InputError(f"{argument('measured')}: give one channel or more, or figures")
    return find(loaded, items, parameters, tell, figures or {})


def _real(channel: str, what: str, values: Any) -> NDArray[np.float64]:
    """Return times or values of a channel as real numbers.

    Raises
    ------
    InputError
        If they are none.
    """
    place = f"{argument('measured')}: {channel}: {what}"
    try:
        array = np.asarray(values)
        if array.dtype.kind == "O":
            array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{place}: expected an array of real numbers") from None
    if array.dtype.kind not in "fiub":
        found = {"c": "complex numbers", "U": "texts", "S": "texts"}.get(array.dtype.kind)
        words = f"found {found or f'an array of {array.dtype}'}"
        raise InputError(f"{place}: expected an array of real numbers, {words}")
    return np.asarray(array, dtype=float)


@checked
def identify_study(
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
    """Return the parameters with which runs come closest to the measurements of a study.

    Parameters
    ----------
    study
        Path of an identification study.
    set, settings
        Changes of all scenarios, as for :func:`vehicledyn.simulate`.
    save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.
    system_file
        Where to write the system with the values found, as a system file; None for nowhere.

    Returns
    -------
    LabelledData
        ``parameter_value`` with ``parameter_low`` and ``parameter_high`` over parameter,
        ``covariance``, and for each measured sample ``sample_measured`` and ``sample_fitted``.

    Raises
    ------
    InputError
        If the study, its data, a scenario or a setting cannot be used.
    NumericalError
        If a run fails at the start.
    """
    from vehicledyn.results.tables.identification_table import write_identification
    from vehicledyn.studies.identification.study import (
        load_identification,
        run_identification_study,
    )

    model = None
    if system_file is not None:
        found = load_identification(Path(study), override_texts(set, settings))
        ends = {name: item["from"] for name, item in found.parameters.items() if "from" in item}
        model = only_model([item.loaded for item in found.experiments], system_file, ends)
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = run_identification_study(
            Path(study),
            override_texts(set, settings),
            kept=place.kept,
            progress=reporter(progress),
        )
        write_identification(place.path, report.table)
        if model is not None and system_file is not None:
            write_found_system(system_file, model, report.as_dict()["set"])
        return place.value(report, goes_on=report.found.was_stopped)
