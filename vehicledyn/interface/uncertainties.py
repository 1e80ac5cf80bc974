"""Uncertainty of figures from Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal

from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import texts
from vehicledyn.interface.running import Progress, reporter
from vehicledyn.interface.targets import Source, read_scenario
from vehicledyn.studies.uncertainty import UncertaintyReport, find_uncertainty


def uncertainty(
    scenario: Source,
    of: str | Iterable[str],
    parameters: Mapping[str, Mapping[str, Any]],
    *,
    method: Literal["first_order", "monte_carlo", "sequence", "sobol"] = "first_order",
    number: int = 256,
    seed: int = 1,
    limits: Mapping[str, Mapping[str, Any]] | None = None,
    set: Settings | None = None,
    progress: Progress = False,
    **settings: Any,
) -> UncertaintyReport:
    """Return how figures of a run scatter whose parameters have distributions.

    Parameters
    ----------
    scenario
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    of
        Key figures of the run, or figures of channels such as ``max(chassis.roll)``.
    parameters
        Distributions by parameter, such as ``{"kind": "normal", "mean": "1 m", "deviation":
        "1 cm"}``; "uniform" has "from" and "to", "triangular" also "mode".
    method
        "first_order" from exact gradients, one run; "monte_carlo"; "sequence", a scrambled Sobol
        sequence; "sobol", the indices of that name.
    number
        Runs; for "sobol" a power of two, of which parameters plus two times as many are computed.
    seed
        Equal seeds give equal results.
    limits
        By figure "at_most" or "at_least", whose risk is wanted with its 95 % interval.
    set, settings, progress
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    UncertaintyReport
        ``found`` with mean, deviation and their errors; ``shares`` of the variance, ``totals``
        with interactions; ``risks``; ``as_text()`` and ``as_dict()``.

    Raises
    ------
    InputError
        If the scenario, a name, a distribution or a limit cannot be used.
    NumericalError
        If a run fails or a derivative does not exist.
    """
    return find_uncertainty(
        read_scenario(scenario, override_texts(set, settings)),
        texts("of", of),
        parameters,
        method=method,
        number=number,
        seed=seed,
        limits=limits or {},
        progress=reporter(progress),
    )
