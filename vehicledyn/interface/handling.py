"""Handling of road vehicles from Python: steady cornering and the standards' tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vehicledyn.base.checked_arguments import checked
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import positive
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.labelled.data import LabelledData


@checked
def steady(
    car: Source,
    *,
    speed: float | str = "100 km/h",
    radius: float | str = "100 m",
    moments: bool = True,
    limits: bool = True,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    backend: Backend = "auto",
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return steady cornering of a road vehicle without time simulation, up to its limits.

    Parameters
    ----------
    car
        Path or name of a scenario or model of a road vehicle, or what :func:`vehicledyn.load`
        returned.
    speed
        Speed of the constant-speed curve, moments and limits [m/s].
    radius
        Radius of the constant-radius curve [m].
    moments, limits
        Whether the yaw-moment diagram and the g-g diagram are wanted.
    set, settings, save_to, overwrite, backend, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        Curves such as ``constant_speed.steering_angle``, ``constant_radius.understeer_angle``,
        ``modes.real``, ``yaw_moments.yaw_acceleration``, ``limits.lateral``; ``figure_value``
        holds the gradients and limits over ``figure``.

    Raises
    ------
    InputError
        If the model is no road vehicle on free wheels.
    NumericalError
        If the car does not run straight.
    """
    from vehicledyn.analyses.handling.report import HandlingReport
    from vehicledyn.analyses.handling.steady import SteadyRequest, steady_table
    from vehicledyn.results.tables.handling_table import write_handling

    target = read_target(car, override_texts(set, settings))
    wish = SteadyRequest(
        positive("speed", speed, "m/s"), positive("radius", radius, "m"), moments, limits
    )
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        table = steady_table(
            target, wish, backend=backend, progress=reporter(progress), kept=place.kept
        )
        write_handling(place.path, table)
        return place.value(HandlingReport(table))


@checked
def handling(
    car: Source,
    *,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    backend: Backend = "auto",
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the standards' handling tests of a road vehicle: key figures and curves.

    Parameters
    ----------
    car
        Path or name of a scenario or model of a road vehicle, or what :func:`vehicledyn.load`
        returned; a scenario's own manoeuvre is left out.
    set, settings, save_to, overwrite, backend, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        ``figure_value`` over ``figure``, and the signals of each test such as
        ``step_steer.yaw_rate``.

    Raises
    ------
    InputError
        If the model is no road vehicle on free wheels, or there is nothing to go on with.
    NumericalError
        If the car does not run straight.
    """
    from vehicledyn.analyses.handling.handling import handling_table
    from vehicledyn.analyses.handling.report import HandlingReport
    from vehicledyn.results.tables.handling_table import write_handling

    target = read_target(car, override_texts(set, settings))
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        table = handling_table(
            target, backend=backend, progress=reporter(progress), kept=place.kept
        )
        write_handling(place.path, table)
        return place.value(HandlingReport(table))
