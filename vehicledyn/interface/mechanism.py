"""Kinematics and inverse dynamics from Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from vehicledyn.base.argument_names import given
from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import quantity, texts
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_scenario, read_target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.labelled.data import LabelledData

Path_ = str | float | Sequence[Any]
"""Values of a drive: one, "FROM:TO:STEPS", or (from, to, steps)."""


@checked
def kinematics(
    model: Source,
    drives: Mapping[str, Path_] | None = None,
    *,
    together: bool = False,
    hold: str | Iterable[str] = (),
    channels: str | Iterable[str] = (),
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return positions and velocity ratios of a system along driven paths.

    Parameters
    ----------
    model
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    drives
        For coordinates or sensors their values: one, ("200 mm", "400 mm", 20) for 21 values, or
        the same as a text "200 mm:400 mm:20"; the scenario's section "kinematics" if None.
    together
        Whether the drives move at once instead of through all combinations.
    hold
        Coordinates that stay at their start.
    channels
        Names or patterns of the channels that the report shows; the result holds all.
    set, settings, save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        Every channel over ``sample``.

    Raises
    ------
    InputError
        If the model, a drive or a setting cannot be used.
    NumericalError
        If the loops cannot be assembled.
    """
    from vehicledyn.analyses.mechanism.kinematics import Request, sweep_kinematics

    request = Request(
        {name: _range("drives", {name: values}, values) for name, values in (drives or {}).items()},
        together,
        tuple(texts("hold", hold)) if hold else (),
        tuple(texts("channels", channels)) if channels else (),
    )
    target = read_target(model, override_texts(set, settings), ("scenario", "system"))
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = sweep_kinematics(
            target, request, output=place.path, progress=reporter(progress), kept=place.kept
        )
        return place.value(report)


@checked
def rig(
    model: Source,
    test: str = "parallel",
    values: Path_ | None = None,
    *,
    travel: str | float = 0.0,
    steering: str | None = None,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return kinematics and compliance of an axle on a suspension rig.

    The body of the axle is held, its wheels have no tyres and keep the height that the test gives.

    Parameters
    ----------
    model
        Axle or suspension: path or name of a system with sensors "wheel_angles", a System, or what
        :func:`vehicledyn.load` returned.
    test
        "parallel" and "roll" lift the wheels, "steer" moves the steering, "lateral",
        "longitudinal" and "aligning" load them.
    values
        What the test controls: one value, ("-60 mm", "60 mm", 24) for 25 values, or the same as
        a text; a usual range if None.
    travel
        How far the wheels are lifted while the test steers or loads them, such as "20 mm".
    steering
        Coordinate that steers; the one of a body named rack if None.
    set, settings, save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        Every quantity over ``sample``; :mod:`vehicledyn.analyses.mechanism.rig_quantities` says
        what each is.

    Raises
    ------
    InputError
        If the model, the test or a setting cannot be used.
    NumericalError
        If the loops cannot be assembled.
    """
    from vehicledyn.analyses.mechanism.rig import RigRequest, run_rig

    span = None if values is None else _range("values", values, values)
    lift = quantity("travel", travel, "m")
    request = RigRequest(test, span, lift, steering)
    target = read_target(model, override_texts(set, settings), ("scenario", "system"))
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = run_rig(
            target, request, output=place.path, progress=reporter(progress), kept=place.kept
        )
        return place.value(report)


@checked
def inverse(
    scenario: Source,
    *,
    motion: str | Path | LabelledData | None = None,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    backend: Backend = "auto",
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return the forces that a prescribed motion needs.

    Parameters
    ----------
    scenario
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned.
    motion
        CSV file, result file or result with the motion; the scenario's section "motion" if None.
    set, settings, save_to, overwrite, backend, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        Every channel over time, forces included.

    Raises
    ------
    InputError
        If the scenario, the motion or a setting cannot be used.
    """
    from vehicledyn.analyses.mechanism.inverse_report import find_forces

    loaded = read_scenario(scenario, override_texts(set, settings))
    table = motion.path if isinstance(motion, LabelledData) else motion
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        report = find_forces(
            loaded,
            table=None if table is None else Path(table),
            output=place.path,
            backend=backend,
            progress=reporter(progress),
            kept=place.kept,
        )
        return place.value(report)


def _range(argument: str, value: Any, values: Path_) -> str:
    """Return values as a text; messages name the argument and what it was given."""
    if isinstance(values, str):
        return values
    if isinstance(values, Sequence):
        if len(values) != len(("from", "to", "steps")):
            raise InputError(f"{given(argument, value)}: write (from, to, steps)")
        return ":".join(map(str, values))
    return str(values)
