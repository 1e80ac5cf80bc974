"""Identification of parameters from Python."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.running import Progress, reporter
from vehicledyn.interface.targets import Source, read_scenario
from vehicledyn.studies.identification import (
    IdentificationReport,
    Measured,
    channel_unit,
)
from vehicledyn.studies.identification import identify as find


def identify(
    scenario: Source,
    measured: Mapping[str, tuple[Any, Any, float | str]],
    parameters: Mapping[str, Mapping[str, Any]],
    *,
    set: Settings | None = None,
    progress: Progress = False,
    **settings: Any,
) -> IdentificationReport:
    """Return the parameters with which a run comes closest to measured channels.

    Parameters
    ----------
    scenario
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    measured
        By channel the times [s], the values in SI and the standard deviation of their noise, a
        text with unit or a number in SI.
    parameters
        For each parameter "from" and "to"; the search begins at its own value.
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
    for channel, parts in measured.items():
        if len(parts) != 3:
            raise InputError(f"{argument('measured')}: {channel}: give times, values and noise")
        times, values = (np.asarray(part, dtype=float) for part in parts[:2])
        noise = parts[2]
        size = noise if isinstance(noise, float) else to_si(noise, channel_unit(loaded, channel))
        items.append(Measured(channel, times, values, float(size)))
    if not items:
        raise InputError(f"{argument('measured')}: give one channel or more")
    return find(loaded, items, parameters, tell)
