"""Uncertainty of figures from Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Literal

from vehicledyn.base.checked_arguments import checked
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import texts
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_scenario
from vehicledyn.results.labelled.data import LabelledData
from vehicledyn.studies.uncertainty.report import UncertaintyReport
from vehicledyn.studies.uncertainty.run import find_uncertainty


@checked
def uncertainty(
    scenario: Source,
    of: str | Iterable[str],
    parameters: Mapping[str, Mapping[str, Any]],
    *,
    method: Literal[
        "first_order",
        "second_order",
        "monte_carlo",
        "sequence",
        "sobol",
        "polynomial_chaos",
        "reliability",
    ] = "first_order",
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
        Key figures of the run, or figures of channels such as ``max(chassis.roll)``; or figures of
        one other analysis of :func:`vehicledyn.sensitivity`, such as ``rig(...)``.
    parameters
        Distributions by parameter, such as ``{"kind": "normal", "mean": "1 m", "deviation":
        "1 cm"}``; "uniform" has "from" and "to", "triangular" also "mode".
    method
        "first_order" from exact gradients, one run; "second_order" from their differences, two runs
        a parameter and one; "monte_carlo"; "sequence", a scrambled Sobol sequence; "sobol", the
        indices of that name; "polynomial_chaos", the same indices from an expansion fitted to a
        sequence; "reliability", the chance of passing a limit from the nearest failing point.
    number
        Runs; for "sobol" a power of two, of which parameters plus two times as many are computed;
        for "reliability" lines, of some three runs each.
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


@checked
def uncertainty_study(
    study: str | Path,
    *,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return how figures scatter whose parameters have distributions, as a study asks for.

    Parameters
    ----------
    study
        Path of an uncertainty study.
    set, settings
        Changes of all scenarios, as for :func:`vehicledyn.simulate`.
    save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        ``mean`` and ``deviation`` over figure, ``shares`` and ``totals`` over figure and parameter,
        and the runs: ``point`` and ``sample``.

    Raises
    ------
    InputError
        If the study, a scenario or a setting cannot be used.
    NumericalError
        If a run fails.
    """
    from vehicledyn.results.tables.uncertainty_table import write_uncertainty
    from vehicledyn.studies.uncertainty.study import run_uncertainty_study, table_of

    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = run_uncertainty_study(
            Path(study),
            override_texts(set, settings),
            kept=place.kept,
            progress=reporter(progress),
        )
        write_uncertainty(place.path, table_of(report))
        return place.value(report)
