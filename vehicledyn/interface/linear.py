"""Equilibria, eigenmodes and frequency responses from Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from vehicledyn.base.argument_names import argument
from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import positive, speed_in_si, speeds_in_si, texts
from vehicledyn.interface.running import Progress, reporter, result_place, warn_of
from vehicledyn.interface.targets import Source, read_target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.labelled.data import LabelledData

if TYPE_CHECKING:
    from vehicledyn.analyses.linear.linear_model import LinearModel


@checked
def equilibrium(
    model: Source,
    *,
    speed: float | str | None = None,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    backend: Backend = "auto",
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the equilibrium of a vehicle that stands or runs straight ahead, or of a system.

    Parameters
    ----------
    model
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    speed
        Speed such as "20 m/s", or a number [m/s]; the scenario's if None.
    set, settings, save_to, overwrite, backend, progress
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    LabelledData
        All channels by name, and ``coordinate_nominal``, ``coordinate_equilibrium``, the same of
        ``force`` and of ``channel`` (all others) as arrays; ``attributes["stability"]`` is a word.

    Raises
    ------
    InputError
        If the model or a setting cannot be used.
    NumericalError
        If there is no equilibrium.
    """
    from vehicledyn.analyses.linear.equilibrium import find_equilibrium
    from vehicledyn.results.tables.equilibrium_table import write_equilibrium

    target = read_target(model, override_texts(set, settings))
    with result_place(save_to, may_exist=overwrite) as place:
        report = find_equilibrium(
            target,
            speed=None if speed is None else speed_in_si(speed),
            backend=backend,
            progress=reporter(progress),
        )
        write_equilibrium(place.path, report.table)
        return place.value(report)


@checked
def modes(
    model: Source | Mapping[str, Source],
    *,
    speed: float | str | Iterable[float | str] | None = None,
    cases: Mapping[str, Settings] | None = None,
    start: Literal["nominal", "static", "steady"] | None = None,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    backend: Backend = "auto",
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the eigenmodes about straight running, or about a start or equilibrium of a system.

    Parameters
    ----------
    model
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned;
        or several of these by label.
    speed
        One speed or several, such as "20 m/s" or [10.0, 20.0]; the scenario's if None.
    cases
        Variants by label, each with the values by dotted keys that it changes.
    start
        Point to linearise about; the usual one if None.
    set, settings, save_to, overwrite, backend, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        ``eigenvalue``, ``frequency``, ``damping_ratio``, ``kind`` over case and mode, and the
        shapes ``state_shape``, ``channel_shape``, ``participation``.

    Raises
    ------
    InputError
        If the model or a setting cannot be used.
    NumericalError
        If there is no steady motion at a speed.
    """
    from vehicledyn.analyses.linear.eigenmodes import find_modes
    from vehicledyn.results.tables.mode_table import write_modes

    common = override_texts(set, settings)
    models = model if isinstance(model, Mapping) else {"": model}
    if not models:
        raise InputError(f"{argument('model')}: give one or more")
    variants = [
        (
            ", ".join(filter(None, (name, label))),
            read_target(source, [*common, *override_texts(changes, {})]),
        )
        for name, source in models.items()
        for label, changes in (cases or {"": {}}).items()
    ]
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = find_modes(
            variants,
            speeds=speeds_in_si(speed),
            start=start,
            backend=backend,
            progress=reporter(progress),
            kept=place.kept,
        )
        write_modes(place.path, report.table)
        return place.value(report)


@checked
def response(
    model: Source,
    inputs: str | Iterable[str],
    outputs: str | Iterable[str],
    *,
    first: float | str = "0.1 Hz",
    last: float | str = "30 Hz",
    points: int = 200,
    spacing: Literal["log", "linear"] = "log",
    at: Iterable[float | str] = (),
    speed: float | str | None = None,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the frequency responses of outputs to inputs, linearised about a reference motion.

    Parameters
    ----------
    model
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    inputs, outputs
        Names of inputs, such as "steering", "road" or "force:COORDINATE", and of channels.
    first, last
        Lowest and highest frequency [Hz].
    points, spacing
        Number of frequencies, and whether they are evenly spaced on a "log" or "linear" scale.
    at
        Frequencies at which the report gives the response, in place of some of the range [Hz].
    speed
        Speed such as "20 m/s", or a number [m/s]; the scenario's if None.
    set, settings, save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    LabelledData
        ``response``, ``magnitude`` and ``phase`` over frequency, input and output, and
        ``static_gain``.

    Raises
    ------
    InputError
        If the model, an input, an output or a frequency cannot be used.
    NumericalError
        If there is no reference motion.
    """
    from vehicledyn.analyses.linear.frequency_grid import FrequencyGrid
    from vehicledyn.analyses.linear.response import find_response
    from vehicledyn.results.tables.response_table import write_response

    span = (positive("first", first, "Hz"), positive("last", last, "Hz"))
    grid = FrequencyGrid(*span, points, spacing)
    target = read_target(model, override_texts(set, settings))
    with result_place(save_to, may_exist=overwrite) as place:
        report = find_response(
            target,
            inputs=texts("inputs", inputs),
            outputs=texts("outputs", outputs),
            grid=grid,
            at=[positive("at", frequency, "Hz") for frequency in at],
            speed=None if speed is None else speed_in_si(speed),
            progress=reporter(progress),
        )
        write_response(place.path, report.table)
        return place.value(report)


@checked
def linearise(
    model: Source,
    inputs: str | Iterable[str],
    outputs: str | Iterable[str],
    *,
    order: int | None = None,
    to: str | Iterable[str] | None = None,
    speed: float | str | None = None,
    set: Settings | None = None,
    progress: Progress = False,
    **settings: Any,
) -> LinearModel:
    """Return a model linearised about its reference motion, in state space.

    Parameters
    ----------
    model
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    inputs, outputs
        Names as for :func:`vehicledyn.response`.
    order
        States to keep, by balanced truncation; all if None.
    to
        Parameters that the matrices are differentiated by, by patterns; none if None.
    speed
        Speed such as "20 m/s", or a number [m/s]; the scenario's if None.
    set, settings, progress
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    LinearModel
        ``system`` with ``a``, ``b``, ``c``, ``d`` in SI, names of ``states``, ``inputs`` and
        ``outputs``; ``save(path)`` as .mat or .npz, ``to_control()``, ``as_text()``. With ``to``
        also ``parameters`` and ``slopes``, whose ``a``, ``b``, ``c``, ``d`` have the parameter as
        their first axis.

    Raises
    ------
    InputError
        If the model, a name or the order cannot be used.
    NumericalError
        If there is no such reference motion.
    """
    from vehicledyn.analyses.linear.linear_model import find_linear_model

    found = find_linear_model(
        read_target(model, override_texts(set, settings)),
        inputs=texts("inputs", inputs),
        outputs=texts("outputs", outputs),
        speed=None if speed is None else speed_in_si(speed),
        order=order,
        progress=reporter(progress),
        to=() if to is None else texts("to", to),
    )
    warn_of(found.messages)
    return found
