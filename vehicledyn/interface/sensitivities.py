"""Exact derivatives of analyses from Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.quantities import speed_in_si, texts
from vehicledyn.interface.running import Progress, reporter, result_place
from vehicledyn.interface.targets import Source, read_scenario, read_target
from vehicledyn.results.labelled.data import LabelledData


@checked
def sensitivity(
    scenario: Source,
    of: str | Iterable[str],
    to: str | Iterable[str] = "parameters.*",
    *,
    along: Mapping[str, float | str] | None = None,
    speed: float | str | None = None,
    set: Settings | None = None,
    save_to: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    progress: Progress = False,
    **settings: Any,
) -> LabelledData:
    """Return exact derivatives of a run's channels and key figures by parameters.

    Parameters
    ----------
    scenario
        Path or name of a scenario or model, a System, or what :func:`vehicledyn.load` returned;
        of ``tyre(...)`` a tyre property file, of ``profiles(...)`` a wheel profile, of
        ``cam(...)`` the file of a cam.
    of
        Key figures of the run, channels, or figures of channels such as ``max(chassis.roll)``;
        or of the linearised model: ``eigenvalues``, ``mode_shapes``, ``critical_speed`` and
        coordinates and channels of the equilibrium, such as ``equilibrium.chassis.z``; or of its
        frequency responses, such as ``gain(chassis.roll, road, 1.5 Hz)`` and ``phase(...)``; or of
        limit cycles: ``cycle_period``, ``cycle_amplitude(axle.y)``, ``cycle_mean(...)`` and
        ``nonlinear_critical_speed``; or channels along a driven path without forces, and their
        velocity ratios, such as
        ``kinematics(ratio.wheel.z.wheel.toe_angle, wheel.z, 276 mm:356 mm:4)``; or of inverse
        dynamics, such as ``inverse(crank.angle_force)``, ``inverse(max(crank.angle_force))`` and
        ``inverse(crank.angle.work)``; or of an axle on the suspension rig, such as
        ``rig(left.toe_gain, parallel)`` and ``rig(left.camber, roll, -2 deg:2 deg:4)``;
        or of steady cornering, such as ``steady(understeer_gradient, constant_radius)`` and
        ``steady(limit, acceleration_limits, -6 m/s^2)``; or of a tyre file, such as
        ``tyre(lateral_force, 4000 N, slip_angle=4 deg)``, or of a wheel profile, such as
        ``profiles(radius_difference, 2 mm, rail=60E1)``, or of a cam, such as
        ``cam(peak(pressure_angle))``.
    to
        Parameters, by patterns such as ``parameters.front.*``, and start values of states, such
        as ``start.chassis.y``.
    along
        A direction, as parts by names as in ``to``, in SI or with units: figures of channels get
        second derivatives along it, their Hessian times the direction, for some simulations more.
    speed
        For linearised models and limit cycles: speed such as "20 m/s", or a number [m/s]; the
        scenario's if None. The search for critical speeds begins there.
    set, settings, save_to, overwrite, progress
        As for :func:`vehicledyn.simulate`.
    resume
        Whether to go on with what a killed or stopped analysis left beside ``save_to``.

    Returns
    -------
    LabelledData
        ``figure_value`` over figure, ``figure_slope`` over figure and parameter, not a number
        where no derivative exists, ``figure_change_per_percent``; ``figure_curvature`` with
        ``along``; of channels ``channel_value`` over channel and time and ``channel_slope`` over
        channel, time and parameter.

    Raises
    ------
    InputError
        If the scenario, a name or a setting cannot be used.
    NumericalError
        If the run fails or its derivative does not exist.
    """
    from vehicledyn.analyses.preparation.target_digest import digests_to_keep
    from vehicledyn.analyses.sensitivity.known_analyses import ANALYSES, RUN, analysis_of
    from vehicledyn.analyses.sensitivity.refused_names import refuse_other_analyses
    from vehicledyn.analyses.sensitivity.report import SensitivityReport
    from vehicledyn.results.tables.sensitivity_table import write_sensitivity

    names, patterns, changes = texts("of", of), texts("to", to), override_texts(set, settings)
    refuse_other_analyses(names)
    kinds_asked = list(dict.fromkeys(analysis_of(name) for name in names)) or [RUN]
    if len(kinds_asked) > 1:
        raise InputError(
            f"figures of {' and '.join(kinds_asked)} are results of analyses of their own; ask for "
            "them one after the other"
        )
    kind, analysis = kinds_asked[0], ANALYSES[kinds_asked[0]]
    if speed is not None and not analysis.has_speed:
        raise InputError(
            "speed: is for linearised models and limit cycles; a run has the scenario's speed"
        )
    if along is not None and kind != RUN:
        raise InputError("along: second derivatives are those of figures of a run's channels")
    with result_place(save_to, may_exist=overwrite, resume=resume) as place:
        reported, at = reporter(progress), None if speed is None else speed_in_si(speed)
        if along is not None:
            from vehicledyn.analyses.sensitivity.curvature import find_curvature

            loaded = read_scenario(scenario, changes)
            table = find_curvature(loaded, names, patterns, along, reported)
        else:
            find, kinds = analysis.load()
            subject: Any
            if analysis.subject == "file":
                subject, digests = file_of(scenario, kind, changes), []
            else:
                read = read_scenario if analysis.subject == "scenario" else read_target
                subject = read(scenario, changes)
                digests = digests_to_keep(place.kept, [subject])
            given = digests, names, patterns, at
            memory = place.kept.memory("sensitivity", *given, kinds=kinds)
            speeds = (at,) if analysis.has_speed else ()
            table = find(subject, names, patterns, *speeds, reported, memory=memory)
        write_sensitivity(place.path, table)
        return place.value(SensitivityReport(table))


def file_of(source: Source, analysis: str, changes: Sequence[str]) -> str:
    """Return the file that an analysis of files is asked about.

    Raises
    ------
    InputError
        If it is no file, or something is to be changed in it.
    """
    if not isinstance(source, str | Path):
        raise InputError(f"{analysis}(...) is of a file; give its path")
    if changes:
        raise InputError(f"{analysis}(...) is of a file, in which nothing is set; change the file")
    return str(source)
